// The statistics of the disc tests for given counts, and the steps that follow from them.

#include <gtest/gtest.h>

#include <cmath>

#include "gather/radii/disc_tests.h"

namespace photonlab {
namespace {

Bins all_equal(double value) {
    Bins bins{};
    bins.fill(value);
    return bins;
}

TEST(ChiSquare, OfGivenCountsIsANumber) {
    const Bins shares = all_equal(1.0 / 12.0);
    EXPECT_NEAR(chi_square(all_equal(5.0), shares, 12), 0.0, 1e-12);
    Bins one{};
    one[3] = 10.0;
    EXPECT_NEAR(chi_square(one, shares, 12), 110.0, 1e-12);
    EXPECT_EQ(chi_square({}, shares, 12), 0.0);
}

// Statistics just below and above the critical values: 19.6751 (11 degrees), 11.0705 (5), 16.9190 (9), 7.8147 (3),
// 5.9915 (2). Two bins that differ by 2d from each other have a statistic of 2 d^2 / N p.
TEST(ChiSquare, HasTheCriticalValuesOfItsDegrees) {
    const auto counts_of = [](double statistic, std::size_t bins, std::size_t up, std::size_t down) {
        Bins counts{};
        std::fill_n(counts.begin(), bins, 1000.0);
        const double difference = std::sqrt(0.5 * statistic * 1000.0);
        counts[up] += difference;
        counts[down] -= difference;
        return counts;
    };
    EXPECT_TRUE(passes_chi_square(counts_of(19.67, 12, 1, 2), 12, TestVariant::Plain));
    EXPECT_FALSE(passes_chi_square(counts_of(19.68, 12, 1, 2), 12, TestVariant::Plain));
    EXPECT_TRUE(passes_chi_square(counts_of(11.07, 6, 1, 2), 6, TestVariant::Plain));
    EXPECT_FALSE(passes_chi_square(counts_of(11.08, 6, 1, 2), 6, TestVariant::Plain));
    // Pooled: both bins join with opposite ones that are even, so that the statistic halves.
    EXPECT_TRUE(passes_chi_square(counts_of(2 * 11.07, 12, 1, 2), 12, TestVariant::Pooled));
    EXPECT_FALSE(passes_chi_square(counts_of(2 * 11.08, 12, 1, 2), 12, TestVariant::Pooled));
    EXPECT_TRUE(passes_chi_square(counts_of(2 * 5.991, 6, 1, 2), 6, TestVariant::Pooled));
    EXPECT_FALSE(passes_chi_square(counts_of(2 * 5.992, 6, 1, 2), 6, TestVariant::Pooled));
    // Linear fit: the same sector of both rings up and down changes the slope by nothing where opposite sectors change
    // alike; those of the rings against each other have no slope at all.
    const auto ring_counts = [](double statistic) {
        Bins counts{};
        for (std::size_t bin = 0; bin < 12; ++bin)
            counts[bin] = 1000.0 + (bin < 6 ? 1.0 : -1.0) * std::sqrt(statistic * 1000.0 / 12.0);
        return counts;
    };
    EXPECT_TRUE(passes_chi_square(ring_counts(16.91), 12, TestVariant::LinearFit));
    EXPECT_FALSE(passes_chi_square(ring_counts(16.93), 12, TestVariant::LinearFit));
    const auto pair_counts = [](double statistic) {  // two opposite pairs of the inner ring
        Bins counts{};
        std::fill_n(counts.begin(), 6, 1000.0);
        const double difference = std::sqrt(0.25 * statistic * 1000.0);
        counts[1] += difference;
        counts[4] += difference;
        counts[2] -= difference;
        counts[5] -= difference;
        return counts;
    };
    EXPECT_TRUE(passes_chi_square(pair_counts(7.81), 6, TestVariant::LinearFit));
    EXPECT_FALSE(passes_chi_square(pair_counts(7.82), 6, TestVariant::LinearFit));
}

/// Shares of the bins under the density (1 + slope . x) / pi, by sampling a fine grid.
Bins linear_density(double slope_x, double slope_y, double radius) {
    Bins shares{};
    constexpr int steps = 3000;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double x = ((i + 0.5) * 2.0 / steps - 1.0) * radius;
            const double y = ((j + 0.5) * 2.0 / steps - 1.0) * radius;
            if (x * x + y * y >= radius * radius) continue;
            const double cell = 4.0 * radius * radius / (static_cast<double>(steps) * steps);
            shares[sector_of(x, y, x * x + y * y)] += (1.0 + slope_x * x + slope_y * y) / pi * cell;
        }
    return shares;
}

TEST(LinearFit, FindsALinearDensityAgain) {
    const Bins counts = linear_density(0.4, -0.3, 1.0);
    const Bins fitted = linear_shares(counts, 12);
    for (std::size_t bin = 0; bin < 12; ++bin) EXPECT_NEAR(fitted[bin], counts[bin], 1e-4) << bin;
    double inner = 0.0;
    for (std::size_t bin = 0; bin < 6; ++bin) inner += counts[bin];
    const Bins inside = linear_shares(counts, 6);
    for (std::size_t bin = 0; bin < 6; ++bin) EXPECT_NEAR(inside[bin], counts[bin] / inner, 1e-4) << bin;
}

TEST(LinearFit, NeverExpectsLessThanNothing) {
    for (std::size_t only = 0; only < 12; ++only) {
        Bins counts{};
        counts[only] = 10.0;
        double sum = 0.0;
        for (const double share : linear_shares(counts, 12)) {
            EXPECT_GE(share, 0.0);
            sum += share;
        }
        EXPECT_NEAR(sum, 1.0, 1e-12);
    }
}

TEST(FRatio, OfGivenValuesIsANumber) {
    // Six bins with the values 0 and 2 each, but for the first with 6 and 8: means 7, 1, 1, 1, 1, 1.
    Bins sums{};
    Bins squares{};
    std::fill_n(sums.begin(), 6, 2.0);
    std::fill_n(squares.begin(), 6, 4.0);
    sums[0] = 14.0;
    squares[0] = 100.0;
    // Between: 2 (25 + 5) / 5 = 12; within: 6 * 2 / 6 = 2.
    EXPECT_NEAR(f_ratio(sums, squares, 6, 2.0), 6.0, 1e-12);
    EXPECT_EQ(f_ratio({}, {}, 12, 5.0), 0.0);
    EXPECT_NEAR(f_critical(12, 5.0), 1.9946, 1e-3);  // F(0.95; 11, 48): between 2.04 (40) and 1.95 (60) of the tables
    EXPECT_NEAR(f_critical(6, 1e6), 11.0705 / 5.0, 1e-3);  // chi-square over its degrees
}

Sectors counts(const Bins& bins) {
    return {.count = bins, .flux = bins};
}

TEST(ChiSquareRadius, TakesItsStepsAndNoOthers) {
    const auto rule = make_radius_rule({.schedule = ScheduleName::ChiSquare}, 1);
    GatherStatistics statistics{.squared_radius = 1.0};
    const auto take = [&](const Bins& bins) {
        const Sectors sectors = counts(bins);
        double found = 0.0;
        for (const double count : bins) found += count;
        rule->take(0, {.found = found, .sectors = &sectors}, statistics);
        return statistics.squared_radius;
    };
    Bins one{};
    one[1] = 9.0;
    EXPECT_EQ(take(one), 1.0);  // 9 photons are not enough for a test
    one[1] = 1.0;
    EXPECT_EQ(take(one), 0.8);  // 10 in one inner bin: neither outside nor inside even
    one[1] = 15.0;
    EXPECT_EQ(take(one), 0.8);  // the next test waits for 15.625
    one[1] = 1.0;
    EXPECT_EQ(take(one), 0.8 * 0.8);
    Bins outer{};
    for (std::size_t bin = 6; bin < 12; ++bin) outer[bin] = 10.0;
    EXPECT_EQ(take(outer), 0.8 * 0.8 * 0.5);  // even inside, since nothing is there
    EXPECT_EQ(take(all_equal(100.0)), 0.8 * 0.8 * 0.5);
    EXPECT_EQ(statistics.count, 9.0 + 1.0 + 15.0 + 1.0 + 60.0 + 1200.0);
}

TEST(FTestRadius, TakesItsStepsAndNoOthers) {
    const auto rule = make_radius_rule({.schedule = ScheduleName::FTest}, 1);
    GatherStatistics statistics{.squared_radius = 1.0};
    const auto take = [&](const Bins& bins) {
        const Sectors sectors = counts(bins);
        rule->take(0, {.sectors = &sectors}, statistics);
        return statistics.squared_radius;
    };
    Bins outer{};
    for (std::size_t bin = 6; bin < 12; ++bin) outer[bin] = 3.0;
    for (int pass = 1; pass < 5; ++pass) EXPECT_EQ(take(outer), 1.0);  // no test before the fifth
    EXPECT_EQ(take(outer), 0.5);
    for (int pass = 1; pass < 5; ++pass) EXPECT_EQ(take(all_equal(2.0)), 0.5);
    EXPECT_EQ(take(all_equal(2.0)), 0.5);
}

}  // namespace
}  // namespace photonlab
