#include "image/read_image.h"

#include <cctype>
#include <optional>

#include "core/files/files.h"
#include "core/machine/available_memory.h"
#include "image/codecs/plain_png.h"

namespace photonlab {

double srgb_to_linear(double value) {
    return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

namespace {

/// As for image_codecs(), an image's ending says what it is: another than .png is not tried as one.
std::optional<DecodedImage> read_if_plain_png(const std::filesystem::path& file) {
    std::string ending = file.extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (ending != ".png") return std::nullopt;
    return read_plain_png(file, require_memory_for);
}

}  // namespace

ColorImage read_color_image(const std::filesystem::path& file, bool raw) {
    require_ordinary_file(file);
    std::optional<DecodedImage> plain = read_if_plain_png(file);
    const DecodedImage decoded = plain ? std::move(*plain) : image_codecs().read(file, require_memory_for);
    const auto channels = static_cast<std::size_t>(decoded.channels);
    const std::size_t count = decoded.values.size() / channels;
    const bool decode = !raw && !decoded.is_floating_point;
    ColorImage image{decoded.width, decoded.height, std::vector<Color>(count)};
    for (std::size_t pixel = 0; pixel < count; ++pixel)
        for (std::size_t channel = 0; channel < 3; ++channel) {
            const float value = decoded.values[pixel * channels + (channels >= 3 ? channel : 0)];
            image.pixels[pixel][static_cast<int>(channel)] = decode ? static_cast<float>(srgb_to_linear(value)) : value;
        }
    return image;
}

}  // namespace photonlab
