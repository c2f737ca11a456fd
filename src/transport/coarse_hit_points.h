// The camera pass through another camera than the scene's: of fewer pixels, to know what is coming.

#pragma once

#include "transport/hit_points.h"

namespace photonlab {

HitPoints trace_hit_points(const Scene& scene, const Camera& camera, int samples_per_pixel, int threads,
                           double branch_cutoff);

}  // namespace photonlab
