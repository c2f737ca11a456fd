// PhotonMap against brute force, to the last photon, and its behaviour at the extremes that FLANN itself does not
// survive.
//
// A photon's number is kept in `power`, so that an answer can be compared photon by photon. Distances here and in the
// map are both exact to the last bits of a double, so even the rim has one right answer.

#include "gather/photon_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <string>
#include <type_traits>
#include <vector>

#include "core/parallel.h"
#include "core/random.h"

namespace photonlab {
namespace {

const Vector up(0.0f, 0.0f, 1.0f);
const Vector sideways(1.0f, 0.0f, 0.0f);

Photon photon_at(const Vector& position, std::size_t number, const Vector& normal = up, const Vector& incoming = up) {
    return {.position = position,
            .power = Color(static_cast<float>(number)),
            .incoming = PackedDirection(incoming),
            .normal = CoarseDirection(normal),
            .edges = 1};
}

std::uint32_t number_of(const Photon& photon) {
    return static_cast<std::uint32_t>(photon.power.x);
}

Vector random_point(RandomStream& random, float size) {
    const float x = random.next() - 0.5f;
    const float y = random.next() - 0.5f;
    return Vector(x, y, random.next() - 0.5f) * size;
}

/// Photons of which some are rejected: by their normal, by the side they came from, or not at all.
Photon random_photon(RandomStream& random, const Vector& position, std::size_t number) {
    const float kind = random.next();
    if (kind < 0.2f) return photon_at(position, number, sideways, Vector(0.6f, 0.0f, 0.8f));
    if (kind < 0.4f) return photon_at(position, number, up, Vector(0.0f, 0.6f, -0.8f));
    return photon_at(position, number);
}

struct PhotonSet {
    std::string name;
    std::vector<Photon> photons;
};

template <typename Position>
PhotonSet photon_set(const std::string& name, std::size_t count, const Position& position) {
    PhotonSet set{name, {}};
    RandomStream random(1, RandomPurpose::Test, 0, std::accumulate(name.begin(), name.end(), std::uint64_t{0}));
    for (std::size_t i = 0; i < count; ++i) {
        const Vector at = position(random, i);
        set.photons.push_back(random_photon(random, at, i));
    }
    return set;
}

std::vector<PhotonSet> photon_sets() {
    std::vector<PhotonSet> sets;
    sets.push_back({"none", {}});
    sets.push_back({"one", {photon_at(Vector(0.25f, -0.125f, 0.5f), 0)}});
    sets.push_back(
        photon_set("random", 3000, [](RandomStream& random, std::size_t) { return random_point(random, 1.0f); }));
    sets.push_back(photon_set("dense patch", 3000, [](RandomStream& random, std::size_t i) {
        return i % 3 == 0 ? random_point(random, 1.0f) : Vector(0.2f, 0.1f, 0.0f) + random_point(random, 1e-4f);
    }));
    sets.push_back(photon_set("tiny patch at the origin", 1000, [](RandomStream& random, std::size_t i) {
        return i % 3 == 0 ? random_point(random, 1.0f) : random_point(random, 4e-12f);
    }));
    // Of several tiers, and denser than the cells of one Morton curve.
    sets.push_back(photon_set("caustic in a caustic", 30'000, [](RandomStream& random, std::size_t i) {
        const float sizes[] = {1.0f, 1.0f, 1e-2f, 1e-4f};
        return Vector(0.1f, 0.2f, 0.3f) + random_point(random, sizes[i % 4]);
    }));
    sets.push_back(photon_set("collinear", 1000, [](RandomStream& random, std::size_t) {
        return Vector(1.0f, 2.0f, -0.5f) * (0.4f * (random.next() - 0.5f));
    }));
    sets.push_back(photon_set("flat", 2000, [](RandomStream& random, std::size_t) {
        Vector point = random_point(random, 1.0f);
        point.z = 0.25f;
        return point;
    }));
    sets.push_back(photon_set("identical", 500, [](RandomStream&, std::size_t) { return Vector(0.1f, 0.2f, 0.3f); }));
    sets.push_back(photon_set("lattice of 1/16", 17 * 17 * 17, [](RandomStream&, std::size_t i) {
        return Vector(static_cast<float>(i % 17), static_cast<float>(i / 17 % 17), static_cast<float>(i / 289)) *
                   0.0625f -
               Vector(0.5f);
    }));
    return sets;
}

/// Query points: on photons, between them, on the lattice, and outside.
std::vector<Vector> query_points(const PhotonSet& set) {
    std::vector<Vector> points{Vector(0.0f), Vector(0.1f, 0.2f, 0.3f), Vector(0.0625f, -0.125f, 0.25f),
                               Vector(3.0f, -2.0f, 1.0f)};
    RandomStream random(2, RandomPurpose::Test, 0, 0);
    for (int i = 0; i < 6; ++i) points.push_back(random_point(random, 1.1f));
    for (int i = 0; i < 6 && !set.photons.empty(); ++i)
        points.push_back(
            set.photons[static_cast<std::size_t>(random.next_double() * static_cast<double>(set.photons.size()))]
                .position);
    return points;
}

double squared_distance(const Vector& a, const Vector& b) {
    const double x = static_cast<double>(a.x) - b.x;
    const double y = static_cast<double>(a.y) - b.y;
    const double z = static_cast<double>(a.z) - b.z;
    return x * x + y * y + z * z;
}

bool accepted(const Photon& photon, const Vector& normal) {
    return photon.incoming.unit().dot(normal) > 0.0f && photon.normal.unit().dot(normal) > 0.5f;
}

std::vector<std::uint32_t> numbers_within(const PhotonMap& map, const Vector& position, const Vector& normal,
                                          double radius) {
    std::vector<std::uint32_t> numbers;
    map.within(position, normal, radius, [&](const Photon& photon, double d_squared) {
        numbers.push_back(number_of(photon));
        EXPECT_NEAR(d_squared, squared_distance(photon.position, position), 1e-15 * d_squared);
    });
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

std::vector<std::uint32_t> numbers_by_brute_force(const std::vector<Photon>& photons, const Vector& position,
                                                  const Vector& normal, double radius) {
    std::vector<std::uint32_t> numbers;
    for (const Photon& photon : photons)
        if (squared_distance(photon.position, position) <= radius * radius && accepted(photon, normal))
            numbers.push_back(number_of(photon));
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

std::size_t count_within(const PhotonMap& map, const Vector& position, const Vector& normal, double radius) {
    return numbers_within(map, position, normal, radius).size();
}

// ---------------------------------------------------------------------------------------------------------------------

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

// ---------------------------------------------------------------------------------------------------------------------

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

// ---------------------------------------------------------------------------------------------------------------------

TEST(PhotonMapNearest, FindsExactlyWhatBruteForceFinds) {
    std::size_t compared = 0;
    for (const PhotonSet& set : photon_sets()) {
        const PhotonMap map(set.photons);
        const std::size_t n = set.photons.size();
        for (const Vector& position : query_points(set))
            for (const double max_radius : {1e-12, 0.01, 0.3125, 10.0}) {
                std::vector<double> distances;  // squared, of all that count, sorted
                for (const Photon& photon : set.photons)
                    if (squared_distance(photon.position, position) <= max_radius * max_radius && accepted(photon, up))
                        distances.push_back(squared_distance(photon.position, position));
                std::sort(distances.begin(), distances.end());

                for (const std::size_t k :
                     {std::size_t{1}, std::size_t{2}, std::size_t{3}, std::size_t{10}, std::size_t{50},
                      std::size_t{200}, std::size_t{400}, std::max<std::size_t>(n, 1), n + 5}) {
                    SCOPED_TRACE(set.name + ", k " + std::to_string(k) + ", max radius " + std::to_string(max_radius));
                    const bool full = distances.size() >= k;
                    const double squared_radius = full ? std::max(distances[k - 1], 1e-36) : max_radius * max_radius;
                    std::vector<double> visited;
                    std::vector<std::uint32_t> numbers;
                    const NearestPhotons answer = map.nearest(
                        position, up, k, max_radius, [&](const Photon& photon, double d_squared, double r_squared) {
                            ASSERT_TRUE(accepted(photon, up));
                            ASSERT_NEAR(d_squared, squared_distance(photon.position, position), 1e-15 * d_squared);
                            ASSERT_NEAR(r_squared, squared_radius, 1e-15 * squared_radius);
                            visited.push_back(squared_distance(photon.position, position));
                            numbers.push_back(number_of(photon));
                        });
                    ASSERT_EQ(answer.found, std::min(k, distances.size()));
                    ASSERT_NEAR(answer.squared_radius, squared_radius, 1e-15 * squared_radius);
                    // The same distances, each by a photon of its own: equal but for the choice among ties at the rim.
                    ASSERT_EQ(visited.size(), full ? k - 1 : distances.size());
                    ASSERT_TRUE(std::equal(visited.begin(), visited.end(), distances.begin()));
                    std::sort(numbers.begin(), numbers.end());
                    ASSERT_EQ(std::adjacent_find(numbers.begin(), numbers.end()), numbers.end());
                    compared += visited.size();
                }
            }
    }
    EXPECT_GT(compared, 100'000u);
}

TEST(PhotonMapNearest, FindsWhatIsNearerThanFloatCanSquare) {
    // The k-th distance is 7e-23: its square is a denormal float, whose rounding is as large as itself.
    const PhotonMap map({photon_at(Vector(-0x1.7ddaa6p-75f, 0x1.c0d578p-75f, -0x1.67a312p-75f), 0),
                         photon_at(Vector(-0x1.1d3cacp-75f, -0x1.8f094p-75f, -0x1.61adecp-75f), 1),
                         photon_at(Vector(-0x1.73e2e6p-75f, -0x1.66fa4ep-76f, 0x1.df2ccap-76f), 2)});
    const Vector position(0x1.acc06p-76f, 0x1.35d31ap-77f, -0x1.4ff934p-77f);
    double nearest = infinity;
    map.nearest(position, up, 2, 1.0, [&](const Photon&, double d_squared, double) { nearest = std::sqrt(d_squared); });
    EXPECT_NEAR(nearest, 7.416e-23, 1e-26);

    for (const double eps : {0.0, 1e30, 1e300}) {
        const PhotonMap here({photon_at(Vector(0.25f), 0)});
        std::size_t found = 0;
        here.within_each(
            {{Vector(0.25f), up, 0.1}}, [&](std::size_t, const Photon&, double) { ++found; }, eps);
        EXPECT_EQ(found, 1u) << eps;
    }
}

// The i-th that is found is no farther than the i-th there is, but for a factor of 1 + eps in the squared distance.
TEST(PhotonMapNearest, WithEpsEachIsAtMostThatMuchFarther) {
    std::size_t farther = 0;
    for (const PhotonSet& set : photon_sets()) {
        const PhotonMap map(set.photons);
        for (const Vector& position : query_points(set))
            for (const std::size_t k : {std::size_t{5}, std::size_t{50}, std::size_t{300}})
                for (const double eps : {0.5, 4.0}) {
                    const auto distances = [&](double inexactness) {
                        std::vector<double> squared;
                        const NearestPhotons answer = map.nearest(
                            position, up, k, 10.0,
                            [&](const Photon&, double d_squared, double) { squared.push_back(d_squared); },
                            inexactness);
                        squared.push_back(answer.squared_radius);
                        return squared;
                    };
                    const std::vector<double> exact = distances(0.0);
                    const std::vector<double> found = distances(eps);
                    if (exact.size() < k) continue;  // not so many there: the radius is the maximum
                    ASSERT_EQ(found.size(), k);
                    for (std::size_t i = 0; i < k; ++i) {
                        ASSERT_GE(found[i], exact[i]) << set.name;
                        ASSERT_LE(found[i], exact[i] * (1.0 + eps) * (1.0 + 1e-5)) << set.name;
                        farther += found[i] > exact[i];
                    }
                }
    }
    EXPECT_GT(farther, 1'000u);
}

TEST(PhotonMapNearest, RejectedPhotonsDoNotCountAmongTheK) {
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < 100; ++i)  // nearer than any that counts
        photons.push_back(
            photon_at(Vector(1e-4f * static_cast<float>(i), 0.0f, 0.0f), i, sideways, Vector(0.6f, 0.0f, 0.8f)));
    for (std::size_t i = 0; i < 5; ++i)
        photons.push_back(photon_at(Vector(0.0f, 0.125f * static_cast<float>(i + 1), 0.0f), 1000 + i));
    std::vector<std::uint32_t> numbers;
    const NearestPhotons answer = PhotonMap(photons).nearest(
        Vector(0.0f), up, 4, 10.0, [&](const Photon& photon, double, double) { numbers.push_back(number_of(photon)); });
    EXPECT_EQ(answer.found, 4u);
    EXPECT_EQ(answer.squared_radius, 0.25);
    EXPECT_EQ(numbers, (std::vector<std::uint32_t>{1000, 1001, 1002}));
}

TEST(PhotonMapNearest, TiesGoToThePhotonThatCameFirst) {
    // A thousand photons at one place, among others: which of them are the k nearest must not depend on FLANN's
    // traversal.
    RandomStream random(5, RandomPurpose::Test, 0, 0);
    const Vector shared(0.1f, 0.2f, 0.3f);
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < 1000; ++i) {
        photons.push_back(photon_at(shared, i));
        photons.push_back(photon_at(Vector(2.0f) + random_point(random, 1.0f), 5000 + i));
    }
    const PhotonMap map(photons);
    for (const Vector& position : {shared, Vector(0.1f, 0.2f, 0.35f)})
        for (const std::size_t k : {2u, 10u, 40u, 200u, 300u, 999u}) {
            std::vector<std::uint32_t> numbers;
            map.nearest(position, up, k, 1.0,
                        [&](const Photon& photon, double, double) { numbers.push_back(number_of(photon)); });
            std::vector<std::uint32_t> expected(k - 1);
            std::iota(expected.begin(), expected.end(), 0u);
            ASSERT_EQ(numbers, expected) << "k " << k;
        }
}

TEST(PhotonMapNearest, FloorsTheRadiusWherePositionsAreIdentical) {
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < 100; ++i) photons.push_back(photon_at(Vector(0.25f), i));
    std::size_t visited = 0;
    const NearestPhotons answer =
        PhotonMap(photons).nearest(Vector(0.25f), up, 10, 1.0, [&](const Photon&, double d_squared, double r_squared) {
            EXPECT_EQ(d_squared, 0.0);
            EXPECT_GT(r_squared, 0.0);
            ++visited;
        });
    EXPECT_EQ(visited, 9u);
    EXPECT_EQ(answer.squared_radius, PhotonMap::minimum_radius * PhotonMap::minimum_radius);
}

TEST(PhotonMapNearest, ZeroPhotonsAskedForAreZeroFound) {
    const PhotonMap map({photon_at(Vector(0.0f), 0)});
    const NearestPhotons answer = map.nearest(Vector(0.0f), up, 0, 0.5, [](const Photon&, double, double) { FAIL(); });
    EXPECT_EQ(answer.found, 0u);
    EXPECT_EQ(answer.squared_radius, 0.25);
}

TEST(PhotonMapNearest, TheOnlyPhotonAskedForSetsTheRadiusAndCarriesNothing) {
    const PhotonMap map({photon_at(Vector(0.25f, 0.0f, 0.0f), 0), photon_at(Vector(0.5f, 0.0f, 0.0f), 1)});
    const NearestPhotons answer = map.nearest(Vector(0.0f), up, 1, 10.0, [](const Photon&, double, double) { FAIL(); });
    EXPECT_EQ(answer.found, 1u);
    EXPECT_EQ(answer.squared_radius, 0.0625);
}

TEST(PhotonMapNearest, AVisitMayAskTheMapAgain) {
    const PhotonSet set =
        photon_set("again", 500, [](RandomStream& random, std::size_t) { return random_point(random, 1.0f); });
    const PhotonMap map(set.photons);
    std::vector<std::uint32_t> plain;
    std::vector<std::uint32_t> nested;
    map.nearest(Vector(0.0f), up, 20, 10.0,
                [&](const Photon& photon, double, double) { plain.push_back(number_of(photon)); });
    const auto ask = [&](const auto& self, const Vector& position, int depth) -> void {
        map.nearest(position, up, 20, 10.0, [&](const Photon& photon, double, double) {
            if (depth == 0) nested.push_back(number_of(photon));
            if (depth < 1) self(self, photon.position, depth + 1);
        });
    };
    ask(ask, Vector(0.0f), 0);
    EXPECT_EQ(nested, plain);
    EXPECT_EQ(plain.size(), 19u);
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(PhotonMap, AnswersNothingWithoutPhotons) {
    const PhotonMap map({});
    EXPECT_EQ(map.size(), 0u);
    EXPECT_EQ(map.bytes(), 0u);
    EXPECT_EQ(count_within(map, Vector(0.0f), up, 10.0), 0u);
    const NearestPhotons answer = map.nearest(Vector(0.0f), up, 10, 0.5, [](const Photon&, double, double) { FAIL(); });
    EXPECT_EQ(answer.found, 0u);
    EXPECT_EQ(answer.squared_radius, 0.25);
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

TEST(PhotonMap, ManyQueriesAtOnceFindWhatEachFindsAlone) {
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
