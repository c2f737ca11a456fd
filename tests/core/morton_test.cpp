// Places along a Morton curve: corners, the order of octants, and that cells are cubes.

#include "core/morton.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "core/random.h"

namespace photonlab {
namespace {

Box box_of(const std::vector<Vector>& points) {
    Box box;
    for (const Vector& point : points) box.include(point);
    return box;
}

TEST(MortonCurve, GoesFromTheLowestCornerToTheHighest) {
    const MortonCurve curve(box_of({Vector(-1.0f, 2.0f, 3.0f), Vector(1.0f, 4.0f, 5.0f)}));
    EXPECT_EQ(curve.place_of(Vector(-1.0f, 2.0f, 3.0f)), 0u);
    EXPECT_EQ(curve.place_of(Vector(1.0f, 4.0f, 5.0f)), (1u << 3 * MortonCurve::bits_per_axis) - 1u);
}

TEST(MortonCurve, VisitsOctantsWithXFirst) {
    const MortonCurve curve(box_of({Vector(0.0f), Vector(1.0f)}));
    for (unsigned octant = 0; octant < 8; ++octant) {
        const auto at = [&](unsigned axis) { return (octant >> axis & 1u) != 0 ? 0.75f : 0.25f; };
        EXPECT_EQ(curve.place_of(Vector(at(0), at(1), at(2))) >> (3 * MortonCurve::bits_per_axis - 3), octant);
    }
}

TEST(MortonCurve, CountsNoAxisAlongWhichThereIsNothingButRounding) {
    RandomStream random(1, RandomPurpose::Test, 0, 0);
    std::vector<Vector> flat;
    std::vector<Vector> rounded;
    for (int i = 0; i < 1000; ++i) {
        const Imath::V2f u = random.next_2d();
        flat.emplace_back(u.x, u.y, 0.25f);
        rounded.emplace_back(u.x, u.y, 0.25f + 1e-7f * random.next());
    }
    const MortonCurve along_flat(box_of(flat));
    const MortonCurve along_rounded(box_of(rounded));
    for (std::size_t i = 0; i < flat.size(); ++i)
        ASSERT_EQ(along_flat.place_of(flat[i]), along_rounded.place_of(rounded[i]));
}

TEST(MortonCurve, HasOnePlaceForPointsThatCoincide) {
    const MortonCurve curve(box_of({Vector(0.5f), Vector(0.5f)}));
    EXPECT_EQ(curve.place_of(Vector(0.5f)), 0u);
}

}  // namespace
}  // namespace photonlab
