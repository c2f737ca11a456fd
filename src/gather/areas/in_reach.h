// Whether a photon lies in reach of the point that gathers it: on the same side of everything between them. Photons on
// the other side of a thin wall, or on a floor under what stands on it, tell nothing of the light at the point.
//
// In reach is what a straight segment connects, its ends lifted off their surfaces by no more than rounding asks for.
// Where a bulge of the surface itself is in between (a sphere's, a smooth mesh's), the ends may rise by a sixth of
// their distance first: a chord of a sphere needs that much between normals 60 degrees apart.
//
// [Herzog & Seidel 2007, "Lighting Details Preserving Photon Density Estimation": visibility in the kernel]

#pragma once

#include <cstdint>
#include <span>

#include "core/math.h"
#include "scene/scene.h"
#include "scene/surroundings.h"
#include "transport/light/photons.h"

namespace photonlab {

bool is_in_reach(const Scene& scene, const SurfaceEnd& point, const Photon& photon);

/// is_in_reach() of up to eight photons: a bit each, the first one's lowest. Several times as fast.
unsigned in_reach_of_eight(const Scene& scene, const SurfaceEnd& point, std::span<const Photon> photons);

}  // namespace photonlab
