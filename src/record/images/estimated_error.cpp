#include "record/images/estimated_error.h"

#include <boost/math/distributions/students_t.hpp>

#include <cmath>

namespace photonlab {

namespace {

/// What |t| of Student's distribution stays below with probability `share`.
double two_sided_quantile(double share, std::uint64_t passes) {
    const boost::math::students_t distribution(static_cast<double>(passes - 1));
    return boost::math::quantile(distribution, 0.5 * (1.0 + share));
}

/// Calls `take(pixel, bias, deviation)` for every pixel whose noise is known.
template <typename Take>
void for_each_known(const EstimatedError& estimate, const Take& take) {
    if (estimate.passes < 2) return;
    for (std::size_t pixel = 0; pixel < estimate.bias.size(); ++pixel)
        if (estimate.deviation[pixel] > 0.0f)
            take(pixel, static_cast<double>(estimate.bias[pixel]), static_cast<double>(estimate.deviation[pixel]));
}

}  // namespace

std::optional<JudgedEstimate> judge_estimate(const EstimatedError& estimate, const std::vector<Color>& gathered,
                                             const std::vector<ColorD>& truth) {
    double count = 0.0;
    double half = 0.0;
    double nine_tenths = 0.0;
    JudgedEstimate judged;
    const double of_half = estimate.passes < 2 ? 0.0 : two_sided_quantile(0.5, estimate.passes);
    const double of_nine_tenths = estimate.passes < 2 ? 0.0 : two_sided_quantile(0.9, estimate.passes);
    for_each_known(estimate, [&](std::size_t pixel, double bias, double deviation) {
        count += 1.0;
        judged.bias += bias * bias;
        judged.deviation += deviation * deviation;
        if (truth.empty()) return;
        const double error = mean_channel(ColorD(gathered[pixel])) - mean_channel(truth[pixel]);
        half += std::abs(error - bias) <= of_half * deviation;
        nine_tenths += std::abs(error - bias) <= of_nine_tenths * deviation;
    });
    if (count == 0.0) return std::nullopt;
    judged.bias = std::sqrt(judged.bias / count);
    judged.deviation = std::sqrt(judged.deviation / count);
    if (truth.empty()) return judged;
    judged.within_50 = half / count;
    judged.within_90 = nine_tenths / count;
    return judged;
}

double share_within(const EstimatedError& estimate, const std::vector<Color>& gathered, double relative_error,
                    double confidence) {
    if (estimate.passes < 2) return 0.0;
    const double quantile = two_sided_quantile(confidence, estimate.passes);
    double known = 0.0;
    double within = 0.0;
    for_each_known(estimate, [&](std::size_t pixel, double bias, double deviation) {
        known += 1.0;
        const double value = std::abs(mean_channel(ColorD(gathered[pixel])) - bias);
        within += std::abs(bias) + quantile * deviation <= relative_error * value;
    });
    return known > 0.0 ? within / known : 0.0;
}

}  // namespace photonlab
