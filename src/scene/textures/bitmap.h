// An image on a surface: looked up by texture coordinate, bilinear between pixel centres, repeated in both directions.

#pragma once

#include "image/read_image.h"
#include "scene/textures/texture_kind.h"

namespace photonlab {

/// The image's first row is at v = 0, its left edge at u = 0, as Mitsuba has it.
struct Bitmap {
    static constexpr const char* name = "bitmap";

    ColorImage image;
    Matrix to_uv;           ///< applied to (u, v, 0) before the look-up
    std::string file = {};  ///< for messages

    Color color_at(const Imath::V2f& texture_coordinate) const;
    static Bitmap read(Plugin& plugin);
    void check(const std::string& place) const;
};

}  // namespace photonlab
