// Groups of photons: every photon is in one, in order, and inside its ball; distances are those of plain code.

#include "gather/map/photon_groups.h"

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

/// A dense patch of this size, and as many photons around it in the unit box.
std::vector<Vector> patch_in_a_box(std::size_t count, float size) {
    std::vector<Vector> positions = random_positions(count, size);
    for (const Vector& position : random_positions(count - 1, 1.0f)) positions.push_back(position);
    return positions;
}

TEST(PhotonGroups, HoldEveryPhotonOnceAndInsideItsBall) {
    for (const std::vector<Vector>& positions :
         {std::vector<Vector>{}, random_positions(1, 1.0f), random_positions(15, 1.0f), random_positions(16, 1e-12f),
          random_positions(1000, 1e17f), jumping_line(500, 37), std::vector<Vector>(10'000, Vector(0.1f)),
          patch_in_a_box(10'000, 1e-3f), patch_in_a_box(10'000, 1e-30f)}) {
        const PhotonGroups groups(photons_at(positions));
        std::vector<int> seen(positions.size(), 0);
        std::size_t next = 0;
        for (const GroupTier& tier : groups.tiers()) {
            ASSERT_EQ(tier.first, next);
            ASSERT_GT(tier.end, tier.first);
            float largest = 0.0f;
            for (; next < tier.end; ++next) {
                const PhotonGroup& group = groups.list()[next];
                ASSERT_GE(group.count, 1u);
                ASSERT_LE(group.count, PhotonGroups::capacity);
                for (std::size_t i = group.first; i < group.first + group.count; ++i) {
                    ++seen.at(i);
                    EXPECT_EQ(groups.position(i), positions[i]);
                    EXPECT_LE(distance(positions[i], group.centre), group.radius);
                }
                largest = std::max(largest, group.radius);
            }
            EXPECT_EQ(tier.largest_radius, largest);
        }
        EXPECT_EQ(next, groups.list().size());
        EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(positions.size()));
    }
}

TEST(PhotonGroups, EndWhereTheCurveJumps) {
    // 16 do not divide 100: without that, a sixth of the groups would be a thousand times as wide as the others.
    const PhotonGroups groups(photons_at(jumping_line(10'000, 100)));
    ASSERT_EQ(groups.tiers().size(), 1u);
    EXPECT_LT(groups.tiers()[0].largest_radius, 0.01f);
    EXPECT_LE(groups.list().size(), 700u);
}

TEST(PhotonGroups, AreApartFromThoseThatAreMuchDenser) {
    // Along a line: 30,000 photons a millionth apart, then 30,000 a thousandth apart.
    std::vector<Vector> positions;
    for (int i = 0; i < 60'000; ++i)
        positions.emplace_back(i < 30'000 ? 1e-6f * static_cast<float>(i) : 1e-3f * static_cast<float>(i - 29'900),
                               0.0f, 0.0f);
    const PhotonGroups groups(photons_at(positions));
    ASSERT_EQ(groups.tiers().size(), 2u);
    EXPECT_LT(groups.tiers()[0].largest_radius, 1e-5f);
    EXPECT_LT(groups.tiers()[1].largest_radius, 1e-2f);
    EXPECT_NEAR(static_cast<double>(groups.tiers()[0].end), 30'000.0 / 16.0, 10.0);
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
