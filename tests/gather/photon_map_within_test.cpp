// Everything within a radius, against brute force, to the last photon; and which photons count.

#include "gather/map/photon_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/gather/photon_sets.h"

namespace photonlab {
namespace {

TEST(PhotonMapWithin, FindsExactlyWhatBruteForceFinds) {
    std::size_t found = 0;
    for (const PhotonSet& set : photon_sets()) {
        const PhotonMap map(set.photons);
        ASSERT_EQ(map.size(), set.photons.size());
        for (const Vector& position : query_points(set))
            for (const double radius :
                 {1e-12, 2e-12, 1e-8, 1e-5, 1e-4, 0.01, 0.0625, 0.1, 0.125, 0.1875, 0.3125, 0.5, 1.0, 10.0}) {
                const auto expected = numbers_by_brute_force(set.photons, position, up, radius);
                ASSERT_EQ(numbers_within(map, position, up, radius), expected) << set.name << ", radius " << radius;
                found += expected.size();
            }
    }
    EXPECT_GT(found, 100'000u);  // the comparison was not of empty sets
}

TEST(PhotonMapWithin, FindsPhotonsExactlyOnTheRim) {
    // 5/16 is the length of (3, 4, 0)/16 and (5, 0, 0)/16 and their permutations: 30 lattice points lie on the rim.
    const PhotonSet lattice = photon_sets().back();
    std::vector<Photon> photons = lattice.photons;
    for (Photon& photon : photons) photon = photon_at(photon.position, number_of(photon));
    const PhotonMap map(photons);
    const auto on_the_rim = [&](double radius) {
        std::size_t count = 0;
        map.within(Vector(0.0f), up, radius,
                   [&](const Photon&, double d_squared) { count += d_squared == 25.0 / 256.0; });
        return count;
    };
    EXPECT_EQ(on_the_rim(0.3125), 30u);
    EXPECT_EQ(on_the_rim(std::nextafter(0.3125, 0.0)), 0u);
    EXPECT_EQ(count_within(map, Vector(0.0f), up, 0.0625), 7u);
}

TEST(PhotonMapWithin, FindsAPhotonAtItsOwnRoundedDistance) {
    // The radius is the photon's own distance, rounded up in double by at most its last bit: float32 rounds these
    // distances either way, and would lose half of them.
    RandomStream random(3, RandomPurpose::Test, 0, 0);
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < 2000; ++i) photons.push_back(photon_at(random_point(random, 1.0f), i));
    const PhotonMap map(photons);
    for (int query = 0; query < 500; ++query) {
        const Vector position = random_point(random, 1.0f);
        const Photon& photon = photons[static_cast<std::size_t>(query) * 4];
        const double distance = std::sqrt(squared_distance(photon.position, position)) * (1.0 + 4e-16);
        const auto numbers = numbers_within(map, position, up, distance);
        ASSERT_TRUE(std::binary_search(numbers.begin(), numbers.end(), number_of(photon))) << query;
        const auto fewer = numbers_within(map, position, up, distance * (1.0 - 2e-15));
        ASSERT_FALSE(std::binary_search(fewer.begin(), fewer.end(), number_of(photon))) << query;
    }
}

TEST(PhotonMapWithin, TakesATinyRadiusAsTheSmallestThatFloatCanSquare) {
    const PhotonMap map({photon_at(Vector(0.0f), 0), photon_at(Vector(5e-19f, 0.0f, 0.0f), 1),
                         photon_at(Vector(2e-18f, 0.0f, 0.0f), 2)});
    for (const double radius : {0.0, 1e-300, 1e-24, PhotonMap::minimum_radius})
        EXPECT_EQ(numbers_within(map, Vector(0.0f), up, radius), (std::vector<std::uint32_t>{0, 1})) << radius;
}

TEST(PhotonMapWithin, TakesAnInfiniteRadiusAsEverything) {
    const PhotonSet set =
        photon_set("all", 500, [](RandomStream& random, std::size_t) { return random_point(random, 1.0f); });
    const PhotonMap map(set.photons);
    const auto all = numbers_by_brute_force(set.photons, Vector(0.2f), up, 1e3);
    EXPECT_EQ(numbers_within(map, Vector(0.2f), up, std::numeric_limits<double>::infinity()), all);
    // With eps as large, what must be found is still all of it.
    std::size_t found = 0;
    map.within_each(
        {{Vector(0.2f), up, 1e300}}, [&](std::size_t, const Photon&, double) { ++found; }, 1e300);
    EXPECT_EQ(found, all.size());
}

TEST(PhotonMapWithin, AQueryThatFindsNothingCostsItsNeighboursNothing) {
    const PhotonMap map({photon_at(Vector(0.0f), 0)});
    const double endless = std::numeric_limits<double>::infinity();
    for (const float far : {1e20f, infinity}) {
        std::vector<std::size_t> found;
        map.within_each({{Vector(0.0f), up, endless}, {Vector(far, 0.0f, 0.0f), up, endless}},
                        [&](std::size_t query, const Photon&, double) { found.push_back(query); });
        EXPECT_EQ(found, std::vector<std::size_t>{0}) << far;
    }
}

TEST(PhotonMapWithin, AnswersNothingForANonFiniteQuery) {
    const PhotonMap map({photon_at(Vector(0.0f), 0)});
    const float nan = std::numeric_limits<float>::quiet_NaN();
    EXPECT_EQ(count_within(map, Vector(nan, 0.0f, 0.0f), up, 1.0), 0u);
    EXPECT_EQ(count_within(map, Vector(0.0f, infinity, 0.0f), up, 1.0), 0u);
    EXPECT_EQ(count_within(map, Vector(0.0f), Vector(nan), 1.0), 0u);
    EXPECT_EQ(count_within(map, Vector(0.0f), up, std::numeric_limits<double>::quiet_NaN()), 0u);
}

// A group is left out only when all of it lies beyond r / sqrt(1 + eps): what is nearer is always found.
TEST(PhotonMapWithin, WithEpsMissesPhotonsNearTheRimAlone) {
    std::size_t missed = 0;
    for (const PhotonSet& set : photon_sets()) {
        const PhotonMap map(set.photons);
        for (const Vector& position : query_points(set))
            for (const double radius : {1e-4, 0.1, 0.3, 1.0})
                for (const double eps : {0.5, 4.0, 1e300}) {
                    std::vector<std::uint32_t> found;
                    map.within_each(
                        {{position, up, radius}},
                        [&](std::size_t, const Photon& photon, double) { found.push_back(number_of(photon)); }, eps);
                    std::sort(found.begin(), found.end());
                    const auto all = numbers_by_brute_force(set.photons, position, up, radius);
                    const auto certain =
                        numbers_by_brute_force(set.photons, position, up, radius / std::sqrt(1.0 + eps) * (1.0 - 1e-6));
                    ASSERT_TRUE(std::includes(all.begin(), all.end(), found.begin(), found.end())) << set.name;
                    ASSERT_TRUE(std::includes(found.begin(), found.end(), certain.begin(), certain.end())) << set.name;
                    missed += all.size() - found.size();
                }
    }
    EXPECT_GT(missed, 10'000u);
}

TEST(PhotonMapWithin, WithEpsAQueryAmongOthersFindsWhatItFindsAlone) {
    const PhotonSet set =
        photon_set("flat", 3000, [](RandomStream& random, std::size_t) { return random_point(random, 1.0f); });
    const PhotonMap map(set.photons);
    std::vector<GatherQuery> queries;
    for (int i = 0; i < 50; ++i) queries.push_back({Vector(0.004f * static_cast<float>(i), 0.0f, 0.0f), up, 0.2});
    const auto found = [&](const std::vector<GatherQuery>& asked) {
        std::vector<std::vector<std::uint32_t>> numbers(asked.size());
        map.within_each(
            asked,
            [&](std::size_t query, const Photon& photon, double) { numbers[query].push_back(number_of(photon)); }, 1.0);
        return numbers;
    };
    const auto together = found(queries);
    for (std::size_t i = 0; i < queries.size(); ++i) EXPECT_EQ(together[i], found({queries[i]}).front()) << i;
}

TEST(PhotonMapWithin, ManyQueriesAtOnceFindWhatEachFindsAlone) {
    for (const PhotonSet& set : photon_sets()) {
        const PhotonMap map(set.photons);
        RandomStream random(9, RandomPurpose::Test, 0, set.photons.size());
        // Runs of neighbours, strangers, radii that are alike and radii that are not, and what cannot be asked.
        std::vector<GatherQuery> queries;
        for (int i = 0; i < 400; ++i) {
            const bool is_stranger = i % 37 == 0 || queries.empty();
            const Vector near = is_stranger ? random_point(random, 1.0f) : queries.back().position;
            const double radius = (i % 5 == 0 ? 0.3 : 0.05) * (i % 2 == 0 ? 1.0 : 1.5) * (i / 100 == 3 ? 1e-3 : 1.0);
            queries.push_back({near + random_point(random, 0.02f), i % 3 == 0 ? sideways : up, radius});
        }
        queries[399].position.x = std::numeric_limits<float>::quiet_NaN();
        queries[398].position.y = infinity;
        std::vector<std::vector<std::uint32_t>> found(queries.size());
        map.within_each(queries, [&](std::size_t query, const Photon& photon, double squared) {
            found[query].push_back(number_of(photon));
            EXPECT_NEAR(squared, squared_distance(photon.position, queries[query].position), 1e-15 * squared);
        });
        for (std::size_t i = 0; i < queries.size(); ++i) {
            std::sort(found[i].begin(), found[i].end());
            ASSERT_EQ(found[i],
                      numbers_by_brute_force(set.photons, queries[i].position, queries[i].normal, queries[i].radius))
                << set.name << ", query " << i;
        }
    }
}

TEST(PhotonMapWithin, AVisitMayAskTheMapAgain) {
    const PhotonSet set =
        photon_set("again", 9000, [](RandomStream& random, std::size_t) { return random_point(random, 1.0f); });
    const PhotonMap map(set.photons);
    std::vector<std::uint32_t> plain;
    map.within(Vector(0.0f), up, 1.0, [&](const Photon& photon, double) { plain.push_back(number_of(photon)); });
    std::vector<std::uint32_t> nested;
    map.within(Vector(0.0f), up, 1.0, [&](const Photon& photon, double) {
        nested.push_back(number_of(photon));
        if (nested.size() % 100 == 1)
            map.within(photon.position, up, 0.3, [&](const Photon& other, double) { ASSERT_GT(other.edges, 0); });
    });
    EXPECT_EQ(nested, plain);
    EXPECT_GT(plain.size(), 5000u);  // more than are handed on at once
}

TEST(PhotonMapAcceptance, PhotonsArrivingFromBehindAreRejected) {
    const PhotonMap map({photon_at(Vector(0.0f), 0, up, Vector(0.0f, 0.6f, -0.8f)),
                         photon_at(Vector(0.0f), 1, up, Vector(0.0f, 0.6f, 0.8f)),
                         photon_at(Vector(0.0f), 2, up, Vector(0.0f, 1.0f, 0.0f))});
    EXPECT_EQ(numbers_within(map, Vector(0.0f), up, 0.1), std::vector<std::uint32_t>{1});
}

TEST(PhotonMapAcceptance, PhotonsOnAPerpendicularWallAreRejected) {
    const PhotonMap map({photon_at(Vector(0.01f, 0.0f, 0.0f), 0),
                         photon_at(Vector(0.0f, 0.0f, 0.01f), 1, sideways, Vector(0.6f, 0.0f, 0.8f))});
    EXPECT_EQ(numbers_within(map, Vector(0.02f, 0.0f, 0.0f), up, 0.1), std::vector<std::uint32_t>{0});
    EXPECT_EQ(numbers_within(map, Vector(0.0f, 0.0f, 0.02f), sideways, 0.1), std::vector<std::uint32_t>{1});
}

TEST(PhotonMapAcceptance, PhotonsOnTheOtherSideOfASheetAreRejected) {
    const PhotonMap map({photon_at(Vector(0.0f), 0, up, up), photon_at(Vector(0.0f), 1, -up, -up)});
    EXPECT_EQ(numbers_within(map, Vector(0.0f), up, 0.1), std::vector<std::uint32_t>{0});
    EXPECT_EQ(numbers_within(map, Vector(0.0f), -up, 0.1), std::vector<std::uint32_t>{1});
}

TEST(PhotonMapAcceptance, NormalsMayDifferByLessThanSixtyDegrees) {
    std::vector<Photon> photons;
    for (std::size_t degrees = 0; degrees < 90; degrees += 2) {
        const float angle = static_cast<float>(static_cast<double>(degrees) * pi / 180.0);
        if (degrees != 60)
            photons.push_back(photon_at(Vector(0.0f), degrees, Vector(std::sin(angle), 0.0f, std::cos(angle))));
    }
    const auto numbers = numbers_within(PhotonMap(photons), Vector(0.0f), up, 0.1);
    ASSERT_EQ(numbers.size(), 30u);
    EXPECT_EQ(numbers.back(), 58u);
}

}  // namespace
}  // namespace photonlab
