// How an image differs from a reference, as a picture: blue where it is too dark, red where it is too bright, so that
// bias (a region all of one colour) can be told from noise (both colours mixed). As the strips of the analysis have it.

#pragma once

#include <filesystem>
#include <vector>

#include "core/math.h"

namespace photonlab {

/// Image minus reference, mean over R, G, B, a value a pixel.
std::vector<float> difference(const std::vector<ColorD>& image, const std::vector<ColorD>& reference);

/// Writes differences of images of one size, `width` pixels wide, side by side as a PNG. They share a scale, whose end,
/// which is returned, 99% of the pixels of each are within; pixels that are not finite are magenta. Throws InputError.
double write_difference_picture(const std::filesystem::path& file, int width,
                                const std::vector<std::vector<float>>& differences);

}  // namespace photonlab
