// Runs methods on one scene, side by side: traces the photons of each pass once, hands them to every method, keeps the
// time, and shows the images at the passes that somebody asked for.
//
// What time means: at pass i it is the time of tracing, building, gathering and direct light of passes 1 to i, plus
// what the one estimate at i took; what earlier estimates took is not in it. So the choice of recorded passes changes
// no number. Hit points, metrics and files are never in it. What methods share (photons, and the maps over them) is
// charged in full to each, as if it ran alone.

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

/// The photons of a pass indexed on one thread, while the others sample direct light at the hit points of every method.
struct OverlappedWork {
    double seconds = 0.0;            ///< from the first of it to the last
    double build_seconds = 0.0;      ///< of indexing
    double build_cpu = 0.0;          ///< its CPU time
    std::vector<double> direct_cpu;  ///< of direct light, one a method
};

/// What it would have taken `method` alone: its own CPU time; of seconds, that share of all which its share of the CPU
/// time is, but at least what indexing took. They are divided between Build and Direct as the CPU time is.
StageTimes times_alone(const OverlappedWork& work, std::size_t method);

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

/// `method` is the index into the settings of run_methods().
using EstimateListener = std::function<void(std::size_t method, const RunState&, const Image&)>;
/// `is_new` is false for a pass that all methods had behind them when they were restored.
using PassListener = std::function<void(std::uint64_t pass, bool is_new)>;
/// Told whenever a method has gathered anew: ppm after every pass, photonmapper at every estimate.
using GatherListener = std::function<void(std::size_t method, std::uint64_t pass, const Integrator&)>;

/// How methods are stopped between two passes and continued later. Either may be empty.
struct Continuation {
    /// Asked for each method before the first pass: reads the state that was saved of it, if there is one.
    std::function<void(std::size_t method, const StateExchange& state)> restore;

    /// Asked after every pass, with the state of each method by index, to be saved or not; false ends the run there.
    std::function<bool(std::uint64_t pass, const std::vector<StateExchange>& states)> goes_on;
};

/// True when both trace the same photons in the same passes, gather at the same hit points, and are looked at after the
/// same passes.
bool can_run_together(const RunSettings& a, const RunSettings& b);

/// Runs one method, or several that can_run_together(). Calls `on_estimate` for each pass of `estimated`, method
/// by method, and `on_pass` after every pass; returns the last states. Each method's images are, to the bit, those
/// that it gives alone and without interruption: one that is restored waits for the others to reach its pass, and
/// photons of passes that photonmapper has behind it are traced again, for nobody's account.
std::vector<RunState> run_methods(
    const Scene& scene, const HitPoints& hit_points, const std::vector<RunSettings>& settings,
    const EstimateListener& on_estimate, const PassListener& on_pass = [](std::uint64_t, bool) {},
    const GatherListener& on_gather = [](std::size_t, std::uint64_t, const Integrator&) {},
    const Continuation& continuation = {});

}  // namespace photonlab
