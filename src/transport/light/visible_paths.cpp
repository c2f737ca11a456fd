#include "transport/light/visible_paths.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "core/random.h"
#include "transport/light/light_path.h"

namespace photonlab {

namespace {

/// Answers as RandomStream does, from the next_double() of `Coordinates`.
template <typename Coordinates>
class AsRandomStream {
public:
    /// A multiple of 2^-24.
    float next() {
        return static_cast<float>(std::floor(static_cast<Coordinates&>(*this).next_double() * 0x1p24) * 0x1p-24);
    }
    Imath::V2f next_2d() {
        const float x = next();
        return {x, next()};
    }
};

/// The numbers of a path as a vector in [0, 1)^n, as light_path.h draws them; beyond its end they are fresh.
class PrimarySample : public AsRandomStream<PrimarySample> {
public:
    PrimarySample(std::vector<double>& coordinates, RandomStream& random)
        : coordinates_(coordinates), random_(random) {}

    double next_double() {
        if (used_ == coordinates_.size()) coordinates_.push_back(random_.next_double());
        return coordinates_[used_++];
    }

private:
    std::vector<double>& coordinates_;
    RandomStream& random_;
    std::size_t used_ = 0;
};

/// The numbers of a mutation of a path: each a small or large step from the path's own, u +- xi^(1/d + 1) modulo 1.
/// Where the mutation is longer than its path was, the path's vector grows, as if it had always been as long.
class MutatedSample : public AsRandomStream<MutatedSample> {
public:
    MutatedSample(std::vector<double>& from, std::vector<double>& to, double step_size, RandomStream& random)
        : from_(from), to_(to), exponent_(1.0 / step_size + 1.0), random_(random) {
        to_.clear();
    }

    double next_double() {
        if (to_.size() == from_.size()) from_.push_back(random_.next_double());
        to_.push_back(mutate(from_[to_.size()]));
        return to_.back();
    }

    /// The numbers that the mutation did not need are changed as well.
    void finish() {
        while (to_.size() < from_.size()) to_.push_back(mutate(from_[to_.size()]));
    }

private:
    double mutate(double u) {
        const double step = std::pow(random_.next_double(), exponent_);
        const double moved = (random_.next_bits() & 1u) != 0 ? u + step : u - step;
        const double wrapped = moved - std::floor(moved);
        return wrapped < 1.0 ? wrapped : 0.0;  // rounding of a number just below 0
    }

    std::vector<double>& from_;
    std::vector<double>& to_;
    const double exponent_;
    RandomStream& random_;
};

/// What a chain leaves of a pass.
struct ChainPass {
    PhotonPass result;
    std::uint64_t seen = 0;  // fresh paths
    std::uint64_t mutated = 0;
    std::uint64_t accepted = 0;
    std::uint64_t tried = 0;  // paths before the first step
};

/// One chain during one pass.
class Chain {
public:
    Chain(const Scene& scene, const PhotonSettings& settings, const IsAccepted& is_accepted, double step_size,
          RandomStream random, ChainPass& pass)
        : scene_(scene),
          settings_(settings),
          is_accepted_(is_accepted),
          step_size_(step_size),
          random_(random),
          pass_(pass) {}

    /// Goes on from a state of the pass before, or by rejection. False when that finds nothing, or when another chain
    /// has given up.
    bool begin(std::vector<double> state, std::atomic<bool>& is_given_up) {
        if (!state.empty()) {
            ++pass_.tried;
            PrimarySample numbers(state, random_);
            if (trace(numbers)) {
                become(state);
                return true;
            }
        }
        for (std::uint64_t tried = 0; tried < VisiblePaths::most_tries && !is_given_up; ++tried) {
            ++pass_.tried;
            if (!trace_fresh()) continue;
            become(tried_);
            return true;
        }
        is_given_up = true;
        return false;
    }

    void step() {
        if (trace_fresh()) {
            ++pass_.seen;
            become(tried_);
        } else {
            ++pass_.mutated;
            MutatedSample numbers(state_, tried_, step_size_, random_);
            if (trace(numbers)) {
                ++pass_.accepted;
                numbers.finish();
                become(tried_);
            }
        }
        ++multiplicity_;
    }

    /// Returns the state, once all steps are done.
    std::vector<double> finish() {
        leave();
        return std::move(state_);
    }

private:
    bool trace_fresh() {
        tried_.clear();
        PrimarySample numbers(tried_, random_);
        return trace(numbers);
    }

    /// Traces the path of these numbers; true when it is seen. One that carries nothing is not.
    template <typename Numbers>
    bool trace(Numbers& numbers) {
        traced_.photons.clear();
        const EmissionSample emission = draw_emission(scene_, numbers);
        if (emission.weight == Color(0.0f)) return false;
        follow_light(scene_, settings_, emission, numbers, traced_);
        pass_.result.paths_cut += std::exchange(traced_.paths_cut, 0);
        pass_.result.power_cut += std::exchange(traced_.power_cut, 0.0);
        pass_.result.nonfinite += std::exchange(traced_.nonfinite, 0);
        return std::any_of(traced_.photons.begin(), traced_.photons.end(),
                           [&](const Photon& photon) { return is_accepted_(photon); });
    }

