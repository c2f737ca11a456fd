// Any image file that OpenImageIO reads, as linear RGB: for textures.

#pragma once

#include <filesystem>
#include <vector>

#include "core/math.h"

namespace photonlab {

/// An image in rows from the top.
struct ColorImage {
    int width = 0;
    int height = 0;
    std::vector<Color> pixels;  ///< width * height, linear RGB; grey is repeated, further channels are left out
};

/// Reads `file`. Values stored as integers are scaled to [0, 1] and decoded from sRGB, unless `raw`; floating-point
/// ones are taken as linear. Throws InputError.
ColorImage read_color_image(const std::filesystem::path& file, bool raw);

/// sRGB's decoding (IEC 61966-2-1), for values in [0, 1].
double srgb_to_linear(double value);

}  // namespace photonlab
