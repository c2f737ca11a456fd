// The six deviations of deviations.h, each with its number beside that of the right update: as theory has both, and by
// the program's own photons on a scene whose answer is exact.

#include "tests/statistical/radii/deviations.h"

#include <gtest/gtest.h>

#include <random>

#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

constexpr std::uint64_t seeds = 12;

/// Values of seeds 1 to 12 after `passes`, right and deviating.
struct Shown {
    std::vector<double> right;
    std::vector<double> deviating;
};

Shown shown_after(const Deviation& deviation, std::uint64_t passes) {
    Shown shown;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed)
        run_deviation(deviation, seed, passes,
                      [&](std::uint64_t pass, const Estimates& right, const Estimates& deviating) {
                          if (pass != passes) return;
                          shown.right.push_back(deviation.value_right(right));
                          shown.deviating.push_back(deviation.value_deviating(deviating));
                      });
    return shown;
}

/// Relative variance of the mean of passes with these squared radii, in shares of the first: of pass i it is 1 over the
/// photons expected in its disc.
template <typename SquaredRadius>
double expected_squared_error(const Deviation& deviation, std::uint64_t passes, const SquaredRadius& squared_radius) {
    double sum = 0.0;
    for (std::uint64_t pass = 1; pass <= passes; ++pass) sum += 1.0 / squared_radius(static_cast<double>(pass));
    return sum / (expected_photons(deviation.radius, static_cast<double>(deviation.paths), deviation.beyond) *
                  static_cast<double>(passes * passes));
}

/// Knaus and Zwicker's squared radius of a pass, in shares of the first.
double knaus_zwicker_squared_radius(double alpha, double pass) {
    return std::exp(std::lgamma(pass + alpha) - std::lgamma(1.0 + alpha) - std::lgamma(pass + 1.0));
}

// Each pass shows rho Le in place of Le, and where every pass finds what it expects rho is (i - 1 + alpha) / i: 0.7,
// 0.912, 0.984 after 1, 10, 100 passes. With the disc's area from before it shrinks nothing is lost.
TEST(Deviations, EmissionThatShrinksWithTheFluxIsTooDark) {
    const Deviation deviation = deviation_named("emission");
    const std::vector<std::uint64_t> shown_passes{1, 10, 100};
    std::vector<std::vector<double>> shown(shown_passes.size());
    for (std::uint64_t seed = 1; seed <= seeds / 2; ++seed)
        run_deviation(deviation, seed, shown_passes.back(),
                      [&](std::uint64_t pass, const Estimates& right, const Estimates& deviating) {
                          EXPECT_NEAR(right.emission_right(), 1.0, 1e-12);
                          EXPECT_NEAR(deviating.emission_shrunk(), deviating.mean_shrink(), 1e-12);
                          for (std::size_t i = 0; i < shown_passes.size(); ++i)
                              if (pass == shown_passes[i]) shown[i].push_back(deviating.emission_shrunk());
                      });
    ClaimFamily claims;
    for (std::size_t i = 0; i < shown_passes.size(); ++i) {
        double expected = 1.0;
        for (std::uint64_t pass = 1; pass <= shown_passes[i]; ++pass)
            expected -= 0.3 / static_cast<double>(pass * shown_passes[i]);
        claims.mean_is("emission shown", shown[i], expected, 0.001, 0.002);
    }
}

// r_1 (n!)^-0.02 after n updates, where the law meant falls about as n^-0.02: 0.0165 and 0.927 of r_1 after 64.
TEST(Deviations, ARadiusThatIsDividedByAGrowingFactorFallsAsByAFactorial) {
    FactorialRadius factorial(0.96);
    const auto meant = make_radius_rule({.schedule = ScheduleName::KnausZwicker, .alpha = 0.96}, 1);
    GatherStatistics deviating{.squared_radius = 1.0};
    GatherStatistics right{.squared_radius = 1.0};
    for (std::uint64_t pass = 1; pass <= 64; ++pass) {
        factorial.take(0, {.pass = pass}, deviating);
        meant->take(0, {.pass = pass}, right);
    }
    EXPECT_NEAR(std::sqrt(deviating.squared_radius), std::exp(-0.02 * std::lgamma(65.0)), 1e-12);
    EXPECT_NEAR(std::sqrt(right.squared_radius), 0.9273, 1e-4);

    const Deviation deviation = deviation_named("factorial");
    const std::uint64_t passes = 32;
    const Shown shown = shown_after(deviation, passes);
    ClaimFamily claims;
    claims.mean_is(
        "right", shown.right,
        expected_squared_error(deviation, passes, [](double pass) { return knaus_zwicker_squared_radius(0.96, pass); }),
        0.05);
    claims.mean_is(
        "factorial", shown.deviating,
        expected_squared_error(deviation, passes, [](double pass) { return std::exp(-0.04 * std::lgamma(pass)); }),
        0.08);
}

