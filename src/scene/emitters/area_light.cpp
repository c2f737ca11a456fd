#include "scene/emitters/area_light.h"

#include "core/sampling.h"
#include "scene/emitters/light_reader.h"

namespace photonlab {

Emission AreaLight::emit(const std::vector<Shape>& shapes, const EmissionDraw& draw) const {
    const SurfacePoint point = sample_area(shapes[shape], draw.u_position, draw.u_triangle);
    const Vector direction = make_frame(point.normal).to_world(sample_cosine_hemisphere(draw.u_direction));
    return {{offset_from_surface(point.position, point.normal, direction), direction}};
}

std::optional<DirectSample> AreaLight::sample_direct(const std::vector<Shape>& shapes, const Vector& receiver,
                                                     const Imath::V2f& u, double u_triangle) const {
    const std::optional<SeenPoint> seen = sample_seen(shapes[shape], receiver, u, u_triangle);
    if (!seen) return std::nullopt;
    return DirectSample{.position = seen->position,
                        .direction = seen->direction,
                        .radiance = radiance,
                        .density = seen->density,
                        .is_delta = false};
}

AreaLight::Description AreaLight::read(LightReader& reader) {
    reader.require_no_objects();
    return {reader.light("radiance", ColorD(1.0))};
}

}  // namespace photonlab
