#include "scene/emitters/area_light.h"

#include "scene/emitters/light_reader.h"

namespace photonlab {

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
