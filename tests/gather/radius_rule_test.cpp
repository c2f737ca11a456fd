// Radius schedules against their closed forms, and the running mean of the passes' own estimates against the textbook
// update of Hachisuka et al. 2008, to which it is equal (docs/theory.md, section 1).

#include "gather/radii/radius_rule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "core/random.h"

namespace photonlab {
namespace {

constexpr std::array alphas{0.3, 0.5, 2.0 / 3.0, 0.7, 1.0};

TEST(KnausZwickerShrink, ProductMatchesTheClosedFormOverAMillionPasses) {
    for (const double alpha : alphas) {
        // Long double: at a million, lgamma is of the order of 1e7, and in double its rounding alone would exceed 1e-9.
        const long double a = alpha;
        double squared_radius = 1.0;
        for (std::uint64_t pass = 1; pass <= 1'000'000; ++pass) {
            if (pass <= 10 || pass % 99'991 == 0 || pass == 1'000'000) {
                const long double i = static_cast<long double>(pass);
                const long double closed_form =
                    std::exp(std::lgamma(i + a) - std::lgamma(1.0L + a) - std::lgamma(i + 1.0L));
                ASSERT_NEAR(squared_radius / static_cast<double>(closed_form), 1.0, 1e-9)
                    << "alpha " << alpha << ", pass " << pass;
            }
            squared_radius *= knaus_zwicker_shrink(alpha, pass);
        }
    }
}

TEST(KnausZwickerShrink, NeverShrinksWhenAlphaIsOne) {
    for (const std::uint64_t pass : {1ull, 2ull, 3ull, 1000ull, 1ull << 40})
        EXPECT_EQ(knaus_zwicker_shrink(1.0, pass), 1.0);
}

TEST(HachisukaShrink, LeavesTheRadiusWhereNothingWasEverFound) {
    for (const double alpha : alphas) EXPECT_EQ(hachisuka_shrink(alpha, 0.0, 0.0), 1.0);
}

TEST(HachisukaShrink, LeavesTheRadiusWhenAPassFindsNothing) {
    for (const double alpha : alphas) EXPECT_EQ(hachisuka_shrink(alpha, 12.5, 0.0), 1.0);
}

TEST(HachisukaShrink, NeverShrinksWhenAlphaIsOne) {
    for (const double count : {0.0, 0.7, 1e3, 1e15})
        for (const double found : {1.0, 3.0, 1e6}) EXPECT_EQ(hachisuka_shrink(1.0, count, found), 1.0);
}

TEST(HachisukaShrink, IsAlphaAtTheFirstPhotons) {
    for (const double alpha : alphas)
        for (const double found : {1.0, 7.0, 1e6}) EXPECT_NEAR(hachisuka_shrink(alpha, 0.0, found), alpha, 1e-15);
}

TEST(HachisukaShrink, KeepsTheDensityOfTheKeptPhotons) {
    // N + alpha M photons in the shrunken disc are as dense as N + M in the old one.
    EXPECT_DOUBLE_EQ(hachisuka_shrink(0.7, 10.0, 5.0), 13.5 / 15.0);
}

// Where every disc finds exactly what a uniform density puts into it, Hachisuka's squared radius in pass i is alpha
// times Knaus and Zwicker's in pass i - 1: the first pass, with no photons kept yet, shrinks by alpha alone.
TEST(HachisukaShrink, IsAlphaTimesKnausZwickerOnePassEarlierForManyPhotons) {
    constexpr double photons_in_the_first_disc = 1e6;
    for (const double alpha : alphas) {
        double squared_radius = 1.0;
        double count = 0.0;
        double knaus_zwicker_before = 1.0;
        for (std::uint64_t pass = 1; pass <= 10'000; ++pass) {
            if (pass >= 2) {
                ASSERT_NEAR(squared_radius / (alpha * knaus_zwicker_before), 1.0, 1e-11)
                    << "alpha " << alpha << ", pass " << pass;
                knaus_zwicker_before *= knaus_zwicker_shrink(alpha, pass - 1);
            }
            const double found = photons_in_the_first_disc * squared_radius;
            squared_radius *= hachisuka_shrink(alpha, count, found);
            count += alpha * found;
        }
    }
}

TEST(RunningMean, EqualsTheTextbookUpdateOverTenThousandRandomPasses) {
    constexpr double paths_per_pass = 1000.0;
    constexpr double initial_squared_radius = 0.0625;
    for (const double alpha : {0.3, 0.5, 0.7, 1.0}) {
        RandomStream random(11, RandomPurpose::Test, 0, static_cast<std::uint64_t>(alpha * 10.0));
        double squared_radius = initial_squared_radius;
        double count = 0.0;
        double accumulated_flux = 0.0;  // the textbook's tau, shrunk with the disc
        double estimate = 0.0;          // the running mean
        std::uint64_t empty_passes = 0;
        for (int pass = 1; pass <= 10'000; ++pass) {
            // A third of the passes are empty, and so are the first ones, where N + M = 0.
            const double found =
                pass <= 3 || random.next() < 1.0f / 3.0f ? 0.0 : std::floor(1.0 + 20.0 * random.next_double());
            if (found == 0.0) ++empty_passes;
            double flux = 0.0;
            for (int photon = 0; photon < static_cast<int>(found); ++photon) flux += random.next_double();

            estimate = estimate * (pass - 1) / pass + flux / (pass * paths_per_pass * pi * squared_radius);

            const double shrink = hachisuka_shrink(alpha, count, found);
            squared_radius *= shrink;
            accumulated_flux = (accumulated_flux + flux) * shrink;
            count += alpha * found;
            const double textbook = accumulated_flux / (pi * squared_radius * paths_per_pass * pass);
            ASSERT_NEAR(estimate, textbook, 1e-11 * textbook) << "alpha " << alpha << ", pass " << pass;
        }
        EXPECT_GT(empty_passes, 3000u);
        EXPECT_GT(estimate, 0.0);
    }
}

TEST(ScheduleName, ReadsBackAndRefusesUnknownOnes) {
    EXPECT_EQ(parse_choice<ScheduleName>("schedule", "hachisuka"), ScheduleName::Hachisuka);
    EXPECT_EQ(parse_choice<ScheduleName>("schedule", "knaus-zwicker"), ScheduleName::KnausZwicker);
    EXPECT_THROW(parse_choice<ScheduleName>("schedule", "Hachisuka"), InputError);
}

}  // namespace
}  // namespace photonlab
