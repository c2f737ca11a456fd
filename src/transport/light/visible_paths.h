// Light paths that are seen: a Markov chain over the random numbers of paths that stays where the camera looks, so that
// light through a gap, or for a close-up, is not left to chance.
//
// The state u of a chain is the vector of numbers that made a path; V(u) = 1 where some hit point accepts one of its
// photons. Each step draws a fresh path u'. If V(u') = 1 the chain jumps there: replica exchange with a chain that is
// uniform, and so needs no memory. If not, a mutation of u takes its place if it is seen. The photons of u count once
// more in any case. With b the share of fresh paths that were seen, n of these steps estimate what n paths would:
//
//     L = b sum over steps of phi / (n pi r^2)
//
// Whether a step jumps depends on u' alone, so each kind of step leaves "uniform over V" as it is. A chain that begins
// there, by rejection, and whose steps are of one size during a pass, has E[b sum phi] exactly right for any n. So step
// sizes change between passes alone. A state may be kept for the next pass only if the discs of that pass are within
// those of this one and do not depend on it: Knaus and Zwicker's radii at fixed hit points, and the disc's area. With
// radii that follow counts the discs shrank because of the state, and a kept one is biased by 8% in an example of two
// discs. Nor may the step size depend on a state that is kept: it is adapted in the first passes, each of which begins
// by rejection.
//
// Hachisuka & Jensen 2011, "Robust Adaptive Photon Tracing Using Photon Path Visibility": states, exchange, mutation,
// its adaptive size. Ours: the starts, sizes that change between passes, the rule "logarithmic", 64 chains, and
// multiplicity in place of copies.

#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "core/files/state_archive.h"
#include "scene/scene.h"
#include "transport/light/photons.h"
#include "transport/light/step_rule.h"

namespace photonlab {

/// True for a photon that some hit point of the pass accepts; asked on any thread.
using IsAccepted = std::function<bool(const Photon&)>;

struct VisiblePathSettings {
    std::size_t chains = 64;  ///< each has its share of a pass's steps, and a stream of its own
    StepRule step_rule = StepRule::Logarithmic;
    bool keeps_states = false;  ///< from pass to pass, once the step size is fixed; see above for when that is right
    double first_step_size = 1.0;
    bool adapts = true;  ///< the step size
};

class VisiblePaths {
public:
    static constexpr double wanted_acceptance = 0.234;
    static constexpr std::uint64_t most_tries = 10'000'000;  ///< of a chain, to find a path that is seen
    static constexpr std::uint64_t fixed_from = 16;  ///< where states are kept: the pass from which step sizes stay

    explicit VisiblePaths(const VisiblePathSettings& settings)
        : settings_(settings), step_size_(settings.first_step_size), states_(settings.chains) {}

    /// Makes pass `pass`, in order from 1 on; `settings.paths` are steps. Photons come chain by chain, each with its
    /// multiplicity. Throws InputError when a chain finds no path that is seen in `most_tries`, and all end.
    PhotonPass trace(const Scene& scene, const PhotonSettings& settings, std::uint64_t pass,
                     const IsAccepted& is_accepted, int threads);

    double step_size() const { return step_size_; }  ///< d of the next pass; the mean step is d / (1 + 2 d)
    std::uint64_t bytes() const;

    /// Writes or reads step size and states, between two passes.
    void exchange(StateArchive& archive);

private:
    bool has_fixed_steps(std::uint64_t pass) const;
    void adapt(std::uint64_t pass, double accepted, double mutated);

    const VisiblePathSettings settings_;
    double step_size_;
    double accepted_ = 0.0;  // mutations, over all passes
    double mutated_ = 0.0;
    std::vector<std::vector<double>> states_;  // empty: the chain begins by rejection
};

}  // namespace photonlab
