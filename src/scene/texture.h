// An image on a surface: looked up by texture coordinate, bilinear between pixel centres, repeated in both directions.

#pragma once

#include "core/math.h"
#include "image/read_image.h"

namespace photonlab {

/// The image's first row is at v = 0, its left edge at u = 0, as Mitsuba has it.
struct Texture {
    ColorImage image;
    Matrix to_uv;  ///< applied to (u, v, 0) before the look-up

    Color color_at(const Imath::V2f& texture_coordinate) const;
};

}  // namespace photonlab
