// Light that paths from the camera cannot find: of what has no size, by a mirror or through glass. A path would have to
// hit a point, or the one direction, and no connection goes through glass. Photons alone bring it.

#pragma once

#include <algorithm>

#include <fmt/format.h>

#include "core/error.h"
#include "scene/emitter.h"
#include "scene/scene.h"
#include "transport/path_length.h"

namespace photonlab {

/// Throws InputError where the scene has such light and paths are long enough for it. `refusal` says what cannot be
/// done, `advice` what can.
inline void require_findable_light(const Scene& scene, int max_depth, std::string_view refusal,
                                   std::string_view advice) {
    const auto hidden = std::find_if_not(scene.emitters.begin(), scene.emitters.end(), is_met_by_rays);
    if (hidden == scene.emitters.end() || !depth_allows(max_depth, 3)) return;
    for (const Shape& shape : scene.shapes) {
        const Material& material = scene.materials[shape.material];
        if (may_be_specular(material))
            throw InputError(scene.name,
                             fmt::format("{}: it has a {} light and a {} (\"{}\"), and no path from the camera can "
                                         "find light without size by a mirror or through glass, so {}",
                                         refusal, emitter_kind(*hidden), material_kind(material), material.id, advice));
    }
}

}  // namespace photonlab
