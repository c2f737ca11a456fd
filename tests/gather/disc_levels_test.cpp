// How often the disc tests are wrong and right about photons that were drawn: levels with fixed seeds, within four
// standard errors of a share over the trials.

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "gather/radii/disc_tests.h"

namespace photonlab {
namespace {

constexpr int trials = 100'000;

double standard_error(double share, int of = trials) {
    return std::sqrt(share * (1.0 - share) / of);
}

/// Share of trials in which `photons` photons of density 1 + slope x on the disc fail the test.
double rejected(int photons, double slope, TestVariant variant, std::uint64_t pass, int of = trials) {
    int failed = 0;
    for (int trial = 0; trial < of; ++trial) {
        RandomStream random(1, RandomPurpose::Test, pass, static_cast<std::uint64_t>(trial));
        Bins counts{};
        for (int placed = 0; placed < photons;) {
            const double x = 2.0 * static_cast<double>(random.next()) - 1.0;
            const double y = 2.0 * static_cast<double>(random.next()) - 1.0;
            if (x * x + y * y >= 1.0 || static_cast<double>(random.next()) * (1.0 + slope) > 1.0 + slope * x) continue;
            counts[sector_of(x, y, x * x + y * y)] += 1.0;
            ++placed;
        }
        failed += !passes_chi_square(counts, sector_count, variant);
    }
    return static_cast<double>(failed) / of;
}

// The chi-square approximation is good from 100 photons on: within half a percent of 5%.
TEST(ChiSquareLevel, OfUniformPhotonsIsFivePercent) {
    EXPECT_NEAR(rejected(100, 0.0, TestVariant::Plain, 1), 0.05, 0.005);
    EXPECT_NEAR(rejected(100, 0.0, TestVariant::Pooled, 2), 0.05, 0.005);
    EXPECT_NEAR(rejected(100, 0.0, TestVariant::LinearFit, 3), 0.05, 0.005);
}

// 1000 photons with a slope of 30%: the plain test refuses them, though they leave no bias; the others do not.
TEST(ChiSquareLevel, OfALinearDensityIsFivePercentForThoseThatAllowOne) {
    constexpr int few = 10'000;
    EXPECT_NEAR(rejected(1000, 0.3, TestVariant::Plain, 4, few), 0.88, 0.02);
    EXPECT_NEAR(rejected(1000, 0.3, TestVariant::LinearFit, 5, few), 0.05, 0.005 + 4.0 * standard_error(0.05, few));
    EXPECT_NEAR(rejected(1000, 0.3, TestVariant::Pooled, 6, few), 0.05, 0.005 + 4.0 * standard_error(0.05, few));
}

/// Share of trials in which even photons with log-normal weights, `together` of them in one place, fail the F-test of
/// `passes` passes with 200 places each.
double f_rejected(int together, std::uint64_t stream) {
    constexpr int passes = 10;
    constexpr int few = 4000;
    int failed = 0;
    for (int trial = 0; trial < few; ++trial) {
        RandomStream random(1, RandomPurpose::Test, stream, static_cast<std::uint64_t>(trial));
        Bins sums{};
        Bins squares{};
        for (int pass = 0; pass < passes; ++pass) {
            Bins flux{};
            for (int place = 0; place < 200; ++place) {
                const auto bin = static_cast<std::size_t>(random.next() * 12.0f);
                const double u = static_cast<double>(random.next()) + 1e-9;
                const double normal = std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * pi * random.next_double());
                flux[bin] += together * std::exp(normal);
            }
            for (std::size_t bin = 0; bin < 12; ++bin) {
                sums[bin] += flux[bin];
                squares[bin] += flux[bin] * flux[bin];
            }
        }
        failed += !(f_ratio(sums, squares, 12, passes) < f_critical(12, passes));
    }
    return static_cast<double>(failed) / few;
}

// Weights that differ, and photons that come in pairs, leave the F-test at its level: 5% within a percent and noise.
TEST(FTestLevel, IsKeptUnderHeavyWeightsAndPairs) {
    EXPECT_NEAR(f_rejected(1, 7), 0.05, 0.01 + 4.0 * standard_error(0.05, 4000));
    EXPECT_NEAR(f_rejected(2, 8), 0.05, 0.01 + 4.0 * standard_error(0.05, 4000));
}

}  // namespace
}  // namespace photonlab
