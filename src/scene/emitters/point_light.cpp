#include "scene/emitters/point_light.h"

#include <cmath>

#include "core/error.h"
#include "scene/emitters/light_reader.h"
#include "scene/mitsuba/transform.h"

namespace photonlab {

PointLightDescription PointLight::read(LightReader& reader) {
    reader.require_no_objects();
    const auto position = reader.properties.vector("position");
    const auto to_world = reader.properties.transform("to_world");
    if (position && to_world) throw InputError(reader.element.place, "point: expected position or to_world, got both");
    return {.position = position ? *position : transform_point(to_world.value_or(Matrix()), VectorD(0.0)),
            .intensity = reader.light("intensity", ColorD(1.0)),
            .place = reader.element.place};
}

void PointLightDescription::check() const {
    require_light(intensity, place, "intensity");
    if (!is_finite(position)) throw InputError(place, "position is not finite");
}

PointLight PointLightDescription::placed(const SceneExtent& extent) const {
    const double unit_length = extent.to_unit_box.unit_length;
    return {intensity / (unit_length * unit_length), place_point(position, extent, place)};
}

std::optional<DirectSample> PointLight::sample_direct(const std::vector<Shape>&, const Vector& receiver,
                                                      const Imath::V2f&, double) const {
    const VectorD to_light = VectorD(position) - VectorD(receiver);
    const double squared_distance = to_light.length2();
    if (!(squared_distance > 0.0)) return std::nullopt;
    return DirectSample{.position = position,
                        .direction = Vector(to_light / std::sqrt(squared_distance)),
                        .radiance = intensity / squared_distance,
                        .density = 1.0,
                        .is_delta = true};
}

}  // namespace photonlab
