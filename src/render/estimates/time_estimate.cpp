#include "render/estimates/time_estimate.h"

#include <algorithm>
#include <bit>

#include "integrators/registry.h"
#include "render/run_methods.h"

namespace photonlab {

namespace {

constexpr std::uint64_t first_paths = 100;
constexpr std::uint64_t most_paths = 10'000;
constexpr std::uint64_t most_gathered = 4'000'000;  // a pass: some hundredths of a second
constexpr std::uint64_t measured_passes = 3;
constexpr double traces_of_visible = 3.0;  // a path: docs/light-paths

/// Passes of `paths` photon paths: the state after each pass whose image was asked for, and after the last.
std::vector<RunState> measure(const Scene& scene, const CoarseView& view, RunSettings settings, std::uint64_t paths,
                              std::uint64_t passes, std::vector<std::uint64_t> shown) {
    settings.method.photons_per_pass = paths;
    // The few points of a coarse view see too little for chains to begin.
    const bool is_visible = traces_visible_paths(settings.method);
    settings.method.photon_paths = PhotonPathMode::Independent;
    settings.passes = passes;
    settings.shown = std::move(shown);
    std::vector<RunState> states;
    const RunState last =
        run_methods(scene, view.hit_points, {settings},
                    [&](std::size_t, const RunState& state, const Image&) { states.push_back(state); })[0];
    states.push_back(last);
    if (is_visible)
        for (RunState& state : states)
            for (auto* seconds : {&state.times.seconds, &state.times.cpu_seconds})
                (*seconds)[static_cast<std::size_t>(Stage::Trace)] *= traces_of_visible;
    return states;
}

}  // namespace

double scaled_seconds(const StageTimes& times, bool has_photons, double photon_scale, double hit_point_scale) {
    if (!has_photons) return times.total() * hit_point_scale;
    return (times.of(Stage::Trace) + times.of(Stage::Build)) * photon_scale +
           times.of(Stage::Gather) * photon_scale * hit_point_scale +
           (times.of(Stage::Direct) + times.of(Stage::Points)) * hit_point_scale;
}

TimeEstimate estimate_time(const Scene& scene, const CoarseView& view, const RunSettings& settings) {
    TimeEstimate estimate;
    const bool has_photons = uses_setting(settings.method, "photons_per_pass");
    const std::uint64_t all_paths = settings.method.photons_per_pass;
    std::uint64_t paths = all_paths;
    if (has_photons) {
        paths = std::min(first_paths, all_paths);
        estimate.gathered = measure(scene, view, settings, paths, 1, {1}).back().report.photons_gathered;
        const std::uint64_t bearable = most_gathered * paths / std::max<std::uint64_t>(estimate.gathered, 1);
        paths = std::min(std::clamp(bearable, paths, most_paths), all_paths);
    }
    const std::vector<RunState> states = measure(scene, view, settings, paths, measured_passes, {1, 2});
    const RunState& last = states.back();
    estimate.gathered += last.report.photons_gathered;

    const double photon_scale = static_cast<double>(all_paths) / static_cast<double>(paths);
    const std::optional<NewPoints> new_points = needs_of(settings.method).new_points;
    const double point_scale = new_points && !new_points->all_cells ? view.pixel_scale : view.scale;
    const auto scaled = [&](const RunState& state) {
        return scaled_seconds(state.times, has_photons, photon_scale, point_scale);
    };
    const double pass_seconds = scaled(last) / static_cast<double>(measured_passes);
    const double first = std::max(0.0, scaled(states[0]) - pass_seconds);
    const double second = std::max(0.0, scaled(states[1]) - 2.0 * pass_seconds);
    const double growth = std::max(0.0, second - first);
    const auto passes = static_cast<double>(settings.passes);
    estimate.seconds = pass_seconds * passes;
    // Photons move when an epoch ends, and each is as long as all before it.
    if (needs_of(settings.method).holds_photons)
        estimate.seconds += last.times.of(Stage::Relax) * photon_scale *
                            static_cast<double>(std::bit_width(settings.passes)) /
                            static_cast<double>(std::bit_width(measured_passes));
    if (has_photons)
        estimate.trace_seconds =
            last.times.of(Stage::Trace) * photon_scale / static_cast<double>(measured_passes) * passes;
    for (const std::uint64_t pass : settings.shown)
        estimate.seconds += first + growth * static_cast<double>(pass > 0 ? pass - 1 : 0);
    return estimate;
}

}  // namespace photonlab
