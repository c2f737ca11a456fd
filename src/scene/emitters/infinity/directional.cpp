#include "scene/emitters/infinity/directional.h"

#include "core/error.h"
#include "scene/emitters/light_reader.h"

namespace photonlab {

DirectionalDescription Directional::read(LightReader& reader) {
    reader.require_no_objects();
    const auto direction = reader.properties.vector("direction");
    if (direction && reader.properties.has("to_world"))
        throw InputError(reader.element.place, "directional: expected direction or to_world, got both");
    if (direction && direction->length2() == 0.0)
        throw InputError(reader.properties.place_of("direction"), "direction: expected one that is not 0 0 0");
    return {.direction = direction ? direction->normalized() : reader.axes()[2],
            .irradiance = reader.light("irradiance", ColorD(1.0)),
            .place = reader.element.place};
}

void DirectionalDescription::check() const {
    require_light(irradiance, place, "irradiance");
    if (!is_finite(direction) || std::abs(direction.length2() - 1.0) > 1e-6)
        throw InputError(place, "expected a direction of unit length");
}

Directional DirectionalDescription::placed(const SceneExtent& extent) const {
    return {Vector(direction), irradiance, EntryDiscs(extent)};
}

Emission Directional::emit(const std::vector<Shape>&, const EmissionDraw& draw) const {
    EntryDiscs::Entry entry = discs.draw(direction, draw.u_position, draw.u_triangle);
    entry.emission.share = ColorD(1.0 / (entry.density * discs.area()));
    return entry.emission;
}

std::optional<DirectSample> Directional::sample_direct(const std::vector<Shape>&, const Vector& receiver,
                                                       const Imath::V2f&, double) const {
    return DirectSample{.position = discs.beyond(receiver, -direction),
                        .direction = -direction,
                        .radiance = irradiance,
                        .density = 1.0,
                        .is_delta = true};
}

}  // namespace photonlab
