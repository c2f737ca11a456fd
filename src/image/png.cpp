#include "image/png.h"

#include <OpenImageIO/imageio.h>

#include <cassert>

#include "core/error.h"
#include "core/temporary_file.h"

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

    const auto output = OIIO::ImageOutput::create("png");
    if (!output) throw InputError(file.string(), "cannot be written: this OpenImageIO has no PNG: " + OIIO::geterror());
    OIIO::ImageSpec spec(width, height, 3, OIIO::TypeDesc::UINT8);
    spec.attribute("oiio:ColorSpace", "sRGB");

    TemporaryFile temporary(file);
    if (!output->open(temporary.path().string(), spec) || !output->write_image(OIIO::TypeDesc::UINT8, bytes.data()) ||
        !output->close())
        throw InputError(file.string(), "cannot be written: " + output->geterror());
    temporary.rename();
}

}  // namespace photonlab
