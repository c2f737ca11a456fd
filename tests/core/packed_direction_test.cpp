// Packed directions: how far off they are, and that the directions that scenes are made of come back as they were.

#include "core/packed_direction.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "core/sampling.h"

namespace photonlab {
namespace {

/// Angle between unit vectors, radians; exact for small ones.
double angle_between(const Vector& a, const Vector& b) {
    return 2.0 * std::asin(0.5 * (VectorD(a) - VectorD(b)).length());
}

template <typename Packed>
void expect_angles_below(double largest) {
    RandomStream random(3, RandomPurpose::Test, 0, sizeof(Packed));
    double worst = 0.0;
    for (int i = 0; i < 200'000; ++i) {
        const Vector direction = sample_unit_sphere(random.next_2d()).normalized();
        const Packed packed(direction);
        const Vector unit = packed.unit();
        ASSERT_NEAR(unit.length(), 1.0f, 1e-6f);
        ASSERT_LT(angle_between(packed.unnormalized().normalized(), unit), 1e-6);
        ASSERT_GE(packed.unnormalized().length(), 0.57f);
        ASSERT_LE(packed.unnormalized().length(), 1.00001f);
        worst = std::max(worst, angle_between(unit, direction));
    }
    EXPECT_LT(worst, largest);
    EXPECT_GT(worst, 0.9 * largest);
}

TEST(PackedUnitVector, IsOffByNoMoreThanItSays) {
    expect_angles_below<PackedDirection>(0.5 * std::sqrt(18.0) / 32767.0);
    expect_angles_below<CoarseDirection>(0.5 * std::sqrt(18.0) / 127.0);
}

TEST(PackedUnitVector, GivesTheAxesBackExactly) {
    for (int axis = 0; axis < 3; ++axis)
        for (const float sign : {-1.0f, 1.0f}) {
            Vector direction(0.0f);
            direction[axis] = sign;
            EXPECT_EQ(PackedDirection(direction).unit(), direction);
            EXPECT_EQ(CoarseDirection(direction).unit(), direction);
        }
}

}  // namespace
}  // namespace photonlab
