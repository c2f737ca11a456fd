#include "image/read_image.h"

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "core/error.h"

namespace photonlab {

double srgb_to_linear(double value) {
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

ColorImage read_color_image(const std::filesystem::path& file, bool raw) {
    const auto input = OIIO::ImageInput::open(file.string());
    if (!input) throw InputError(file.string(), "cannot be read as an image: " + OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    constexpr int largest = 1 << 15;
    if (spec.width < 1 || spec.height < 1 || spec.width > largest || spec.height > largest || spec.nchannels < 1)
        throw InputError(file.string(),
                         fmt::format("expected an image of 1 to {} pixels a side, got {} x {} with {} channels",
                                     largest, spec.width, spec.height, spec.nchannels));
    const auto channels = static_cast<std::size_t>(spec.nchannels);
    const std::size_t count = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height);
    std::vector<float> values(count * channels);
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()))
        throw InputError(file.string(), "cannot be read as an image: " + input->geterror());

    const bool decode = !raw && !spec.format.is_floating_point();
    ColorImage image{spec.width, spec.height, std::vector<Color>(count)};
    for (std::size_t pixel = 0; pixel < count; ++pixel)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const float value = values[pixel * channels + (channels >= 3 ? channel : 0)];
            image.pixels[pixel][static_cast<int>(channel)] = decode ? static_cast<float>(srgb_to_linear(value)) : value;
        }
    return image;
}

}  // namespace photonlab
