// What a map is whatever it is asked: what it holds, that it cannot be broken by what FLANN itself does not survive,
// and that its answers depend neither on the order of photons nor on threads.

#include "gather/map/photon_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "tests/gather/photon_sets.h"

namespace photonlab {
namespace {

TEST(PhotonMap, AnswersNothingWithoutPhotons) {
    const PhotonMap map({});
    EXPECT_EQ(map.size(), 0u);
    EXPECT_EQ(map.bytes(), 0u);
    EXPECT_EQ(count_within(map, Vector(0.0f), up, 10.0), 0u);
    const NearestPhotons answer = map.nearest(Vector(0.0f), up, 10, 0.5, [](const Photon&, double, double) { FAIL(); });
    EXPECT_EQ(answer.found, 0u);
    EXPECT_EQ(answer.squared_radius, 0.25);
}

// Threads that wait at the end of a loop take pieces of the sorting that one of them began in it.
TEST(PhotonMap, HasTheSameOrderWhoeverTakesPartInSorting) {
    const std::vector<Photon> photons = photon_set("many", 100'000, [](RandomStream& random, std::size_t) {
                                            return random_point(random, 1.0f);
                                        }).photons;
    const PhotonMap alone(photons);
    PhotonMap shared({});
    parallel_for(4, 4, [&](std::size_t item) {
        if (item == 0) shared = PhotonMap(photons);
    });
    ASSERT_EQ(shared.size(), photons.size());
    for (std::size_t i = 0; i < photons.size(); ++i)
        ASSERT_EQ(std::memcmp(&shared.photons()[i], &alone.photons()[i], sizeof(Photon)), 0) << i;
}

TEST(PhotonMap, RefusesNonFinitePositionsAndLosesNoOtherPhoton) {
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::vector<Photon> photons = photon_set("finite", 10'000, [](RandomStream& random, std::size_t) {
                                      return random_point(random, 1.0f);
                                  }).photons;
    const std::vector<Photon> finite = photons;
    const std::vector<Vector> refused{Vector(nan, 0.0f, 0.0f),       Vector(0.0f, nan, 0.0f),
                                      Vector(0.1f, 0.1f, nan),       Vector(infinity, 0, 0),
                                      Vector(0.0f, -infinity, 0.0f), Vector(0.0f, 0.0f, 3e38f)};
    for (std::size_t i = 0; i < refused.size(); ++i)
        photons.insert(photons.begin() + static_cast<std::ptrdiff_t>(i * 1500), photon_at(refused[i], 20'000 + i));
    const PhotonMap map(photons);
    EXPECT_EQ(map.nonfinite(), refused.size());
    EXPECT_EQ(map.size(), finite.size());
    RandomStream random(6, RandomPurpose::Test, 0, 0);
    for (int query = 0; query < 100; ++query) {
        const Vector position = random_point(random, 1.0f);
        ASSERT_EQ(numbers_within(map, position, up, 0.2), numbers_by_brute_force(finite, position, up, 0.2));
    }
}

TEST(PhotonMap, HoldsNothingWhenEveryPhotonIsRefused) {
    const PhotonMap map({photon_at(Vector(std::numeric_limits<float>::quiet_NaN()), 0)});
    EXPECT_EQ(map.size(), 0u);
    EXPECT_EQ(map.nonfinite(), 1u);
    EXPECT_EQ(count_within(map, Vector(0.0f), up, 10.0), 0u);
}

TEST(PhotonMap, SurvivesAMillionIdenticalPositions) {
    std::vector<Photon> photons(1'000'000, photon_at(Vector(0.1f, 0.2f, 0.3f), 0));
    const PhotonMap map(std::move(photons));
    std::size_t count = 0;
    map.within(Vector(0.1f, 0.2f, 0.3f), up, 1e-6, [&](const Photon&, double) { ++count; });
    EXPECT_EQ(count, 1'000'000u);
    const NearestPhotons answer =
        map.nearest(Vector(0.1f, 0.2f, 0.3f), up, 50, 1.0, [](const Photon&, double, double) {});
    EXPECT_EQ(answer.found, 50u);
}

TEST(PhotonMap, AnswersDoNotDependOnTheOrderOfPhotons) {
    std::vector<Photon> photons =
        photon_set("order", 5000, [](RandomStream& random, std::size_t) { return random_point(random, 1.0f); }).photons;
    const PhotonMap map(photons);
    RandomStream random(7, RandomPurpose::Test, 0, 0);
    for (std::size_t i = photons.size() - 1; i > 0; --i)
        std::swap(photons[i], photons[static_cast<std::size_t>(random.next_double() * static_cast<double>(i + 1))]);
    const PhotonMap shuffled(photons);
    for (int query = 0; query < 50; ++query) {
        const Vector position = random_point(random, 1.0f);
        ASSERT_EQ(numbers_within(map, position, up, 0.2), numbers_within(shuffled, position, up, 0.2));
        std::vector<std::uint32_t> nearest;
        std::vector<std::uint32_t> nearest_shuffled;
        map.nearest(position, up, 50, 1.0,
                    [&](const Photon& photon, double, double) { nearest.push_back(number_of(photon)); });
        shuffled.nearest(position, up, 50, 1.0,
                         [&](const Photon& photon, double, double) { nearest_shuffled.push_back(number_of(photon)); });
        ASSERT_EQ(nearest, nearest_shuffled);
    }
}

TEST(PhotonMap, TwoMapsOfTheSamePhotonsVisitInTheSameOrder) {
    const PhotonSet set =
        photon_set("same", 5000, [](RandomStream& random, std::size_t) { return random_point(random, 1.0f); });
    const PhotonMap first(set.photons);
    const PhotonMap second(set.photons);
    std::vector<std::uint32_t> first_order;
    std::vector<std::uint32_t> second_order;
    first.within(Vector(0.0f), up, 0.3,
                 [&](const Photon& photon, double) { first_order.push_back(number_of(photon)); });
    second.within(Vector(0.0f), up, 0.3,
                  [&](const Photon& photon, double) { second_order.push_back(number_of(photon)); });
    EXPECT_EQ(first_order, second_order);
    EXPECT_GT(first_order.size(), 100u);
}

TEST(PhotonMap, ConcurrentQueriesAreBitwiseEqualToSerialOnes) {
    const PhotonSet set = photon_set("concurrent", 20'000, [](RandomStream& random, std::size_t i) {
        return random_point(random, i % 3 == 0 ? 1.0f : 0.05f);
    });
    const PhotonMap map(set.photons);
    struct Sums {
        double within = 0.0;
        double nearest = 0.0;
        double squared_radius = 0.0;
        bool operator==(const Sums&) const = default;
    };
    const auto ask = [&](int threads) {
        std::vector<Sums> sums(4000);
        parallel_for(sums.size(), threads, [&](std::size_t i) {
            RandomStream random(8, RandomPurpose::Test, 0, i);
            const Vector position = random_point(random, i % 2 == 0 ? 1.0f : 0.05f);
            // Sums of irrational terms: any change in the order of photons shows in the last bits.
            map.within(position, up, 0.02,
                       [&](const Photon& photon, double d) { sums[i].within += std::sqrt(d + number_of(photon)); });
            sums[i].squared_radius = map.nearest(position, up, 1 + i % 300, 0.5,
                                                 [&](const Photon& photon, double d, double r) {
                                                     sums[i].nearest += std::sqrt(d / r + number_of(photon));
                                                 })
                                         .squared_radius;
        });
        return sums;
    };
    const std::vector<Sums> serial = ask(1);
    for (int repetition = 0; repetition < 3; ++repetition) ASSERT_EQ(ask(4), serial);
}

// A patch far smaller than a cell of the scene's Morton curve: in the order of the paths, or of such cells alone,
// photons that follow each other would be half of the patch apart.
TEST(PhotonMap, HoldsNeighboursNextToEachOtherHoweverDenseTheyAre) {
    constexpr float patch = 1e-5f;
    PhotonSet set = photon_set("patch", 20'000, [&](RandomStream& random, std::size_t) {
        const Vector point = random_point(random, patch);
        return Vector(point.x, point.y, 0.0f);
    });
    for (Photon& photon : set.photons) photon = photon_at(photon.position, number_of(photon));
    set.photons.push_back(photon_at(Vector(1.0f), set.photons.size()));
    const PhotonMap map(set.photons);
    std::vector<Vector> visited;
    map.within(Vector(0.0f), up, patch, [&](const Photon& photon, double) { visited.push_back(photon.position); });
    ASSERT_EQ(visited.size(), 20'000u);
    double way = 0.0;
    for (std::size_t i = 1; i < visited.size(); ++i) way += (visited[i] - visited[i - 1]).length();
    EXPECT_LT(way / 20'000.0, 0.05 * patch);
}

TEST(PhotonMap, CanBeMovedAndStillAnswers) {
    static_assert(!std::is_copy_constructible_v<PhotonMap>);
    const PhotonSet set =
        photon_set("moved", 1000, [](RandomStream& random, std::size_t) { return random_point(random, 1.0f); });
    std::vector<PhotonMap> maps;
    for (int i = 0; i < 5; ++i) maps.emplace_back(set.photons);  // the vector grows, so the maps move
    for (const PhotonMap& map : maps)
        EXPECT_EQ(numbers_within(map, Vector(0.0f), up, 0.3),
                  numbers_by_brute_force(set.photons, Vector(0.0f), up, 0.3));
    const PhotonMap taken = std::move(maps[0]);
    EXPECT_EQ(numbers_within(taken, Vector(0.0f), up, 0.3), numbers_by_brute_force(set.photons, Vector(0.0f), up, 0.3));
}

TEST(PhotonMap, BytesCountPhotonsIndexAndBuffers) {
    const PhotonSet set =
        photon_set("bytes", 50'000, [](RandomStream& random, std::size_t) { return random_point(random, 1.0f); });
    const double bytes_per_photon = static_cast<double>(PhotonMap(set.photons).bytes()) / 50'000.0;
    // Photons with sort keys, or with their positions once more, groups and FLANN's tree of those.
    EXPECT_GE(bytes_per_photon, static_cast<double>(sizeof(Photon) + 16));
    EXPECT_LE(bytes_per_photon, 64.0);
}

}  // namespace
}  // namespace photonlab
