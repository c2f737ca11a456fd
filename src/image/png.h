// Pictures for looking at. Nothing is measured on them: errors are taken on the linear radiance of the EXR.

#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "core/math.h"

namespace photonlab {

/// Display value in [0, 255] of a linear value, clipped to [0, 1] first; NaN becomes 0.
/// [IEC 61966-2-1: the transfer function of sRGB]
std::uint8_t srgb_byte(double linear);

/// Writes an 8-bit PNG: radiance times `exposure`, then sRGB, clipped. A pixel that holds a NaN is drawn in magenta,
/// so that it is seen. `pixels` is row by row from the top, width * height long.
/// Written under a temporary name and renamed. Throws InputError with the file's name when it cannot be written.
void write_png(const std::filesystem::path& file, int width, int height, const std::vector<ColorD>& pixels,
               double exposure = 1.0);

}  // namespace photonlab
