// A hit point in a steady field of photons, where everything that a million passes make of it is known in closed form:
// what the tests of the update and the records of the figure share.
//
// Photons of density `density` a unit area and pass lie around it, without noise: a pass finds density * pi r^2. Its
// own estimate is off by a bias that grows with r^2, as that of every kernel does. Then with Hachisuka's update, after
// n passes (docs/theory.md, sections 1 and 2):
//
//     r_n^2 / r_0^2 = Gamma(n + alpha) / (Gamma(alpha) Gamma(n + 1))
//     N_n           = n density pi r_n^2
//     L_n           = L (1 + c mean of the r^2 used),    that mean / r_0^2 = Gamma(n + alpha) / (Gamma(1 + alpha)
//     Gamma(n + 1))
//
// In long double, since at n = 10^6 the logarithms of Gamma are of the order of 10^7 and their rounding alone would be
// 10^-9.

#pragma once

#include <cmath>
#include <cstdint>

#include "core/math.h"
#include "gather/radii/radius_rule.h"

namespace photonlab::test {

struct SteadyPoint {
    double alpha = 0.7;
    double initial_radius = 0.1;
    double photons_at_first = 1000.0;  ///< found by the first pass
    double radiance = 3.0;
    double bias_at_first = 0.5;  ///< of the first pass's estimate, relative
};

/// Radius, count and estimate, however they were computed.
struct PointState {
    double radius = 0.0;
    double count = 0.0;
    double estimate = 0.0;
};

inline PointState closed_form(const SteadyPoint& point, std::uint64_t passes) {
    const long double n = static_cast<long double>(passes);
    const long double a = point.alpha;
    const long double mean_squared = std::exp(std::lgamma(n + a) - std::lgamma(1.0L + a) - std::lgamma(n + 1.0L));
    const long double squared = a * mean_squared;  // both relative to the initial squared radius
    return {.radius = static_cast<double>(point.initial_radius * std::sqrt(squared)),
            .count = static_cast<double>(n * point.photons_at_first * squared),
            .estimate = static_cast<double>(point.radiance * (1.0L + point.bias_at_first * mean_squared))};
}

/// The program's own update.
class ProgramUpdate {
public:
    explicit ProgramUpdate(const SteadyPoint& point)
        : point_(point), rule_(make_radius_rule({.alpha = point.alpha}, 1)) {
        statistics_.squared_radius = point.initial_radius * point.initial_radius;
    }
    void take_pass() {
        ++passes_;
        const double share = statistics_.squared_radius / (point_.initial_radius * point_.initial_radius);
        photonlab::take_pass(statistics_, *rule_, 0,
                             {.pass = passes_,
                              .passes = passes_,
                              .found = point_.photons_at_first * share,
                              .estimate = ColorD(point_.radiance * (1.0 + point_.bias_at_first * share))},
                             0.0);
    }
    PointState state() const {
        return {std::sqrt(statistics_.squared_radius), statistics_.count, statistics_.estimate.x};
    }

private:
    const SteadyPoint point_;
    const std::unique_ptr<RadiusRule> rule_;
    GatherStatistics statistics_;
    std::uint64_t passes_ = 0;
};

/// The update as the 2008 paper prints it and as it is often written, in `Real`: the flux shrinks with the disc and the
/// estimate is flux / (pi R^2 passes). Here only to show what float does to it.
template <typename Real>
class PrintedUpdate {
public:
    explicit PrintedUpdate(const SteadyPoint& point)
        : point_(point), squared_radius_(static_cast<Real>(point.initial_radius * point.initial_radius)) {}
    void take_pass() {
        ++passes_;
        const double share = static_cast<double>(squared_radius_) / (point_.initial_radius * point_.initial_radius);
        const Real found = static_cast<Real>(point_.photons_at_first * share);
        const double brightness = point_.radiance * (1.0 + point_.bias_at_first * share);
        const Real flux = static_cast<Real>(brightness * pi * static_cast<double>(squared_radius_));
        const Real alpha = static_cast<Real>(point_.alpha);
        const Real shrink = (count_ + alpha * found) / (count_ + found);
        flux_ = (flux_ + flux) * shrink;
        squared_radius_ *= shrink;
        count_ += alpha * found;
    }
    PointState state() const {
        return {std::sqrt(static_cast<double>(squared_radius_)), static_cast<double>(count_),
                static_cast<double>(flux_ / (static_cast<Real>(pi) * squared_radius_ * static_cast<Real>(passes_)))};
    }

private:
    const SteadyPoint point_;
    Real squared_radius_;
    Real count_ = 0;
    Real flux_ = 0;
    std::uint64_t passes_ = 0;
};

/// Relative differences from the closed form.
inline PointState relative_errors(const PointState& state, const PointState& exact) {
    return {std::abs(state.radius / exact.radius - 1.0), std::abs(state.count / exact.count - 1.0),
            std::abs(state.estimate / exact.estimate - 1.0)};
}

}  // namespace photonlab::test