    /// Makes the path that was traced last, and whose numbers these are, the state.
    void become(std::vector<double>& numbers) {
        leave();
        std::swap(state_, numbers);
        std::swap(photons_, traced_.photons);
    }

    /// Leaves the photons of the state as often as it was one.
    void leave() {
        if (multiplicity_ == 0) return;
        std::vector<Photon>& photons = pass_.result.photons;
        photons.insert(photons.end(), photons_.begin(), photons_.end());
        pass_.result.notes.multiplicity.resize(photons.size(), std::exchange(multiplicity_, 0));
    }

    const Scene& scene_;
    const PhotonSettings& settings_;
    const IsAccepted& is_accepted_;
    const double step_size_;
    RandomStream random_;
    ChainPass& pass_;
    std::vector<double> state_;
    std::vector<double> tried_;
    PhotonPass traced_;
    std::vector<Photon> photons_;  // of the state
    std::uint32_t multiplicity_ = 0;
};

}  // namespace

PhotonPass VisiblePaths::trace(const Scene& scene, const PhotonSettings& settings, std::uint64_t pass,
                               const IsAccepted& is_accepted, int threads) {
    PhotonPass result;
    result.paths_emitted = settings.paths;
    if (scene.emitters.empty()) return result;
    const bool goes_on = settings_.keeps_states && has_fixed_steps(pass - 1);
    std::vector<ChainPass> chains(settings_.chains);
    std::atomic<bool> is_given_up = false;
    parallel_for(chains.size(), threads, [&](std::size_t index) {
        const std::uint64_t steps = settings.paths / chains.size() + (index < settings.paths % chains.size() ? 1 : 0);
        if (steps == 0 || is_given_up) return;
        Chain chain(scene, settings, is_accepted, step_size_,
                    RandomStream(settings.seed, RandomPurpose::VisiblePaths, pass, index), chains[index]);
        if (!chain.begin(goes_on ? std::move(states_[index]) : std::vector<double>(), is_given_up)) return;
        for (std::uint64_t step = 0; step < steps; ++step) chain.step();
        std::vector<double> last = chain.finish();
        if (settings_.keeps_states) states_[index] = std::move(last);
    });

    if (is_given_up)
        throw InputError(scene.name, fmt::format("photon_paths visible: expected a path from a light that is seen "
                                                 "among {}, found none",
                                                 most_tries));
    std::uint64_t seen = 0;
    std::uint64_t mutated = 0;
    std::uint64_t accepted = 0;
    std::uint64_t tried = 0;
    for (const ChainPass& chain : chains) {
        append(result, chain.result);
        seen += chain.seen;
        mutated += chain.mutated;
        accepted += chain.accepted;
        tried += chain.tried;
    }
    result.paths_traced = settings.paths + mutated + tried;
    result.seen_share = static_cast<double>(seen) / static_cast<double>(settings.paths);
    result.chains = ChainReport{.step_size = step_size_};
    if (mutated > 0) result.chains->accepted = static_cast<double>(accepted) / static_cast<double>(mutated);
    adapt(pass, static_cast<double>(accepted), static_cast<double>(mutated));
    return result;
}

/// In the pass and all after it.
bool VisiblePaths::has_fixed_steps(std::uint64_t pass) const {
    return !settings_.adapts || (settings_.keeps_states && pass >= fixed_from);
}

void VisiblePaths::adapt(std::uint64_t pass, double accepted, double mutated) {
    constexpr double smallest_step = 1e-4;
    constexpr double largest_step = 1e3;
    accepted_ += accepted;
    mutated_ += mutated;
    if (has_fixed_steps(pass) || mutated == 0.0) return;
    const double i = static_cast<double>(pass);
    const double size = settings_.step_rule == StepRule::Logarithmic
                            ? step_size_ * std::exp((accepted / mutated / wanted_acceptance - 1.0) * std::pow(i, -0.6))
                            : step_size_ + (accepted_ / mutated_ - wanted_acceptance) / i;
    step_size_ = std::clamp(size, smallest_step, largest_step);
}

std::uint64_t VisiblePaths::bytes() const {
    std::uint64_t bytes = 0;
    for (const std::vector<double>& state : states_) bytes += state.capacity() * sizeof(double);
    return bytes;
}

void VisiblePaths::exchange(StateArchive& archive) {
    archive.exchange(step_size_);
    archive.exchange(accepted_);
    archive.exchange(mutated_);
    for (std::vector<double>& state : states_) archive.exchange(state);
}

}  // namespace photonlab
