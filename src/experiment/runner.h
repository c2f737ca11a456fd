// Runs one method on one scene: traces the photons of each pass, hands them to the integrator, keeps the time, and
// shows the image at the passes that somebody asked for.
//
// What time means: at pass i it is the time of tracing, building, gathering and direct light of passes 1 to i, plus
// what the one estimate at i took; what earlier estimates took is not in it. So the choice of recorded passes changes
// no number. Hit points, metrics and files are never in it.

#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "integrators/integrator.h"

namespace photonlab {

inline constexpr std::size_t stage_count = 4;

/// Seconds spent in each Stage, by the steady clock and of the CPU (all threads of the process).
struct StageTimes {
    std::array<double, stage_count> seconds{};
    std::array<double, stage_count> cpu_seconds{};

    double of(Stage stage) const { return seconds[static_cast<std::size_t>(stage)]; }
    double total() const;
    double cpu_total() const;
    StageTimes& operator+=(const StageTimes& other);
};

/// A clock that is told which stage begins; what passes before the first and after stop() is not counted.
class StageClock {
public:
    void enter(Stage stage);
    void stop();
    const StageTimes& times() const { return times_; }

private:
    std::optional<Stage> stage_;
    double began_ = 0.0;
    double cpu_began_ = 0.0;
    StageTimes times_;
};

struct RunSettings {
    MethodSettings method;  ///< with max_depth resolved
    std::uint64_t seed = 1;
    std::uint64_t passes = 1;
    int threads = 1;
    std::vector<std::uint64_t> estimated;  ///< passes whose image is asked for, increasing, at most `passes`
};

/// How far a run is: after `pass` passes.
struct RunState {
    std::uint64_t pass = 0;
    std::uint64_t paths_emitted = 0;  ///< from lights, over all passes; 0 for `path`
    std::uint64_t photons_stored = 0;
    std::uint64_t paths_cut = 0;          ///< by the cap on edges
    double power_cut = 0.0;               ///< what those carried, relative to the total power, summed over paths
    std::uint64_t nonfinite_photons = 0;  ///< refused by the photon pass
    StageTimes times;                     ///< see above
    IntegratorReport report;
    std::optional<double> initial_radius;  ///< mean over hit points before the first pass, scene units; for mode
                                           ///< `nearest` the maximum radius
};

using EstimateListener = std::function<void(const RunState&, const Image&)>;
using PassListener = std::function<void(std::uint64_t pass)>;

/// Calls `on_estimate` for each pass of `settings.estimated` and `on_pass` after every pass; returns the last state.
RunState run_method(
    const Scene& scene, const HitPoints& hit_points, const RunSettings& settings, const EstimateListener& on_estimate,
    const PassListener& on_pass = [](std::uint64_t) {});

}  // namespace photonlab
