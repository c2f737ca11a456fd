// Frames and the offset of rays: each has one bad spot that is easy to get wrong, normals close to -z for the one and
// points far from the origin for the other.

#include "core/math.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/random.h"
#include "core/sampling.h"

namespace photonlab {
namespace {

constexpr float epsilon = std::numeric_limits<float>::epsilon();

std::vector<Vector> many_normals() {
    std::vector<Vector> normals{{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
    for (const float side : {-1.0f, 1.0f}) {
        normals.emplace_back(1.0f, 0.0f, side * 0.0f);
        for (float tilt = 1e-20f; tilt < 1.0f; tilt *= 3.0f)
            for (const Vector& away : {Vector(tilt, 0, side), Vector(-tilt, tilt, side), Vector(0, tilt, side)})
                normals.push_back(away.normalized());
    }
    RandomStream random(7, RandomPurpose::Test, 1, 0);
    for (int i = 0; i < 10'000; ++i) normals.push_back(sample_unit_sphere(random.next_2d()).normalized());
    return normals;
}

TEST(MakeFrame, IsOrthonormalToRoundingAroundEveryNormal) {
    for (const Vector& normal : many_normals()) {
        const Frame frame = make_frame(normal);
        EXPECT_EQ(frame.normal, normal);
        EXPECT_NEAR(frame.tangent.length(), 1.0f, 8 * epsilon) << normal;
        EXPECT_NEAR(frame.bitangent.length(), 1.0f, 8 * epsilon) << normal;
        EXPECT_NEAR(frame.tangent.dot(frame.bitangent), 0.0f, 8 * epsilon) << normal;
        EXPECT_NEAR(frame.tangent.dot(normal), 0.0f, 8 * epsilon) << normal;
        EXPECT_NEAR(frame.bitangent.dot(normal), 0.0f, 8 * epsilon) << normal;
        EXPECT_LT((frame.tangent.cross(frame.bitangent) - normal).length(), 8 * epsilon) << normal;
    }
}

TEST(Frame, ToWorldUndoesToLocal) {
    RandomStream random(7, RandomPurpose::Test, 1, 1);
    for (const Vector& normal : many_normals()) {
        const Frame frame = make_frame(normal);
        const Vector direction = sample_unit_sphere(random.next_2d());
        EXPECT_LT((frame.to_world(frame.to_local(direction)) - direction).length(), 16 * epsilon) << normal;
        EXPECT_LT((frame.to_world({0, 0, 1}) - normal).length(), 2 * epsilon) << normal;
    }
}

TEST(OffsetFromSurface, GoesToTheSideOfTheDirectionAndScalesWithTheCoordinate) {
    const Vector normal(0, 1, 0);
    EXPECT_GT(offset_from_surface({0, 0.25f, 0}, normal, {0.9f, 0.1f, 0}).y, 0.25f);
    EXPECT_LT(offset_from_surface({0, 0.25f, 0}, normal, {0.9f, -0.1f, 0}).y, 0.25f);
    EXPECT_GT(offset_from_surface({0, 1000.0f, 0}, normal, {0, 1, 0}).y, 1000.0f);
}

TEST(OffsetFromSurface, IsManyRoundingsLongAndYetTinyInTheBox) {
    for (const Vector& normal : many_normals())
        for (const Vector& position : {Vector(0.0f), Vector(0.5f), Vector(-0.5f, 0.1f, 1e-20f)}) {
            const float step = (offset_from_surface(position, normal, normal) - position).dot(normal);
            EXPECT_GT(step, 8 * epsilon) << normal;
            EXPECT_LT(step, 1e-5f) << normal;
        }
}

}  // namespace
}  // namespace photonlab