// Squared radii that fall as i^-2 give the mean a variance that falls until pass 256 sqrt(3), and then grows with i.
TEST(Deviations, VarianceGrowsAgainWhereTheRadiusFallsAsOneOverThePass) {
    const Deviation deviation = deviation_named("reciprocal");
    const auto reciprocal = [](double pass) {
        return 1.0 / ((1.0 + (pass - 1.0) / 256.0) * (1.0 + (pass - 1.0) / 256.0));
    };
    const auto law = [](double pass) { return knaus_zwicker_squared_radius(2.0 / 3.0, pass); };
    EXPECT_NEAR(expected_squared_error(deviation, 256, reciprocal) / expected_squared_error(deviation, 1, reciprocal),
                0.0091, 1e-4);
    EXPECT_NEAR(
        expected_squared_error(deviation, 25'600, reciprocal) / expected_squared_error(deviation, 1, reciprocal), 0.134,
        1e-3);
    EXPECT_NEAR(expected_squared_error(deviation, 25'600, law) / expected_squared_error(deviation, 1, law), 7.8e-4,
                1e-5);

    const std::vector<std::uint64_t> shown_passes{443, 1600};
    std::vector<Shown> shown(shown_passes.size());
    for (std::uint64_t seed = 1; seed <= seeds; ++seed)
        run_deviation(deviation, seed, shown_passes.back(),
                      [&](std::uint64_t pass, const Estimates& right, const Estimates& deviating) {
                          for (std::size_t i = 0; i < shown_passes.size(); ++i) {
                              if (pass != shown_passes[i]) continue;
                              shown[i].right.push_back(right.squared_error());
                              shown[i].deviating.push_back(deviating.squared_error());
                          }
                      });
    ClaimFamily claims;
    for (std::size_t i = 0; i < shown_passes.size(); ++i) {
        claims.mean_is("right", shown[i].right, expected_squared_error(deviation, shown_passes[i], law), 0.05);
        claims.mean_is("reciprocal", shown[i].deviating, expected_squared_error(deviation, shown_passes[i], reciprocal),
                       0.05);
    }
    EXPECT_GT(SampleMean(shown[1].deviating).mean, 1.2 * SampleMean(shown[0].deviating).mean);
}

// k / (k - 1) too bright while discs hold k photons; k = 10.
TEST(Deviations, CountingThePhotonThatSetsTheRadiusIsTooBright) {
    const Shown shown = shown_after(deviation_named("k-th photon"), 4);
    ClaimFamily claims;
    claims.mean_is("right", shown.right, 1.0, 0.02);
    claims.mean_is("k-th counted", shown.deviating, 10.0 / 9.0, 0.02);
}

// Where the kernel vanishes at the rim the k-th photon carries nothing, counted or not.
TEST(Deviations, CountingThePhotonThatSetsTheRadiusDoesNothingUnderAKernelThatVanishesThere) {
    Deviation deviation = deviation_named("k-th photon");
    deviation.gather_deviating = [](const PointOfPass& at) {
        FluxSum sum = at.nothing();
        std::vector<std::pair<Photon, double>> found;
        at.photons.nearest(at.query(), capped_k + 1, [&](const Photon& photon, double squared_distance, double) {
            found.emplace_back(photon, squared_distance);
        });
        const double squared_radius = found.size() < capped_k ? at.squared_radius : found.back().second;
        for (const auto& [photon, squared_distance] : found)
            sum.add(photon, kernel_weight(Kernel::Epanechnikov, squared_distance / squared_radius));
        return at.estimate(sum, squared_radius);
    };
    ClaimFamily claims;
    claims.mean_is("k-th counted, Epanechnikov", shown_after(deviation, 4).deviating, 1.0, 0.02);
}

/// Mean squared radius by Hachisuka's rule, in shares of the first, where `photons` are expected in the first disc.
double expected_squared_radius(double photons, std::uint64_t passes) {
    std::mt19937_64 random(1);
    const auto rule = make_radius_rule({.alpha = 0.7}, 1);
    constexpr int points = 20'000;
    double sum = 0.0;
    for (int point = 0; point < points; ++point) {
        GatherStatistics at{.squared_radius = 1.0};
        for (std::uint64_t pass = 1; pass <= passes; ++pass)
            rule->take(0,
                       {.pass = pass,
                        .found = static_cast<double>(std::poisson_distribution<>(photons * at.squared_radius)(random))},
                       at);
        sum += at.squared_radius;
    }
    return sum / points;
}

// What is counted and brings nothing changes no radius where every pass finds photons of both sides: the rule sees
// ratios alone. Where the near side is so dark that most discs are empty, the other side's photons shrink them.
TEST(Deviations, PhotonsOfTheWrongSideShrinkDiscsThatAreDark) {
    Deviation bright = deviation_named("wrong side");
    bright.beyond = 1.0;
    bright.paths = 25'200;
    const Shown of_bright = shown_after(bright, 8);
    ClaimFamily claims;
    claims.means_agree("both sides bright", of_bright.deviating, of_bright.right, 0.01, 0.01);

    const Deviation dark = deviation_named("wrong side");
    const double near = expected_photons(dark.radius, static_cast<double>(dark.paths), dark.beyond);
    const Shown of_dark = shown_after(dark, 64);
    claims.mean_is("dark, right", of_dark.right, expected_squared_radius(near, 64), 0.02);
    claims.mean_is("dark, both counted", of_dark.deviating, expected_squared_radius(near * (1.0 + dark.beyond), 64),
                   0.02);
    EXPECT_NEAR(SampleMean(of_dark.deviating).mean / SampleMean(of_dark.right).mean, 0.38, 0.01);
}

// The mean of the cosine over light that comes from everywhere alike, by its irradiance: 2/3.
TEST(Deviations, AnExtraCosineShowsTwoThirds) {
    const Shown shown = shown_after(deviation_named("cosine"), 8);
    ClaimFamily claims;
    claims.mean_is("right", shown.right, 1.0, 0.02);
    claims.mean_is("extra cosine", shown.deviating, 2.0 / 3.0, 0.02);
}

}  // namespace
}  // namespace photonlab::test
