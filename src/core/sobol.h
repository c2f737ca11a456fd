// Points of Sobol's sequence in six dimensions, Owen-scrambled: each is uniform by itself, and any power of two of
// them in succession is stratified in each dimension, and in all together as far as the sequence can.
//
// A point is the exclusive or of direction numbers, one for each bit of its index. Scrambling flips each binary digit
// by what the digits before it are: a hash does it in which no bit follows from higher ones, on the reversed number. It
// begins by adding a random number, so that a point is exactly uniform over seeds.
//
// [Sobol 1967; Owen 1995, "Randomly Permuted (t,m,s)-Nets and (t,s)-Sequences"; Laine & Karras 2011, "Stratified
// Sampling for Stochastic Transparency", whose hash it is; Burley 2020, "Practical Hash-based Owen Scrambling".
// Direction numbers: Joe & Kuo 2008, file new-joe-kuo-6.21201, of which six dimensions have twenty-two; no library for
// these.]

#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "core/random.h"

namespace photonlab {

class SobolSequence {
public:
    static constexpr std::size_t dimensions = 6;
    using Point = std::array<float, dimensions>;  ///< each in [0, 1), a multiple of 2^-24

    /// Scrambled by seed, purpose and `number`: another number is another sequence, independent of this one.
    SobolSequence(std::uint64_t seed, RandomPurpose purpose, std::uint64_t number);

    Point operator[](std::uint32_t index) const {
        std::array<std::uint32_t, dimensions> digits{};
        for (std::uint32_t bits = index; bits != 0; bits &= bits - 1) {
            const auto& numbers = directions[static_cast<std::size_t>(std::countr_zero(bits))];
            for (std::size_t i = 0; i < dimensions; ++i) digits[i] ^= numbers[i];
        }
        Point point;
        for (std::size_t i = 0; i < dimensions; ++i)
            point[i] = static_cast<float>(scrambled(digits[i], seeds_[i]) >> 8) * 0x1p-24f;
        return point;
    }

private:
    static constexpr std::uint32_t reversed(std::uint32_t x) {
        x = (x >> 1 & 0x5555'5555u) | (x & 0x5555'5555u) << 1;
        x = (x >> 2 & 0x3333'3333u) | (x & 0x3333'3333u) << 2;
        x = (x >> 4 & 0x0f0f'0f0fu) | (x & 0x0f0f'0f0fu) << 4;
        return __builtin_bswap32(x);
    }

    /// [Laine & Karras 2011, with the constants of Burley 2020, listing 2]
    static constexpr std::uint32_t scrambled(std::uint32_t digits, std::uint32_t seed) {
        std::uint32_t x = reversed(digits) + seed;
        x ^= x * 0x6c50'b47cu;
        x ^= x * 0xb82f'1e52u;
        x ^= x * 0xc7af'e638u;
        x ^= x * 0x8d22'f6e6u;
        return reversed(x);
    }

    using DirectionNumbers = std::array<std::array<std::uint32_t, dimensions>, 32>;  // by bit, then by dimension
    static constexpr DirectionNumbers make_directions();
    static const DirectionNumbers directions;

    std::array<std::uint32_t, dimensions> seeds_;
};

/// m_k by the recurrence of a primitive polynomial over two elements, of degree s and with coefficients a.
/// [Joe & Kuo 2008, equations 2 and 3]
constexpr SobolSequence::DirectionNumbers SobolSequence::make_directions() {
    struct Line {
        std::uint32_t s;
        std::uint32_t a;
        std::array<std::uint32_t, 4> m;
    };
    constexpr std::array<Line, dimensions - 1> lines{
        {{1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}, {3, 2, {1, 1, 1}}, {4, 1, {1, 1, 3, 3}}}};
    DirectionNumbers made{};
    for (std::uint32_t k = 0; k < 32; ++k) made[k][0] = 0x8000'0000u >> k;
    for (std::size_t dimension = 1; dimension < dimensions; ++dimension) {
        const Line& line = lines[dimension - 1];
        for (std::uint32_t k = 0; k < 32; ++k) {
            if (k < line.s) {
                made[k][dimension] = line.m[k] << (31 - k);
                continue;
            }
            const std::uint32_t before = made[k - line.s][dimension];
            std::uint32_t number = before ^ (before >> line.s);
            for (std::uint32_t i = 1; i < line.s; ++i)
                if (line.a >> (line.s - 1 - i) & 1u) number ^= made[k - i][dimension];
            made[k][dimension] = number;
        }
    }
    return made;
}

inline constexpr SobolSequence::DirectionNumbers SobolSequence::directions = SobolSequence::make_directions();

inline SobolSequence::SobolSequence(std::uint64_t seed, RandomPurpose purpose, std::uint64_t number) {
    RandomStream random(seed, RandomPurpose::LightSequence, number, static_cast<std::uint64_t>(purpose));
    for (std::uint32_t& one : seeds_) one = random.next_bits();
}

}  // namespace photonlab
