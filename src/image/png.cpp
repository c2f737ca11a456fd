#include "image/png.h"

#include <cassert>

#include "core/temporary_file.h"
#include "image/image_codecs.h"

namespace photonlab {

std::uint8_t srgb_byte(double linear) {
    if (!(linear > 0.0)) return 0;  // NaN, too
    if (linear >= 1.0) return 255;
    const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255.0 * encoded));
}

void write_png(const std::filesystem::path& file, int width, int height, const std::vector<ColorD>& pixels,
               double exposure) {
    assert(width > 0 && height > 0);
    assert(pixels.size() == static_cast<std::size_t>(width) * static_cast<std::size_t>(height));

    std::vector<std::uint8_t> bytes;
    bytes.reserve(3 * pixels.size());
    for (const ColorD& radiance : pixels) {
        const ColorD shown = radiance * exposure;
        if (std::isnan(shown.x) || std::isnan(shown.y) || std::isnan(shown.z))
            bytes.insert(bytes.end(), {255, 0, 255});
        else
            bytes.insert(bytes.end(), {srgb_byte(shown.x), srgb_byte(shown.y), srgb_byte(shown.z)});
    }

    TemporaryFile temporary(file);
    image_codecs().write_png(temporary.path(), file, width, height, bytes);
    temporary.rename();
}

}  // namespace photonlab
