// Whether samples follow a density: the domain is cut into cells, and counts are compared with the density's integral
// over each. [Pearson 1900; as in Nori and Mitsuba]

#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <vector>

namespace photonlab {

/// Upper tail of the chi-square distribution, by Wilson and Hilferty's normal approximation (good to 1e-4 from 30
/// degrees on).
inline double chi_square_tail(double statistic, double degrees) {
    const double spread = 2.0 / (9.0 * degrees);
    const double z = (std::cbrt(statistic / degrees) - (1.0 - spread)) / std::sqrt(spread);
    return 0.5 * std::erfc(z / std::sqrt(2.0));
}

/// Integral of `density` over [x0, x1] x [y0, y1] by the midpoint rule, steps x steps.
inline double cell_integral(const std::function<double(double, double)>& density, double x0, double x1, double y0,
                            double y1, int steps) {
    double sum = 0.0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j)
            sum += density(x0 + (x1 - x0) * (i + 0.5) / steps, y0 + (y1 - y0) * (j + 0.5) / steps);
    return sum * (x1 - x0) * (y1 - y0) / (static_cast<double>(steps) * steps);
}

/// Expects that `samples` of `draw` (each in [x_min, x_max] x [y_min, y_max]) follow `density`, which integrates to one
/// there. Fails by chance with probability 1e-4 (the seed is fixed, so it fails always or never). A density with steps
/// or narrow peaks needs more `steps` a cell.
inline void expect_distributed(const std::function<std::pair<double, double>()>& draw,
                               const std::function<double(double, double)>& density, double x_min, double x_max,
                               double y_min, double y_max, int samples = 200'000, int steps = 16) {
    constexpr int cells = 12;
    std::vector<double> counts(cells * cells, 0.0);
    for (int i = 0; i < samples; ++i) {
        const auto [x, y] = draw();
        ASSERT_TRUE(x >= x_min && x <= x_max && y >= y_min && y <= y_max) << x << " " << y;
        const int column = std::min(cells - 1, static_cast<int>((x - x_min) / (x_max - x_min) * cells));
        const int row = std::min(cells - 1, static_cast<int>((y - y_min) / (y_max - y_min) * cells));
        ++counts[static_cast<std::size_t>(row * cells + column)];
    }
    double statistic = 0.0;
    double total = 0.0;
    double pooled_count = 0.0;
    double pooled_expected = 0.0;
    int used = 0;
    for (int row = 0; row < cells; ++row)
        for (int column = 0; column < cells; ++column) {
            const double width = (x_max - x_min) / cells;
            const double height = (y_max - y_min) / cells;
            const double share = cell_integral(density, x_min + column * width, x_min + (column + 1) * width,
                                               y_min + row * height, y_min + (row + 1) * height, steps);
            total += share;
            const double expected = share * samples;
            const double count = counts[static_cast<std::size_t>(row * cells + column)];
            if (expected < 10.0) {  // too few for the chi-square approximation: together
                pooled_count += count;
                pooled_expected += expected;
                continue;
            }
            statistic += (count - expected) * (count - expected) / expected;
            ++used;
        }
    if (pooled_expected > 10.0) {
        statistic += (pooled_count - pooled_expected) * (pooled_count - pooled_expected) / pooled_expected;
        ++used;
    } else {
        EXPECT_LE(pooled_count, 10.0 + 5.0 * std::sqrt(10.0));
    }
    EXPECT_NEAR(total, 1.0, 0.01) << "the density does not integrate to one";
    EXPECT_GT(chi_square_tail(statistic, used - 1), 1e-4)
        << "chi-square " << statistic << " with " << used - 1 << " degrees";
}

}  // namespace photonlab
