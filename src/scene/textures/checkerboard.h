// Squares of two colours, two by two in each unit of the texture coordinates.

#pragma once

#include "scene/textures/texture_kind.h"

namespace photonlab {

struct Checkerboard {
    static constexpr const char* name = "checkerboard";

    Color first = Color(0.4f);   ///< where both coordinates are in the lower half of their square, or neither is
    Color second = Color(0.2f);  ///< elsewhere
    Matrix to_uv = Matrix();     ///< applied to (u, v, 0) before the look-up
    bool is_mirrored = false;    ///< at each axis, as in 0.6, where coordinates are cut off towards 0

    Color color_at(const Imath::V2f& texture_coordinate) const;
    TextureGradient gradient_at(const Imath::V2f&) const { return {}; }
    Color largest() const {
        return {std::max(first.x, second.x), std::max(first.y, second.y), std::max(first.z, second.z)};
    }
    static Checkerboard read(Plugin& plugin);
    void check(const std::string& place) const;
};

}  // namespace photonlab
