#include "image/png.h"

#include <algorithm>
#include <cassert>
#include <fstream>
#include <iterator>

#include "core/error.h"
#include "core/files/temporary_file.h"
#include "image/codecs/plain_png.h"

namespace photonlab {

namespace {

/// True when the file ends as a PNG does, for a disk that was full.
bool has_end(const std::filesystem::path& file) {
    static constexpr char end[] = {0, 0, 0, 0, 'I', 'E', 'N', 'D', '\xae', '\x42', '\x60', '\x82'};
    char found[sizeof(end)] = {};
    std::ifstream stream(file, std::ios::binary);
    stream.seekg(-static_cast<std::streamoff>(sizeof(end)), std::ios::end);
    return stream.read(found, sizeof(found)) && std::equal(std::begin(end), std::end(end), std::begin(found));
}

}  // namespace

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
    write_plain_png(temporary.path(), file, width, height, bytes);
    if (!has_end(temporary.path())) throw InputError(file.string(), "cannot be written wholly: is the disk full?");
    temporary.rename();
}

}  // namespace photonlab
