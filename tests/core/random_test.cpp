// The random streams against published numbers, and against each other: a stream is named by seed, purpose, pass and
// index, and no two names may share numbers.
//
// The chi-square fails by chance with probability 1e-4; its seed is fixed.

#include "core/random.h"

#include <gtest/gtest.h>

#include <set>

#include "tests/support/chi_square.h"
#include "tests/support/test_stream.h"

namespace photonlab {
namespace {

TEST(RandomStream, IsPhilox4x32With10Rounds) {
    // The answers that Random123 publishes (kat_vectors): counter and key of zeros, of ones, and of digits of pi.
    using Counter = r123::Philox4x32::ctr_type;
    const std::uint32_t ones = 0xffffffffu;
    EXPECT_EQ(r123::Philox4x32()({{0, 0, 0, 0}}, {{0, 0}}),
              (Counter{{0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u}}));
    EXPECT_EQ(r123::Philox4x32()({{ones, ones, ones, ones}}, {{ones, ones}}),
              (Counter{{0x408f276du, 0x41c83b0eu, 0xa20bc7c6u, 0x6d5451fdu}}));
    EXPECT_EQ(r123::Philox4x32()({{0x243f6a88u, 0x85a308d3u, 0x13198a2eu, 0x03707344u}}, {{0xa4093822u, 0x299f31d0u}}),
              (Counter{{0xd16cfe09u, 0x94fdccebu, 0x5001e420u, 0x24126ea1u}}));
}

TEST(RandomStream, HandsOutTheBlocksOfItsCounterInOrder) {
    const std::uint64_t seed = 0x0123456789abcdefu;
    const std::uint64_t index = 0x0011223344556677u;
    RandomStream random(seed, RandomPurpose::Test, 9, index);
    for (std::uint32_t block = 0; block < 3; ++block) {
        const auto expected = r123::Philox4x32()({{block, 0x44556677u, 9u, 0x06112233u}}, {{0x89abcdefu, 0x01234567u}});
        for (std::size_t word = 0; word < 4; ++word) EXPECT_EQ(random.next_bits(), expected[word]);
    }
}

TEST(RandomStream, DependsOnEveryPartOfItsName) {
    const std::uint64_t high = std::uint64_t{1} << 32;
    std::set<std::uint64_t> first_numbers;
    std::size_t names = 0;
    for (const std::uint64_t seed : {std::uint64_t{0}, std::uint64_t{1}, high})
        for (const auto purpose : {RandomPurpose::PhotonPaths, RandomPurpose::DirectLight, RandomPurpose::CameraPaths,
                                   RandomPurpose::ReferenceHalfA, RandomPurpose::ReferenceHalfB, RandomPurpose::Test})
            for (const std::uint64_t pass : {0u, 1u, 2u, 0xffffffffu})
                for (const std::uint64_t index :
                     {std::uint64_t{0}, std::uint64_t{1}, high, high + 1, (high << 24) - 1}) {
                    RandomStream random(seed, purpose, pass, index);
                    const std::uint64_t bits = random.next_bits();
                    first_numbers.insert(bits << 32 | random.next_bits());
                    ++names;
                }
    EXPECT_EQ(first_numbers.size(), names);
}

TEST(RandomStream, RepeatsItself) {
    RandomStream first = test_stream(5);
    RandomStream second = test_stream(5);
    for (int i = 0; i < 100; ++i) ASSERT_EQ(first.next_bits(), second.next_bits());
}

TEST(RandomStreams, HandOutWhatEachStreamAloneDoes) {
    const std::uint64_t seed = 0x0123456789abcdefu;
    const std::uint64_t high = std::uint64_t{1} << 32;
    RandomStreams streams(seed, RandomPurpose::Test, 9);
    // Neighbours, jumps back and forth, both sides of where 64 end and where an index takes more than 32 bits.
    for (const std::uint64_t index :
         {std::uint64_t{0}, std::uint64_t{1}, std::uint64_t{63}, std::uint64_t{64}, std::uint64_t{1000},
          std::uint64_t{2}, high - 1, high, high + 1, (high << 24) - 1}) {
        RandomStream together = streams[index];
        RandomStream alone(seed, RandomPurpose::Test, 9, index);
        for (int i = 0; i < 50; ++i) ASSERT_EQ(together.next_bits(), alone.next_bits()) << index << ", number " << i;
    }
}

TEST(RandomStream, StaysBelowOne) {
    RandomStream random = test_stream();
    for (int i = 0; i < 1'000'000; ++i) {
        const float x = random.next();
        ASSERT_TRUE(x >= 0.0f && x < 1.0f);
        const double y = random.next_double();
        ASSERT_TRUE(y >= 0.0 && y < 1.0);
    }
}

TEST(RandomStream, NeighbouringStreamsAreUniformAndIndependent) {
    expect_distributed(
        [index = std::uint64_t{0}]() mutable {
            const double x = test_stream(index).next();
            return std::pair<double, double>(x, test_stream(++index).next_double());
        },
        [](double, double) { return 1.0; }, 0.0, 1.0, 0.0, 1.0);
}

}  // namespace
}  // namespace photonlab
