// The nearest photons, against brute force: which they are, which of them carry flux, and the radius of their disc.

#include "gather/map/photon_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "tests/gather/photon_sets.h"

namespace photonlab {
namespace {

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

}  // namespace
}  // namespace photonlab
