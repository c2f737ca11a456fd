// Runs of methods on one scene, side by side: pass after pass, with the images at the passes that somebody asked for,
// and with what it takes to stop between two passes and to go on later.

#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "render/pass_loop.h"

namespace photonlab {

/// `method` is the index into the settings of run_methods().
using ImageListener = std::function<void(std::size_t method, const RunState&, const Image&)>;
/// `is_new` is false for a pass that all methods had behind them when they were restored.
using PassListener = std::function<void(std::uint64_t pass, bool is_new)>;
/// Told whenever a method has gathered anew: ppm after every pass, photonmapper at every image.
using GatherListener = std::function<void(std::size_t method, std::uint64_t pass, const Integrator&)>;

/// How methods are stopped between two passes and continued later. Either may be empty.
struct Continuation {
    /// Asked for each method before the first pass: reads the state that was saved of it, if there is one.
    std::function<void(std::size_t method, const StateExchange& state)> restore;

    /// Asked after every pass, with the state of each method by index, to be saved or not; false ends the run there.
    std::function<bool(std::uint64_t pass, const std::vector<StateExchange>& states)> goes_on;

    /// Asked after every pass with the image of the only method: true makes it the last, and shown like it.
    std::function<bool(std::uint64_t pass, const Image& image)> is_good_enough;
};

/// Runs one method, or several that can_run_together(). Calls `on_image` for each pass of `shown`, method by method,
/// and `on_pass` after every pass; returns the last states. Each method's images are, to the bit, those that it gives
/// alone and without interruption: one that is restored waits for the others to reach its pass, and photons of passes
/// that photonmapper has behind it are traced again, for nobody's account.
std::vector<RunState> run_methods(
    const Scene& scene, const HitPoints& hit_points, const std::vector<RunSettings>& settings,
    const ImageListener& on_image, const PassListener& on_pass = [](std::uint64_t, bool) {},
    const GatherListener& on_gather = [](std::size_t, std::uint64_t, const Integrator&) {},
    const Continuation& continuation = {});

}  // namespace photonlab
