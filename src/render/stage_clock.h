// The parts of a pass and how long each took, by the steady clock and of the processor.
//
// What time means: at pass i it is that of the passes 1 to i, plus what the one image at i took; what earlier images
// took is not in it. So the choice of recorded passes changes no number. Fixed hit points, metrics and files are never
// in it. What methods share is charged in full to each, as if it ran alone.

#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace photonlab {

/// Parts of a pass that are timed apart.
enum class Stage {
    Trace,   ///< photons; paths of `path`
    Build,   ///< maps over photons
    Gather,  ///< what methods do with them
    Direct,  ///< shadow rays
    Points,  ///< the camera pass of methods with new hit points in every pass
    Relax,   ///< moving photons that a method holds, and giving them their flux
};
inline constexpr std::size_t stage_count = 6;

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

/// What one step of a pass takes.
template <typename Step>
StageTimes timed(Stage stage, const Step& step) {
    StageClock clock;
    clock.enter(stage);
    step();
    clock.stop();
    return clock.times();
}

/// The photons of a pass indexed, while other threads sample direct light at the hit points of every method.
struct OverlappedWork {
    double seconds = 0.0;            ///< from the first of it to the last
    double build_seconds = 0.0;      ///< of indexing
    double build_cpu = 0.0;          ///< its CPU time
    std::vector<double> direct_cpu;  ///< of direct light, one a method
};

/// What it would have taken `method` alone: its own CPU time; of seconds, that share of all which its share of the CPU
/// time is, but at least what indexing took. They are divided between Build and Direct as the CPU time is.
StageTimes times_alone(const OverlappedWork& work, std::size_t method);

double steady_seconds();      ///< since some fixed moment
double thread_cpu_seconds();  ///< of the calling thread
double process_cpu_seconds();

}  // namespace photonlab
