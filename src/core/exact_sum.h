// Sums that come out the same in whatever order and groups they are added: doubles in pairs, whose sum is exact.
//
// What is added is first rounded to the 24 bits of a float. A pair of doubles holds 106 bits, so no bit is lost as long
// as the smallest term is above 2^-80 or so of the sum; where one is, the addition says so. The pair is kept with
// its first double nearest to the sum, so that equal sums have equal bits.
//
// [Knuth 1969, "The Art of Computer Programming", volume 2, theorem 4.2.2B; Dekker 1971, "A Floating-Point Technique
// for Extending the Available Precision"]

#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/math.h"

namespace photonlab {

/// To the nearest number with the 24 bits of a float and the range of a double. Infinity and NaN stay.
inline double rounded_to_float_bits(double x) {
    const auto bits = std::bit_cast<std::uint64_t>(x);
    const std::uint64_t is_odd = bits >> 29 & 1u;  // of the last bit that stays: halves go to even
    return std::bit_cast<double>((bits + 0x0fff'ffffu + is_odd) & ~std::uint64_t{0x1fff'ffffu});
}

/// a + b is exactly sum + rest, where nothing overflows.
struct TwoSum {
    double sum;
    double rest;
};
inline TwoSum two_sum(double a, double b) {
    const double sum = a + b;
    const double b_in_sum = sum - a;
    return {sum, (a - (sum - b_in_sum)) + (b - b_in_sum)};
}

/// Adds x to the number that `sum` and `rest` make together; false when it was not exact. What is not finite stays so,
/// and counts as exact.
inline bool add_exactly(double& sum, double& rest, double x) {
    const TwoSum first = two_sum(sum, x);
    const TwoSum second = two_sum(rest, first.rest);
    const TwoSum pair = two_sum(first.sum, second.sum);
    sum = pair.sum;
    rest = pair.rest;
    return !(second.rest < 0.0 || second.rest > 0.0);
}

/// The same in each channel; how many of them were not exact.
inline unsigned add_exactly(ColorD& sum, ColorD& rest, const ColorD& x) {
    const TwoSum r = two_sum(sum.x, x.x);
    const TwoSum g = two_sum(sum.y, x.y);
    const TwoSum b = two_sum(sum.z, x.z);
    // As long as one double holds the sum, which is so for most, there is nothing more to do.
    const bool fits = (std::abs(r.rest) + std::abs(g.rest) + std::abs(b.rest)) +
                          (std::abs(rest.x) + std::abs(rest.y) + std::abs(rest.z)) ==
                      0.0;
    if (fits) {
        sum = {r.sum, g.sum, b.sum};
        return 0;
    }
    unsigned inexact = 0;
    for (int channel = 0; channel < 3; ++channel)
        inexact += add_exactly(sum[channel], rest[channel], x[channel]) ? 0u : 1u;
    return inexact;
}

inline ColorD rounded_to_float_bits(const ColorD& color) {
    return {rounded_to_float_bits(color.x), rounded_to_float_bits(color.y), rounded_to_float_bits(color.z)};
}

}  // namespace photonlab
