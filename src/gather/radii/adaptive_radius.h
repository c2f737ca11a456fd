// The radius at which bias and variance of the running mean are in their best balance, from what the passes so far say
// of both: the Laplacian of the light around the point, and the variance of its estimate.
//
// With one pass's bias c r^2 Delta and variance V1 / r^2, and r_i = s i^(-1/6), the mean of i passes has bias
// 3/2 c s^2 Delta i^(-1/3) and variance 3/4 V1 s^-2 i^(-2/3); their sum of squares is least for
//
//     r_i^6 = V1 / (kappa c^2 Delta^2) / i,   kappa = 6                                     (docs/theory.md, section 9)
//
// After Kaplanyan & Dachsbacher 2013, "Adaptive Progressive Photon Mapping", whose rate i^(-1/6) it is. Ours are kappa
// (6 for shrinking radii; 2 would be the best fixed radius), the curvature kernel (moments.h) in place of a stencil of
// smooth kernels, its bandwidth, and the clamps.

#pragma once

#include <vector>

#include "gather/radii/radius_rule.h"

namespace photonlab {

/// Squared bandwidth of the curvature kernel in pass `pass` of a region: h_i = share r_1 i^(-1/10), the optimal rate
/// for second derivatives in the plane.
double squared_curvature_bandwidth(double share, double initial_squared_radius, std::uint64_t pass);

/// What the passes of a region so far say, each a mean over passes.
struct CurvatureStatistics {
    double variance = 0.0;           ///< V1: mean of r_k^2 sum (phi K)^2 / n^2, all channels
    ColorD laplacian = ColorD(0.0);  ///< Delta
    double noise = 0.0;              ///< W: mean of sum (phi D)^2 / n^2; the variance of Delta is W / passes

    void take(const Curvature& curvature, double squared_radius, std::uint64_t passes);
};

/// The squared radius for pass `passes` + 1 of a region.
double adaptive_squared_radius(const CurvatureStatistics& statistics, const RadiusRuleSettings& settings,
                               double initial_squared_radius, std::uint64_t passes);

class AdaptiveRadius : public RadiusRule {
public:
    AdaptiveRadius(const RadiusRuleSettings& settings, std::size_t regions)
        : settings_(settings), statistics_(regions) {}

    bool wants_curvature() const override { return true; }
    void take(std::size_t region, const PassGather& gathered, GatherStatistics& statistics) override;
    void exchange(StateArchive& archive) override { archive.exchange_as_many(statistics_); }
    std::uint64_t bytes() const override { return statistics_.size() * sizeof(CurvatureStatistics); }

private:
    const RadiusRuleSettings settings_;
    std::vector<CurvatureStatistics> statistics_;
};

}  // namespace photonlab
