#include "gather/radii/adaptive_radius.h"

#include <algorithm>
#include <cmath>

namespace photonlab {

double squared_curvature_bandwidth(double share, double initial_squared_radius, std::uint64_t pass) {
    return share * share * initial_squared_radius * std::pow(static_cast<double>(pass), -0.2);
}

void CurvatureStatistics::take(const Curvature& curvature, double squared_radius, std::uint64_t passes) {
    const double share = 1.0 / static_cast<double>(passes);
    variance += (squared_radius * curvature.squared_estimate - variance) * share;
    laplacian += (curvature.laplacian - laplacian) * share;
    noise += (curvature.squared_laplacian - noise) * share;
}

double adaptive_squared_radius(const CurvatureStatistics& statistics, const RadiusRuleSettings& settings,
                               double initial_squared_radius, std::uint64_t passes) {
    const double fall = std::cbrt(1.0 / static_cast<double>(passes + 1));
    const double largest = settings.largest_radius * settings.largest_radius * initial_squared_radius;
    const double smallest = settings.smallest_radius * settings.smallest_radius * initial_squared_radius;
    if (statistics.variance == 0.0) return initial_squared_radius * fall;
    // The cube root of V1 / (kappa c^2 Delta^2), from a ratio whose size does not depend on the unit of light: squares
    // of very faint light are no numbers.
    const double strength = std::sqrt(statistics.laplacian.length2());
    const double ratio = std::sqrt(statistics.variance) / (bias_constant(settings.kernel) * strength);
    const double best = strength > 0.0 ? std::cbrt(ratio * ratio / settings.kappa) : largest;
    return std::clamp(best, smallest, largest) * fall;
}

void AdaptiveRadius::take(std::size_t region, const PassGather& gathered, GatherStatistics& statistics) {
    CurvatureStatistics& known = statistics_[region];
    known.take(*gathered.curvature, statistics.squared_radius, gathered.passes);
    statistics.count += gathered.found;
    statistics.squared_radius =
        adaptive_squared_radius(known, settings_, gathered.initial_squared_radius, gathered.passes);
}

}  // namespace photonlab
