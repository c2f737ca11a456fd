// Groups of photons: every photon is in one, in order, and inside its ball; distances are those of plain code.

#include "gather/photon_groups.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include "core/random.h"

namespace photonlab {
namespace {

std::vector<Photon> photons_at(const std::vector<Vector>& positions) {
    std::vector<Photon> photons(positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) photons[i].position = positions[i];
    return photons;
}

/// Along a line, evenly, but for a jump after every `run` photons.
std::vector<Vector> jumping_line(std::size_t count, std::size_t run) {
    std::vector<Vector> positions;
    for (std::size_t i = 0; i < count; ++i)
        positions.emplace_back(1e-3f * static_cast<float>(i % run), static_cast<float>(i / run), 0.0f);
    return positions;
}

std::vector<Vector> random_positions(std::size_t count, float size) {
    RandomStream random(1, RandomPurpose::Test, 0, count);
    std::vector<Vector> positions;
    for (std::size_t i = 0; i < count; ++i) {
        const Imath::V2f u = random.next_2d();
        positions.push_back(Vector(u.x, u.y, random.next()) * size);
    }
    return positions;
}

double distance(const Vector& a, const Vector& b) {
    return (VectorD(a) - VectorD(b)).length();
}

TEST(PhotonGroups, HoldEveryPhotonOnceInItsOrderAndInsideItsBall) {
    for (const std::vector<Vector>& positions :
         {std::vector<Vector>{}, random_positions(1, 1.0f), random_positions(15, 1.0f), random_positions(16, 1e-12f),
          random_positions(1000, 1e17f), jumping_line(500, 37), std::vector<Vector>(100, Vector(0.1f))}) {
        const PhotonGroups groups(photons_at(positions));
        std::size_t next = 0;
        float largest = 0.0f;
        for (const PhotonGroup& group : groups.list()) {
            ASSERT_EQ(group.first, next);
            ASSERT_GE(group.count, 1u);
            ASSERT_LE(group.count, PhotonGroups::capacity);
            for (; next < group.first + group.count; ++next) {
                EXPECT_EQ(groups.position(next), positions[next]);
                EXPECT_LE(distance(positions[next], group.centre), group.radius);
            }
            largest = std::max(largest, group.radius);
        }
        EXPECT_EQ(next, positions.size());
        EXPECT_EQ(groups.largest_radius(), largest);
    }
}

TEST(PhotonGroups, EndWhereTheCurveJumps) {
    // 16 do not divide 100: without that, a sixth of the groups would be a thousand times as wide as the others.
    const PhotonGroups groups(photons_at(jumping_line(10'000, 100)));
    EXPECT_LT(groups.largest_radius(), 0.01f);
    EXPECT_LE(groups.list().size(), 700u);
}

TEST(PhotonGroups, FindThoseWithinABound) {
    const std::vector<Vector> positions = random_positions(300, 1.0f);
    const PhotonGroups groups(photons_at(positions));
    const Vector centre(0.4f, 0.5f, 0.6f);
    std::size_t found = 0;
    for (const float bound : {0.01f, 0.1f, 1.0f, std::numeric_limits<float>::max()})
        for (const PhotonGroup& group : groups.list()) {
            unsigned expected = 0;
            for (unsigned i = 0; i < group.count; ++i)
                expected |= static_cast<unsigned>((positions[group.first + i] - centre).length2() <= bound) << i;
            ASSERT_EQ(groups.within(group, centre, bound), expected);
            found += static_cast<std::size_t>(std::popcount(expected));
        }
    EXPECT_GT(found, 500u);
}

}  // namespace
}  // namespace photonlab
