#include "experiment/time_estimate.h"

#include <algorithm>

#include "integrators/registry.h"

namespace photonlab {

namespace {

constexpr std::uint64_t probe_photons = 10'000;
constexpr std::uint64_t probe_passes = 3;

/// Seconds, scaled to the photons of the real run. `path` spends its time in Trace and knows no photons: scale is 1.
double scaled(const StageTimes& times, double scale) {
    const double direct = times.of(Stage::Direct);
    return direct + (times.total() - direct) * scale;
}

}  // namespace

TimeEstimate estimate_time(const Scene& scene, const HitPoints& hit_points, const RunSettings& settings) {
    RunSettings probe = settings;
    double scale = 1.0;
    if (uses_setting(settings.method, "photons_per_pass")) {
        probe.method.photons_per_pass = std::min(probe_photons, settings.method.photons_per_pass);
        scale =
            static_cast<double>(settings.method.photons_per_pass) / static_cast<double>(probe.method.photons_per_pass);
    }
    probe.passes = probe_passes;
    probe.estimated = {1, 2};
    RunState estimated[2];
    std::size_t next = 0;
    const RunState passes =
        run_methods(scene, hit_points, {probe},
                    [&](std::size_t, const RunState& state, const Image&) { estimated[next++] = state; })[0];

    const double pass_seconds = scaled(passes.times, scale) / static_cast<double>(probe_passes);
    const double first = std::max(0.0, scaled(estimated[0].times, scale) - pass_seconds);
    const double second = std::max(0.0, scaled(estimated[1].times, scale) - 2.0 * pass_seconds);
    const double growth = std::max(0.0, second - first);

    TimeEstimate estimate;
    estimate.seconds = pass_seconds * static_cast<double>(settings.passes);
    if (passes.paths_emitted > 0)
        estimate.trace_seconds = passes.times.of(Stage::Trace) * scale / static_cast<double>(probe_passes) *
                                 static_cast<double>(settings.passes);
    for (const std::uint64_t pass : settings.estimated)
        estimate.seconds += first + growth * static_cast<double>(pass > 0 ? pass - 1 : 0);
    return estimate;
}

}  // namespace photonlab
