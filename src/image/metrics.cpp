#include "image/metrics.h"

#include <fmt/format.h>

#include <cassert>
#include <string>

#include "core/error.h"

namespace photonlab {

namespace {

// A sum that keeps what rounding takes: bias adds millions of terms of both signs that nearly cancel, and one
// firefly must not swallow the errors of all other pixels.
// [Neumaier 1974, "Rundungsfehleranalyse einiger Verfahren zur Summation endlicher Summen"]
class CompensatedSum {
public:
    void add(double term) {
        const double next = sum_ + term;
        lost_ += std::abs(sum_) >= std::abs(term) ? (sum_ - next) + term : (term - next) + sum_;
        sum_ = next;
    }
    // An overflowed sum is infinite, and what was lost on the way is inf - inf.
    double value() const { return std::isfinite(sum_) ? sum_ + lost_ : sum_; }

private:
    double sum_ = 0.0;
    double lost_ = 0.0;
};

void require_finite(const std::vector<ColorD>& reference) {
    for (std::size_t i = 0; i < reference.size(); ++i)
        if (!is_finite(reference[i]))
            throw InputError("the reference is not finite at pixel " + std::to_string(i) +
                             " (counted row by row from the top, from 0): no error can be measured against it");
}

}  // namespace

ErrorMetrics compare(const std::vector<ColorD>& image, const ReferencePixels& reference) {
    assert(image.size() == reference.mean.size());
    assert(reference.half_a.size() == reference.half_b.size());
    const bool has_halves = !reference.half_a.empty();
    assert(!has_halves || reference.half_a.size() == image.size());
    require_finite(reference.mean);
    require_finite(reference.half_a);
    require_finite(reference.half_b);

    ErrorMetrics metrics;
    CompensatedSum squared, unbiased, floor, relative, symmetric, difference;
    std::size_t values = 0;
    for (std::size_t i = 0; i < image.size(); ++i) {
        if (!is_finite(image[i])) {
            if (metrics.nonfinite++ == 0) metrics.first_nonfinite = i;
            continue;
        }
        for (int channel = 0; channel < 3; ++channel) {
            const double x = image[i][channel];
            const double r = reference.mean[i][channel];
            const double error = x - r;
            squared.add(error * error);
            relative.add(error * error / (r * r + 0.01));
            symmetric.add(std::abs(error) / (std::abs(x) + std::abs(r) + smape_epsilon));
            difference.add(error);
            metrics.max_error = std::max(metrics.max_error, std::abs(error));
            if (has_halves) {
                const double a = reference.half_a[i][channel];
                const double b = reference.half_b[i][channel];
                unbiased.add((x - a) * (x - b));
                floor.add(0.25 * (a - b) * (a - b));
            }
            ++values;
        }
    }

    // Without one finite pixel there is nothing to take a mean of: 0/0 says so, where 0 would claim a perfect image.
    const double count = static_cast<double>(values);
    metrics.mse = squared.value() / count;
    metrics.rmse = std::sqrt(metrics.mse);
    metrics.relmse = relative.value() / count;
    metrics.smape = symmetric.value() / count;
    metrics.bias = difference.value() / count;
    if (values == 0) metrics.max_error = std::numeric_limits<double>::quiet_NaN();
    if (has_halves) {
        metrics.mse_unbiased = unbiased.value() / count;
        metrics.reference_floor = floor.value() / count;
    }
    return metrics;
}

std::string describe_rmse(const ErrorMetrics& metrics) {
    if (!metrics.mse_unbiased)
        return fmt::format("{:.4g} with the reference's noise, which is not known", metrics.rmse);
    if (!(*metrics.mse_unbiased > 0.0)) return "below what the reference can tell";
    return fmt::format("{:.6g} without the reference's noise", std::sqrt(*metrics.mse_unbiased));
}

}  // namespace photonlab
