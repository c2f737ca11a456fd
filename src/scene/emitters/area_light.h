// A shape that shines alike everywhere: light leaves it uniform in area and by the cosine, so a photon's weight is the
// same wherever it starts. One whose radiance is a texture is in textured_area_light.h.

#pragma once

#include "core/sampling.h"
#include "scene/emitters/light_kind.h"
#include "scene/textures/texture.h"

namespace photonlab {

/// Emits `radiance` from every point of its shape, to the side of the normal.
struct AreaLight {
    static constexpr const char* name = "area";
    static constexpr bool is_met_by_rays = true;

    ColorD radiance;
    std::uint32_t shape;

    ColorD power(const std::vector<Shape>& shapes) const { return radiance * (pi * shapes[shape].area); }
    Emission emit(const std::vector<Shape>& shapes, const EmissionDraw& draw) const;
    std::optional<DirectSample> sample_direct(const std::vector<Shape>& shapes, const Vector& receiver,
                                              const Imath::V2f& u, double u_triangle) const;

    /// What a shape's <emitter> says.
    struct Description {
        ColorD radiance;  ///< with a texture a factor on it
        std::shared_ptr<const Texture> texture = {};
        double sampling_weight = 1.0;
    };
    static Description read(LightReader& reader);
    static void check(const ColorD& radiance, const std::string& place) { require_light(radiance, place, "radiance"); }
};
static_assert(LightKind<AreaLight>);

inline Emission AreaLight::emit(const std::vector<Shape>& shapes, const EmissionDraw& draw) const {
    const SurfacePoint point = sample_area(shapes[shape], draw.u_position, draw.u_triangle);
    const Vector direction = make_frame(point.normal).to_world(sample_cosine_hemisphere(draw.u_direction));
    return {{offset_from_surface(point.position, point.normal, direction), direction}};
}

}  // namespace photonlab
