#include "image/metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
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

double square(double x) {
    return x * x;
}

}  // namespace

/// One channel of one pixel: of the image, of the reference, and of its halves, which are 0 where it has none.
struct ComparedValue {
    double x, r, a, b;
};

class ComparedPixels {
public:
    ComparedPixels(const std::vector<ColorD>& image, const ReferencePixels& reference)
        : image_(image), reference_(reference) {}

    /// Of a function of ComparedValue over all values. Without one finite pixel there is nothing to take a mean of: 0/0
    /// says so, where 0 would claim a perfect image.
    template <typename Function>
    double mean(const Function& function) const {
        CompensatedSum sum;
        std::size_t count = 0;
        for_each([&](const ComparedValue& value) {
            sum.add(function(value));
            ++count;
        });
        return sum.value() / static_cast<double>(count);
    }

    template <typename Function>
    double largest(const Function& function) const {
        std::optional<double> largest;
        for_each([&](const ComparedValue& value) {
            largest = std::max(largest.value_or(-std::numeric_limits<double>::infinity()), function(value));
        });
        return largest.value_or(std::numeric_limits<double>::quiet_NaN());
    }

private:
    template <typename Visitor>
    void for_each(const Visitor& visit) const {
        const bool has_halves = !reference_.half_a.empty();
        for (std::size_t i = 0; i < image_.size(); ++i) {
            if (!is_finite(image_[i])) continue;
            for (int channel = 0; channel < 3; ++channel)
                visit(ComparedValue{image_[i][channel], reference_.mean[i][channel],
                                    has_halves ? reference_.half_a[i][channel] : 0.0,
                                    has_halves ? reference_.half_b[i][channel] : 0.0});
        }
    }

    const std::vector<ColorD>& image_;
    const ReferencePixels& reference_;
};

const std::vector<Metric>& metrics() {
    using Pixels = ComparedPixels;
    using Value = ComparedValue;
    static const std::vector<Metric> table{
        {"mse", "radiance²", "MSE with noise", "mean of (x - r)²: has the reference's own variance as its floor", false,
         [](const Pixels& pixels) { return pixels.mean([](const Value& v) { return square(v.x - v.r); }); }},
        {"mse_unbiased", "radiance²", "MSE",
         "mean of (x - A)(x - B): an unbiased estimate of the true MSE, free of the reference's noise, so it can be "
         "negative near 0",
         true,
         [](const Pixels& pixels) { return pixels.mean([](const Value& v) { return (v.x - v.a) * (v.x - v.b); }); }},
        {"rmse", "radiance", "RMSE with noise", "root of `mse`", false,
         [](const Pixels& pixels) { return std::sqrt(pixels.mean([](const Value& v) { return square(v.x - v.r); })); }},
        {"relmse", "", "relMSE",
         "mean of (x - r)² / (r² + 0.01); the 0.01 is in squared units of radiance, so it depends on the scene's "
         "brightness",
         false,
         [](const Pixels& pixels) {
             return pixels.mean([](const Value& v) { return square(v.x - v.r) / (v.r * v.r + 0.01); });
         }},
        {"relmse_unbiased", "", "relMSE without the reference's noise",
         "mean of (x - A)(x - B) / (r² + 0.01), as `mse_unbiased`; the noise that is left in the weights moves it by "
         "the noise squared",
         true,
         [](const Pixels& pixels) {
             return pixels.mean([](const Value& v) { return (v.x - v.a) * (v.x - v.b) / (v.r * v.r + 0.01); });
         }},
        {"smape", "", "SMAPE", "mean of |x - r| / (|x| + |r| + 1e-6), the 1e-6 in units of radiance", false,
         [](const Pixels& pixels) {
             return pixels.mean(
                 [](const Value& v) { return std::abs(v.x - v.r) / (std::abs(v.x) + std::abs(v.r) + smape_epsilon); });
         }},
        {"bias", "radiance", "mean error", "mean of x - r, signed", false,
         [](const Pixels& pixels) { return pixels.mean([](const Value& v) { return v.x - v.r; }); }},
        {"max_error", "radiance", "largest error", "largest |x - r|", false,
         [](const Pixels& pixels) { return pixels.largest([](const Value& v) { return std::abs(v.x - v.r); }); }},
        {"reference_floor", "radiance²", "floor of the reference",
         "mean of (A - B)²/4: the variance of r, the floor under `mse`", true,
         [](const Pixels& pixels) { return pixels.mean([](const Value& v) { return 0.25 * square(v.a - v.b); }); }},
    };
    return table;
}

std::optional<double> ErrorMetrics::of(std::string_view metric) const {
    const auto at =
        std::find_if(metrics().begin(), metrics().end(), [&](const Metric& known) { return known.name == metric; });
    assert(at != metrics().end());
    return values[static_cast<std::size_t>(at - metrics().begin())];
}

ErrorMetrics compare(const std::vector<ColorD>& image, const ReferencePixels& reference) {
    assert(image.size() == reference.mean.size());
    assert(reference.half_a.size() == reference.half_b.size());
    const bool has_halves = !reference.half_a.empty();
    assert(!has_halves || reference.half_a.size() == image.size());
    require_finite(reference.mean);
    require_finite(reference.half_a);
    require_finite(reference.half_b);

    ErrorMetrics errors;
    for (std::size_t i = 0; i < image.size(); ++i)
        if (!is_finite(image[i]) && errors.nonfinite++ == 0) errors.first_nonfinite = i;
    const ComparedPixels pixels(image, reference);
    for (const Metric& metric : metrics())
        errors.values.push_back(metric.needs_halves && !has_halves ? std::nullopt : std::optional(metric.of(pixels)));
    return errors;
}

std::string describe_rmse(const ErrorMetrics& errors) {
    const std::optional<double> unbiased = errors.of("mse_unbiased");
    if (!unbiased) return fmt::format("{:.4g} with the reference's noise, which is not known", *errors.of("rmse"));
    if (!(*unbiased > 0.0)) return "below what the reference can tell";
    return fmt::format("{:.6g} without the reference's noise", std::sqrt(*unbiased));
}

}  // namespace photonlab
