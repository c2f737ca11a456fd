// A shape that shines by a texture: its radiance at a point is that of the point's texture coordinate. Light leaves it
// by brightness and by the cosine, and a receiver draws it uniform in area as it does a plain one. A kind of its own
// beside AreaLight, so that a scene without such a light pays nothing.

#pragma once

#include <memory>

#include "scene/emitters/bright_parts.h"
#include "scene/emitters/light_kind.h"
#include "scene/textures/texture.h"

namespace photonlab {

/// Emits to the side of the normal.
struct TexturedAreaLight {
    static constexpr const char* name = "area";
    static constexpr bool is_met_by_rays = true;

    std::shared_ptr<const Texture> texture;
    ColorD factor;  ///< radiance where the texture is 1
    std::uint32_t shape;
    std::shared_ptr<const BrightParts> parts;

    ColorD radiance_at(const Imath::V2f& texture_coordinate) const {
        return factor * ColorD(color_at(*texture, texture_coordinate));
    }
    ColorD power(const std::vector<Shape>& shapes) const;
    Emission emit(const std::vector<Shape>& shapes, const EmissionDraw& draw) const;
    std::optional<DirectSample> sample_direct(const std::vector<Shape>& shapes, const Vector& receiver,
                                              const Imath::V2f& u, double u_triangle) const;
};
static_assert(LightKind<TexturedAreaLight>);

}  // namespace photonlab
