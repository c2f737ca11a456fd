// Kernels against their moments, by quadrature that is exact for these polynomials.
//
// With s = d / r and K(s) = kernel_weight / pi on the unit disc, an estimate of a smooth density E at the centre has
// the expectation integral(K_r E) = E + (1/2)(E_xx + E_yy) r^2 integral(K x^2) + ..., and integral(K x^2) is half of m
// = integral(K s^2). So its bias is c r^2 laplacian(E) with c = m / 4. Its variance, for many photons, is proportional
// to integral(K^2), which is 1/pi for the constant disc. [Silverman 1986, section 4.3]

#include "gather/kernel.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

namespace photonlab {
namespace {

struct KernelConstants {
    Kernel kernel;
    double bias;               ///< c
    double relative_variance;  ///< of the constant disc's
};

constexpr std::array table{KernelConstants{Kernel::Disc, 1.0 / 8.0, 1.0},
                           KernelConstants{Kernel::Cone, 0.075, 3.0 / 2.0},
                           KernelConstants{Kernel::Epanechnikov, 1.0 / 12.0, 4.0 / 3.0},
                           KernelConstants{Kernel::Biweight, 1.0 / 16.0, 9.0 / 5.0}};

/// Integral over the unit disc of `integrand(s)`, by five-point Gauss-Legendre in s: exact while 2 pi s times the
/// integrand is a polynomial of degree 9 or less in s, which the square of every kernel here just is.
template <typename Integrand>
double integral_over_unit_disc(const Integrand& integrand) {
    const double inner = std::sqrt(5.0 - 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
    const double outer = std::sqrt(5.0 + 2.0 * std::sqrt(10.0 / 7.0)) / 3.0;
    const double inner_weight = (322.0 + 13.0 * std::sqrt(70.0)) / 900.0;
    const double outer_weight = (322.0 - 13.0 * std::sqrt(70.0)) / 900.0;
    const std::array<double, 5> nodes{-outer, -inner, 0.0, inner, outer};
    const std::array<double, 5> weights{outer_weight, inner_weight, 128.0 / 225.0, inner_weight, outer_weight};
    double sum = 0.0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const double s = 0.5 * (1.0 + nodes[i]);
        sum += 0.5 * weights[i] * 2.0 * pi * s * integrand(s);
    }
    return sum;
}

double value(Kernel kernel, double s) {
    return kernel_weight(kernel, s * s) / pi;
}

TEST(Kernel, IntegratesToOneOverItsDisc) {
    for (const KernelConstants& row : table)
        EXPECT_NEAR(integral_over_unit_disc([&](double s) { return value(row.kernel, s); }), 1.0, 1e-14)
            << name_of(row.kernel);
}

TEST(Kernel, SecondMomentGivesTheBiasConstant) {
    for (const KernelConstants& row : table)
        EXPECT_NEAR(0.25 * integral_over_unit_disc([&](double s) { return s * s * value(row.kernel, s); }), row.bias,
                    1e-14)
            << name_of(row.kernel);
}

TEST(Kernel, SquareGivesTheVarianceRelativeToTheDisc) {
    for (const KernelConstants& row : table)
        EXPECT_NEAR(pi * integral_over_unit_disc([&](double s) { return value(row.kernel, s) * value(row.kernel, s); }),
                    row.relative_variance, 1e-14)
            << name_of(row.kernel);
}

TEST(Kernel, OnlyTheDiscWeighsThePhotonAtTheRim) {
    for (const KernelConstants& row : table)
        EXPECT_EQ(kernel_weight(row.kernel, 1.0), row.kernel == Kernel::Disc ? 1.0 : 0.0) << name_of(row.kernel);
}

TEST(Kernel, NeverGrowsWithDistance) {
    for (const KernelConstants& row : table)
        for (int i = 1; i <= 100; ++i)
            EXPECT_LE(kernel_weight(row.kernel, i / 100.0), kernel_weight(row.kernel, (i - 1) / 100.0))
                << name_of(row.kernel);
}

TEST(Kernel, NamesReadBackAndUnknownOnesAreRefused) {
    for (const KernelConstants& row : table) EXPECT_EQ(parse_choice<Kernel>("kernel", name_of(row.kernel)), row.kernel);
    try {
        parse_choice<Kernel>("kernel", "gaussian");
        FAIL() << "expected an InputError";
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "unknown kernel \"gaussian\"; known here: disc, cone, epanechnikov, biweight");
    }
}

}  // namespace
}  // namespace photonlab
