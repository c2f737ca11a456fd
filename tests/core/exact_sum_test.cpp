// Sums of many terms in many orders against integers of 128 bits, and what is said where a pair of doubles cannot hold
// one.

#include "core/exact_sum.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace photonlab {
namespace {

struct Pair {
    double sum = 0.0;
    double rest = 0.0;
    unsigned inexact = 0;

    void add(double x) { inexact += add_exactly(sum, rest, x) ? 0 : 1; }
    void add(const Pair& other) {
        add(other.sum);
        add(other.rest);
    }
    bool operator==(const Pair&) const = default;
};

/// Numbers of 24 bits from 2^-40 to 2^40.
std::vector<double> some_terms(std::size_t count) {
    std::mt19937_64 random(7);
    std::vector<double> terms;
    for (std::size_t i = 0; i < count; ++i) {
        const double mantissa = static_cast<double>(random() % (1u << 24));
        terms.push_back(std::ldexp(mantissa, static_cast<int>(random() % 57) - 40));
    }
    return terms;
}

TEST(ExactSum, IsTheSameInEveryOrderAndInEverySplit) {
    std::vector<double> terms = some_terms(10'000);
    Pair whole;
    for (const double term : terms) whole.add(term);
    EXPECT_EQ(whole.inexact, 0u);

    __extension__ using Wide = __int128;  // in units of 2^-40
    const auto in_units = [](double x) { return static_cast<Wide>(std::ldexp(x, 40)); };
    Wide exact = 0;
    for (const double term : terms) exact += in_units(term);
    EXPECT_TRUE(in_units(whole.sum) + in_units(whole.rest) == exact);

    std::mt19937_64 random(8);
    for (int trial = 0; trial < 20; ++trial) {
        std::shuffle(terms.begin(), terms.end(), random);
        const std::size_t cut = random() % terms.size();
        Pair first;
        Pair second;
        for (std::size_t i = 0; i < terms.size(); ++i) (i < cut ? first : second).add(terms[i]);
        second.add(first);
        EXPECT_EQ(second, whole);
    }
}

// A short cut for sums that one double holds must not show.
TEST(ExactSum, OfColoursIsThatOfTheirChannels) {
    const std::vector<double> terms = some_terms(3000);
    ColorD sum(0.0);
    ColorD rest(0.0);
    Pair channels[3];
    unsigned inexact = 0;
    for (std::size_t i = 0; i + 3 <= terms.size(); i += 3) {
        inexact += add_exactly(sum, rest, ColorD(terms[i], terms[i + 1], terms[i + 2]));
        for (std::size_t channel = 0; channel < 3; ++channel) channels[channel].add(terms[i + channel]);
    }
    inexact += add_exactly(sum, rest, ColorD(0x1p-200, 0.0, -0x1p-200));
    for (const std::size_t channel : {0, 2}) channels[channel].add(channel == 0 ? 0x1p-200 : -0x1p-200);
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_EQ((Pair{sum[channel], rest[channel], channels[channel].inexact}), channels[channel]) << channel;
    EXPECT_EQ(inexact, channels[0].inexact + channels[1].inexact + channels[2].inexact);
}

TEST(ExactSum, OfNumbersThatCancelIsExact) {
    Pair sum;
    for (const double term : {1.0, 0x1p-60, -1.0, 0x1p-80, -0x1p-60}) sum.add(term);
    EXPECT_EQ(sum, (Pair{0x1p-80, 0.0, 0}));
}

TEST(ExactSum, SaysWhereItIsNot) {
    Pair sum;
    for (const double term : {1.0, 0x1p-60, 0x1p-120}) sum.add(term);
    EXPECT_EQ(sum.inexact, 1u);
    sum.add(0.0);
    EXPECT_EQ(sum.inexact, 1u);
}

TEST(ExactSum, KeepsWhatIsNotFinite) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Pair sum;
    for (const double term : {1.0, infinity, 2.0}) sum.add(rounded_to_float_bits(term));
    EXPECT_FALSE(std::isfinite(sum.sum));
    EXPECT_EQ(sum.inexact, 0u);
    EXPECT_TRUE(std::isnan(rounded_to_float_bits(std::numeric_limits<double>::quiet_NaN())));
    EXPECT_EQ(rounded_to_float_bits(-infinity), -infinity);
}

TEST(FloatBits, AreThoseOfAFloatAtAnyScale) {
    std::mt19937_64 random(9);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    for (int i = 0; i < 10'000; ++i) {
        const double x = uniform(random);
        const double expected = static_cast<double>(static_cast<float>(x));
        EXPECT_EQ(rounded_to_float_bits(x), expected);
        EXPECT_EQ(rounded_to_float_bits(std::ldexp(x, 900)), std::ldexp(expected, 900));
        EXPECT_EQ(rounded_to_float_bits(std::ldexp(x, -900)), std::ldexp(expected, -900));
    }
    // Halves go to even.
    EXPECT_EQ(rounded_to_float_bits(1.0 + 0x1p-24), 1.0);
    EXPECT_EQ(rounded_to_float_bits(1.0 + 0x1.8p-23), 1.0 + 0x1p-22);
    EXPECT_EQ(rounded_to_float_bits(0.0), 0.0);
}

}  // namespace
}  // namespace photonlab
