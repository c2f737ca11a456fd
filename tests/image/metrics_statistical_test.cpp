// What the two halves of a reference are for: E[(x-A)(x-B)] is the true squared error, E[(x-r)^2] is that plus the
// variance of r = (A+B)/2, the floor. Checked by z-tests over independent references, each at a two-sided
// significance of 1e-6 (|z| < 4.892).

#include <gtest/gtest.h>

#include <algorithm>

#include "core/random.h"
#include "image/metrics.h"

namespace photonlab {
namespace {

constexpr double critical_z = 4.892;

struct Estimate {
    double mean = 0.0;
    double standard_error = 0.0;
};

Estimate mean_of(const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    double sum = 0.0, squares = 0.0;
    for (const double value : values) sum += value;
    for (const double value : values) squares += (value - sum / count) * (value - sum / count);
    return {sum / count, std::sqrt(squares / (count - 1.0) / count)};
}

// A scene of 64 pixels whose truth is known, an image with a fixed error of 0.05 in every value, and references
// whose halves carry uniform noise of standard deviation 0.2 each: the floor is 0.2^2 / 2, eight times the error.
struct Experiment {
    static constexpr std::size_t pixels = 64;
    static constexpr int references = 4000;
    static constexpr double error = 0.05;
    static constexpr double half_deviation = 0.2;
    static constexpr double true_mse = error * error;
    static constexpr double floor = half_deviation * half_deviation / 2.0;

    std::vector<double> mse, mse_unbiased, reference_floor;

    Experiment() {
        std::vector<ColorD> truth, image;
        for (std::size_t i = 0; i < pixels; ++i) {
            truth.emplace_back(0.1 + 0.05 * static_cast<double>(i));
            image.push_back(truth.back() + ColorD(i % 2 ? error : -error));
        }
        for (int seed = 0; seed < references; ++seed) {
            const auto half = [&](RandomPurpose purpose) {
                std::vector<ColorD> noisy = truth;
                for (std::size_t i = 0; i < pixels; ++i) {
                    RandomStream random(static_cast<std::uint64_t>(seed), purpose, 0, i);
                    for (int channel = 0; channel < 3; ++channel)
                        noisy[i][channel] += half_deviation * std::sqrt(12.0) * (random.next_double() - 0.5);
                }
                return noisy;
            };
            ReferencePixels reference{.mean = {},
                                      .half_a = half(RandomPurpose::ReferenceHalfA),
                                      .half_b = half(RandomPurpose::ReferenceHalfB)};
            for (std::size_t i = 0; i < pixels; ++i)
                reference.mean.push_back((reference.half_a[i] + reference.half_b[i]) * 0.5);
            const ErrorMetrics metrics = compare(image, reference);
            mse.push_back(metrics.of("mse").value());
            mse_unbiased.push_back(metrics.of("mse_unbiased").value());
            reference_floor.push_back(metrics.of("reference_floor").value());
        }
    }
};

const Experiment& experiment() {
    static const Experiment once;
    return once;
}

void expect_mean(const std::vector<double>& values, double expected) {
    const Estimate estimate = mean_of(values);
    EXPECT_LT(std::abs(estimate.mean - expected), critical_z * estimate.standard_error)
        << "mean " << estimate.mean << " +- " << estimate.standard_error << ", expected " << expected;
}

TEST(MetricsOverReferences, UnbiasedMseHasTheTrueMseAsItsMean) {
    expect_mean(experiment().mse_unbiased, Experiment::true_mse);
}

TEST(MetricsOverReferences, MseIsTooHighByTheFloor) {
    expect_mean(experiment().mse, Experiment::true_mse + Experiment::floor);
}

TEST(MetricsOverReferences, TheReportedFloorHasTheReferencesVarianceAsItsMean) {
    expect_mean(experiment().reference_floor, Experiment::floor);
}

// That the tests above can fail: they tell the two apart by many times their critical value.
TEST(MetricsOverReferences, TheTestHasThePowerToSeeTheFloor) {
    const Estimate estimate = mean_of(experiment().mse);
    EXPECT_GT(std::abs(estimate.mean - Experiment::true_mse), 100.0 * critical_z * estimate.standard_error);
}

}  // namespace
}  // namespace photonlab
