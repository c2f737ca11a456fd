// Squares of two colours, two by two in each unit of the texture coordinates.

#pragma once

#include "scene/textures/texture_kind.h"

namespace photonlab {

struct Checkerboard {
    static constexpr const char* name = "checkerboard";

    Color first = Color(0.4f);   ///< where both coordinates are in the lower half of their square, or neither is
    Color second = Color(0.2f);  ///< elsewhere
    Matrix to_uv = Matrix();     ///< applied to (u, v, 0) before the look-up

    Color color_at(const Imath::V2f& texture_coordinate) const;
    TextureGradient gradient_at(const Imath::V2f&) const { return {}; }
    static Checkerboard read(Plugin& plugin);
    void check(const std::string& place) const;
};

}  // namespace photonlab
