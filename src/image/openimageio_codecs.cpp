// The shared library that image_codecs() loads.

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "core/error.h"
#include "image/image_codecs.h"

namespace photonlab {

namespace {

DecodedImage read(const std::filesystem::path& file) {
    const auto input = OIIO::ImageInput::open(file.string());
    if (!input) throw InputError(file.string(), "cannot be read as an image: " + OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    constexpr int largest = 1 << 15;
    if (spec.width < 1 || spec.height < 1 || spec.width > largest || spec.height > largest || spec.nchannels < 1)
        throw InputError(file.string(),
                         fmt::format("expected an image of 1 to {} pixels a side, got {} x {} with {} channels",
                                     largest, spec.width, spec.height, spec.nchannels));
    DecodedImage image{spec.width, spec.height, spec.nchannels, spec.format.is_floating_point(), {}};
    image.values.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) *
                        static_cast<std::size_t>(spec.nchannels));
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.values.data()))
        throw InputError(file.string(), "cannot be read as an image: " + input->geterror());
    return image;
}

void write_png(const std::filesystem::path& temporary, const std::filesystem::path& file, int width, int height,
               const std::vector<std::uint8_t>& bytes) {
    const auto output = OIIO::ImageOutput::create("png");
    if (!output) throw InputError(file.string(), "cannot be written: this OpenImageIO has no PNG: " + OIIO::geterror());
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");
    if (!output->open(temporary.string(), spec) || !output->write_image(OIIO::TypeDesc::UINT8, bytes.data()) ||
        !output->close())
        throw InputError(file.string(), "cannot be written: " + output->geterror());
}

}  // namespace

extern "C" {
extern const ImageCodecs photonlab_image_codecs;
const ImageCodecs photonlab_image_codecs{read, write_png};
}

}  // namespace photonlab
