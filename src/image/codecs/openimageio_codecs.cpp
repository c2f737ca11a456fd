// The shared library that image_codecs() loads.

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <cctype>
#include <cstdint>
#include <map>
#include <string>

#include "core/error.h"
#include "image/codecs/image_codecs.h"

namespace photonlab {

namespace {

/// Endings of the formats that textures come in, and OpenImageIO's names for their readers. It has many more, some of
/// which run whole programs for video: none is tried on what a scene names.
const std::map<std::string, std::string>& readers() {
    static const std::map<std::string, std::string> by_ending{
        {".bmp", "bmp"}, {".exr", "openexr"}, {".hdr", "hdr"},  {".jpeg", "jpeg"}, {".jpg", "jpeg"},
        {".png", "png"}, {".tga", "targa"},   {".tif", "tiff"}, {".tiff", "tiff"}};
    return by_ending;
}

/// A few bytes can claim any number of pixels, and memory would be asked for before the first is found missing.
constexpr std::int64_t largest_pixel_count = std::int64_t{1} << 26;
constexpr std::int64_t largest_compression_ratio = 10'000;  // values to bytes; that of PNG ends near 8300

void require_sound(const std::filesystem::path& file, const OIIO::ImageSpec& spec) {
    constexpr int largest_side = 1 << 15;
    constexpr int most_channels = 1024;
    if (spec.width < 1 || spec.height < 1 || spec.width > largest_side || spec.height > largest_side ||
        std::int64_t{spec.width} * spec.height > largest_pixel_count || spec.depth > 1 || spec.deep ||
        spec.nchannels < 1 || spec.nchannels > most_channels)
        throw InputError(
            file.string(),
            fmt::format("expected a flat image of 1 to {} pixels a side, {} in all, with 1 to {} channels, got {} x {} "
                        "with {}",
                        largest_side, largest_pixel_count, most_channels, spec.width, spec.height, spec.nchannels));
    const auto bytes = static_cast<std::int64_t>(std::filesystem::file_size(file));
    if (std::int64_t{spec.width} * spec.height * spec.nchannels / largest_compression_ratio > bytes)
        throw InputError(file.string(), fmt::format("claims {} x {} pixels, more than its {} bytes can hold",
                                                    spec.width, spec.height, bytes));
}

DecodedImage read(const std::filesystem::path& file, RequireMemory require_memory) {
    std::string ending = file.extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    const auto reader = readers().find(ending);
    if (reader == readers().end())
        throw InputError(file.string(), "expected an image file .bmp, .exr, .hdr, .jpg, .png, .tga or .tif");
    const auto input = OIIO::ImageInput::create(reader->second);
    if (!input) throw InputError(file.string(), "this OpenImageIO has no reader for it: " + OIIO::geterror());
    OIIO::ImageSpec spec;
    if (!input->open(file.string(), spec))
        throw InputError(file.string(), "cannot be read as an image: " + input->geterror());
    require_sound(file, spec);
    const int channels = spec.nchannels < 3 ? 1 : 3;  // of grey, or of colour: alpha and others are left out
    DecodedImage image{spec.width, spec.height, channels, spec.format.is_floating_point(), {}};
    const std::size_t bytes_to_pixel =
        sizeof(float) * static_cast<std::size_t>(channels + 3);  // and of what it becomes
    require_memory(file.string(),
                   bytes_to_pixel * static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height));
    image.values.resize(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) *
                        static_cast<std::size_t>(channels));
    if (!input->read_image(0, 0, 0, channels, OIIO::TypeDesc::FLOAT, image.values.data()))
        throw InputError(file.string(), "cannot be read as an image: " + input->geterror());
    return image;
}

}  // namespace

extern "C" {
extern const ImageCodecs photonlab_image_codecs;
const ImageCodecs photonlab_image_codecs{read};
}

}  // namespace photonlab
