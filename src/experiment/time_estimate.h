// How long a run will take, before it is started: three small passes are measured and scaled.
//
// The model is linear. Tracing, building and gathering take time in proportion to the photons of a pass; direct light
// does not know them. An estimate at pass i costs what it did at pass 1, plus (i - 1) times what it grew by from pass 1
// to pass 2: nothing for ppm, much for photonmapper, which gathers all photons so far. Radii that shrink make ppm
// cheaper than this says.

#pragma once

#include <cstdint>

#include "experiment/runner.h"

namespace photonlab {

struct TimeEstimate {
    double seconds = 0.0;        ///< of passes and estimates; metrics and files not included
    double trace_seconds = 0.0;  ///< of these in tracing photons, which methods run together share
};

TimeEstimate estimate_time(const Scene& scene, const HitPoints& hit_points, const RunSettings& settings);

}  // namespace photonlab
