// Sobol's points: the digits of the first ones as they are published, what stratification promises of many, and that
// scrambling leaves each uniform and different sequences independent.

#include "core/sobol.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

namespace photonlab {
namespace {

constexpr RandomPurpose purpose = RandomPurpose::Test;

/// In how many of `cells` cells a side, in two dimensions, the points from `first` to `first + count` lie: each once?
bool each_cell_has_one(const SobolSequence& sequence, std::uint32_t first, std::uint32_t count, std::size_t a,
                       std::size_t b, std::uint32_t columns) {
    std::set<std::pair<int, int>> cells;
    const std::uint32_t rows = count / columns;
    for (std::uint32_t i = first; i < first + count; ++i) {
        const SobolSequence::Point point = sequence[i];
        cells.emplace(static_cast<int>(point[a] * static_cast<float>(columns)),
                      static_cast<int>(point[b] * static_cast<float>(rows)));
    }
    return cells.size() == count;
}

TEST(Sobol, PointsFillTheStrataOfEachDimension) {
    const SobolSequence sequence(1, purpose, 0);
    for (const std::uint32_t count : {2u, 16u, 1024u, 65536u})
        for (const std::uint32_t first : {0u, count, 5 * count})
            for (std::size_t dimension = 0; dimension < SobolSequence::dimensions; ++dimension) {
                std::vector<int> hit(count, 0);
                for (std::uint32_t i = first; i < first + count; ++i)
                    ++hit[static_cast<std::size_t>(sequence[i][dimension] * static_cast<float>(count))];
                EXPECT_TRUE(std::all_of(hit.begin(), hit.end(), [](int times) { return times == 1; }))
                    << count << " from " << first << " in dimension " << dimension;
            }
}

// The first two dimensions are a (0, 2)-sequence: whatever the shape of the cells. The quality of the others with these
// direction numbers is t = 1 for the third and fourth, so that every four of 4 x 4 have two.
TEST(Sobol, PointsFillTheCellsOfTheFirstTwoDimensions) {
    const SobolSequence sequence(7, purpose, 3);
    for (const std::uint32_t first : {0u, 256u, 1024u})
        for (std::uint32_t columns = 1; columns <= 256; columns *= 2)
            EXPECT_TRUE(each_cell_has_one(sequence, first, 256, 0, 1, columns)) << columns << " from " << first;
}

/// Mean squared error of the mean of a smooth function of all numbers of a point, over sequences.
double squared_error(std::uint32_t count) {
    constexpr int sequences = 100;
    double sum = 0.0;
    for (int number = 0; number < sequences; ++number) {
        const SobolSequence sequence(5, purpose, static_cast<std::uint64_t>(number));
        double mean = 0.0;
        for (std::uint32_t i = 0; i < count; ++i) {
            double product = 1.0;
            for (const float x : sequence[i]) product *= 0.5 + static_cast<double>(x);
            mean += product / count;
        }
        sum += (mean - 1.0) * (mean - 1.0) / sequences;
    }
    return sum;
}

// Scrambled nets integrate smooth functions with an error far below that of independent points, which here is
// ((13 / 12)^6 - 1) / n. [Owen 1997, "Scrambled net variance for integrals of smooth functions"]
TEST(Sobol, SmoothFunctionsOfAllNumbersAreIntegratedWell) {
    const double independent = (std::pow(13.0 / 12.0, 6.0) - 1.0) / 4096.0;
    EXPECT_LT(squared_error(4096), 1e-3 * independent);
    EXPECT_LT(squared_error(4096), squared_error(256) / 16.0 / 8.0);
}

TEST(Sobol, EachPointIsUniformOverSequences) {
    constexpr int sequences = 20'000;
    for (const std::uint32_t index : {0u, 1u, 12345u}) {
        std::array<std::array<int, 16>, SobolSequence::dimensions> bins{};
        std::array<int, 256> pairs{};
        for (int number = 0; number < sequences; ++number) {
            const auto point = SobolSequence(11, purpose, static_cast<std::uint64_t>(number))[index];
            for (std::size_t i = 0; i < point.size(); ++i) ++bins[i][static_cast<std::size_t>(point[i] * 16.0f)];
            ++pairs[static_cast<std::size_t>(point[0] * 16.0f) * 16 + static_cast<std::size_t>(point[2] * 16.0f)];
        }
        const auto chi_square = [&](const auto& counts) {
            const double expected = static_cast<double>(sequences) / static_cast<double>(counts.size());
            double sum = 0.0;
            for (const int count : counts) sum += (count - expected) * (count - expected) / expected;
            return sum;
        };
        for (const auto& counts : bins) EXPECT_LT(chi_square(counts), 50.5);  // 1e-5 of 15 degrees
        EXPECT_LT(chi_square(pairs), 355.0);                                  // 2e-5 of 255 degrees
    }
}

TEST(Sobol, SeedPurposeAndNumberEachMakeAnotherSequence) {
    const auto first = SobolSequence(1, purpose, 0)[9];
    EXPECT_EQ(SobolSequence(1, purpose, 0)[9], first);
    EXPECT_NE(SobolSequence(2, purpose, 0)[9], first);
    EXPECT_NE(SobolSequence(1, RandomPurpose::PhotonPaths, 0)[9], first);
    EXPECT_NE(SobolSequence(1, purpose, 1)[9], first);
}

}  // namespace
}  // namespace photonlab
