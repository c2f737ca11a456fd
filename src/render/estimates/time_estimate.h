// How long a run will take, before it is started: three small passes are measured and scaled, of few photons, at the
// hit points of a coarse view (coarse_view.h).
//
// The model is linear. Tracing and building take time in proportion to the photons of a pass, direct light to the hit
// points, gathering to both. An estimate at pass i costs what it did at pass 1, plus (i - 1) times what it grew by from
// pass 1 to pass 2: nothing for ppm, much for photonmapper, which gathers all photons so far. Radii that shrink make
// ppm cheaper than this says. Where radii are so large that every hit point finds most photons, fewer photons are
// measured: what that takes is bounded, whatever the run itself will take.

#pragma once

#include <cstdint>
#include <functional>

#include "render/estimates/coarse_view.h"
#include "render/pass_loop.h"

namespace photonlab {

struct TimeEstimate {
    double seconds = 0.0;        ///< of passes and estimates; metrics and files not included
    double trace_seconds = 0.0;  ///< of these in tracing photons, which methods run together share
    std::uint64_t gathered = 0;  ///< photons that were gathered while it was measured
};

TimeEstimate estimate_time(const Scene& scene, const CoarseView& view, const RunSettings& settings);

using TimeEstimator = std::function<TimeEstimate(const Scene&, const CoarseView&, const RunSettings&)>;

/// Seconds of what was measured with a share of the photons and of the hit points. `path` knows no photons: it spends
/// its time in Trace, hit point by hit point.
double scaled_seconds(const StageTimes& times, bool has_photons, double photon_scale, double hit_point_scale);

}  // namespace photonlab
