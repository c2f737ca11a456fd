#include "scene/emitters/infinity/constant.h"

#include "core/sampling.h"
#include "scene/emitters/light_reader.h"

namespace photonlab {

ConstantDescription Constant::read(LightReader& reader) {
    reader.require_no_objects();
    reader.pass_over({"to_world"}, "it is the same from everywhere");
    return {.radiance = reader.light("radiance", ColorD(1.0)), .place = reader.element.place};
}

Constant ConstantDescription::placed(const SceneExtent& extent) const {
    return {radiance, EntryDiscs(extent)};
}

Emission Constant::emit(const std::vector<Shape>&, const EmissionDraw& draw) const {
    EntryDiscs::Entry entry = discs.draw(sample_unit_sphere(draw.u_direction), draw.u_position, draw.u_triangle);
    entry.emission.share = ColorD(1.0 / (entry.density * discs.area()));
    return entry.emission;
}

std::optional<DirectSample> Constant::sample_direct(const std::vector<Shape>&, const Vector& receiver,
                                                    const Imath::V2f& u, double) const {
    const Vector direction = sample_unit_sphere(u);
    return DirectSample{.position = discs.beyond(receiver, direction),
                        .direction = direction,
                        .radiance = radiance,
                        .density = density_of(direction),
                        .is_delta = false};
}

}  // namespace photonlab
