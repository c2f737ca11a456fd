// The curvature kernel against its moments, and the radius that follows from given statistics.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "gather/radii/adaptive_radius.h"

namespace photonlab {
namespace {

/// Integral over the disc of radius `bandwidth` of D_h times a function of the place, by the midpoint rule in rings.
double integral_of_kernel(double bandwidth, const std::function<double(double, double)>& function) {
    constexpr int rings = 4000;
    constexpr int angles = 64;
    double sum = 0.0;
    for (int ring = 0; ring < rings; ++ring) {
        const double s = bandwidth * (ring + 0.5) / rings;
        double around = 0.0;
        for (int step = 0; step < angles; ++step) {
            const double angle = 2.0 * pi * (step + 0.5) / angles;
            around += function(s * std::cos(angle), s * std::sin(angle)) / angles;
        }
        sum += curvature_kernel(s * s, bandwidth * bandwidth) * around * 2.0 * pi * s * bandwidth / rings;
    }
    return sum;
}

TEST(CurvatureKernel, IsTheLaplacianOfAnyQuadratic) {
    for (const double h : {0.1, 0.7, 3.0}) {
        EXPECT_NEAR(integral_of_kernel(h, [](double, double) { return 1.0; }), 0.0, 1e-5 / (h * h));
        EXPECT_NEAR(integral_of_kernel(h, [](double x, double y) { return 2.0 * x - y; }), 0.0, 1e-9);
        EXPECT_NEAR(integral_of_kernel(
                        h, [](double x, double y) { return 3.0 + 2.0 * x - y + 5.0 * x * x - 2.0 * y * y + x * y; }),
                    6.0, 1e-5 * (1.0 + 3.0 / (h * h)));
    }
}

TEST(CurvatureKernel, HasTheVarianceThatIsPredicted) {
    const double h = 0.7;
    const double squared =
        integral_of_kernel(h, [&](double x, double y) { return curvature_kernel(x * x + y * y, h * h); });
    EXPECT_NEAR(squared, 192.0 / (pi * std::pow(h, 6.0)), 1e-4 * squared);
}

// Point light of intensity I at height H above the foot: the kernel sees -48 I / (H^4 q (q + 1)^3), q = sqrt(1 + h^2 /
// H^2); the Laplacian itself is -6 I / H^4.
TEST(CurvatureKernel, BelowAPointLightSeesWhatIsPredicted) {
    for (const double height : {1.0, 2.0})
        for (const double h : {0.2, 0.5, 1.0}) {
            const double q = std::sqrt(1.0 + h * h / (height * height));
            const double expected = -48.0 / (std::pow(height, 4.0) * q * std::pow(q + 1.0, 3.0));
            const double seen = integral_of_kernel(
                h, [&](double x, double y) { return height / std::pow(height * height + x * x + y * y, 1.5); });
            EXPECT_NEAR(seen, expected, 2e-5 / (h * h));
        }
}

TEST(Sectors, AreTwelveBinsOfEqualArea) {
    Sectors sectors;
    constexpr int steps = 1200;
    int inside = 0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double x = (i + 0.5) * 2.0 / steps - 1.0;
            const double y = (j + 0.5) * 2.0 / steps - 1.0;
            if (x * x + y * y >= 1.0) continue;
            ++inside;
            const std::size_t bin = sector_of(x, y, x * x + y * y);
            ASSERT_LT(bin, sector_count);
            sectors.count[bin] += 1.0;
            const double angle = std::atan2(y, x) < 0.0 ? std::atan2(y, x) + 2.0 * pi : std::atan2(y, x);
            EXPECT_EQ(bin % sectors_per_ring, static_cast<std::size_t>(angle / (pi / 3.0))) << x << ' ' << y;
            EXPECT_EQ(bin / sectors_per_ring, x * x + y * y < 0.5 ? 0u : 1u);
        }
    for (const double count : sectors.count) EXPECT_NEAR(count, inside / 12.0, 0.002 * inside);
}

// V1 = 6 c^2 Delta^2 r^6 i by construction.
TEST(AdaptiveRadius, OfGivenStatisticsIsANumber) {
    const CurvatureStatistics statistics{.variance = 2e-4, .laplacian = ColorD(-3.0, 0.0, 4.0)};
    const RadiusRuleSettings settings{.smallest_radius = 1e-3, .largest_radius = 1e3};
    for (const std::uint64_t passes : {1, 7, 4095}) {
        const double squared = adaptive_squared_radius(statistics, settings, 1.0, passes);
        const double i = static_cast<double>(passes + 1);
        EXPECT_NEAR(6.0 / 64.0 * 25.0 * std::pow(squared, 3.0) * i, 2e-4, 1e-15);
    }
    const RadiusRuleSettings epanechnikov{
        .kernel = Kernel::Epanechnikov, .kappa = 2.0, .smallest_radius = 1e-3, .largest_radius = 1e3};
    EXPECT_NEAR(2.0 / 144.0 * 25.0 * std::pow(adaptive_squared_radius(statistics, epanechnikov, 1.0, 1), 3.0) * 2.0,
                2e-4, 1e-15);
}

TEST(AdaptiveRadius, StaysWithinItsClamps) {
    const RadiusRuleSettings settings;
    const double initial = 0.09;
    const double fall = std::cbrt(1.0 / 8.0);
    EXPECT_NEAR(adaptive_squared_radius({.variance = 1.0, .laplacian = ColorD(1e9)}, settings, initial, 7),
                initial / 64.0 * fall, 1e-16);
    EXPECT_NEAR(adaptive_squared_radius({.variance = 1.0, .laplacian = ColorD(1e-9)}, settings, initial, 7),
                initial * 4.0 * fall, 1e-15);
    EXPECT_NEAR(adaptive_squared_radius({.variance = 1.0, .laplacian = ColorD(0.0)}, settings, initial, 7),
                initial * 4.0 * fall, 1e-15);
    // Nothing known yet.
    EXPECT_NEAR(adaptive_squared_radius({}, settings, initial, 7), initial * fall, 1e-16);
}

TEST(AdaptiveRadius, DoesNotDependOnTheUnitOfLight) {
    const RadiusRuleSettings settings{.smallest_radius = 1e-3, .largest_radius = 1e3};
    const CurvatureStatistics statistics{.variance = 2e-4, .laplacian = ColorD(-3.0, 1.0, 4.0)};
    const double squared = adaptive_squared_radius(statistics, settings, 0.3, 5);
    for (const int power : {-300, -100, 30, 200}) {
        const double light = std::ldexp(1.0, power);
        const CurvatureStatistics scaled{.variance = statistics.variance * light * light,
                                         .laplacian = statistics.laplacian * light};
        EXPECT_EQ(adaptive_squared_radius(scaled, settings, 0.3, 5), squared) << power;
    }
}

TEST(KernelConstants, AreAQuarterOfTheMeanSquaredDistance) {
    for (const auto& [kernel, name] : kernel_names) {
        constexpr int steps = 200'000;
        double sum = 0.0;
        for (int i = 0; i < steps; ++i) {
            const double s = (i + 0.5) / steps;
            sum += kernel_weight(kernel, s * s) * s * s * 2.0 * s / steps;
        }
        EXPECT_NEAR(bias_constant(kernel), sum / 4.0, 1e-9) << name;
    }
}

}  // namespace
}  // namespace photonlab
