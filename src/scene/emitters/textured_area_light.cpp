#include "scene/emitters/textured_area_light.h"

#include "core/sampling.h"

namespace photonlab {

/// pi times the integral of radiance over the area.
ColorD TexturedAreaLight::power(const std::vector<Shape>& shapes) const {
    return factor * parts->mean() * (pi * shapes[shape].area);
}

Emission TexturedAreaLight::emit(const std::vector<Shape>& shapes, const EmissionDraw& draw) const {
    const auto [point, texture_coordinate, weight] = parts->draw(shapes[shape], draw.u_position, draw.u_triangle);
    const Vector direction = make_frame(point.normal).to_world(sample_cosine_hemisphere(draw.u_direction));
    // The factor is in the power already.
    ColorD share = ColorD(color_at(*texture, texture_coordinate)) * weight;
    for (int channel = 0; channel < 3; ++channel)
        share[channel] = parts->mean()[channel] > 0.0 ? share[channel] / parts->mean()[channel] : 0.0;
    return {{offset_from_surface(point.position, point.normal, direction), direction}, share};
}

std::optional<DirectSample> TexturedAreaLight::sample_direct(const std::vector<Shape>& shapes, const Vector& receiver,
                                                             const Imath::V2f& u, double u_triangle) const {
    const std::optional<SeenPoint> seen = sample_seen(shapes[shape], receiver, u, u_triangle);
    if (!seen) return std::nullopt;
    const ColorD radiance = radiance_at(texture_coordinate_of_drawn(shapes[shape], seen->position, u, u_triangle));
    if (is_black(radiance)) return std::nullopt;
    return DirectSample{.position = seen->position,
                        .direction = seen->direction,
                        .radiance = radiance,
                        .density = seen->density,
                        .is_delta = false};
}

}  // namespace photonlab
