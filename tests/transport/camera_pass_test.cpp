// The camera pass: sample positions on their grid, what a hit point says of itself, and emission seen directly.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/error.h"
#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"

namespace photonlab::test {
namespace {

/// A camera straight above a floor at distance 2 with an image plane 2 wide there: hit points are the sample positions.
SceneDescription floor_from_above(int width, int height) {
    SceneDescription scene = floor_seen_at_origin(Color(0.5f));
    CameraDescription& camera = scene.camera;
    // Left in the image is +x, up is +z, and the view goes down.
    camera.to_world = Matrix(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 2, 0, 1);
    camera.fov_x = 2.0 * std::atan(0.5) * 180.0 / pi;
    camera.width = width;
    camera.height = height;
    return scene;
}

TEST(HitPoints, LieOnTheGridOfSamplePositions) {
    for (const int samples : {1, 4, 9}) {
        const int grid = static_cast<int>(std::lround(std::sqrt(samples)));
        const Scene scene = build_scene(floor_from_above(20, 10));
        const HitPoints hit_points = trace_hit_points(scene, samples, 2);
        ASSERT_EQ(hit_points.points.size(), static_cast<std::size_t>(200 * samples));
        EXPECT_EQ(hit_points.footprints.size(), hit_points.points.size());
        std::vector<int> seen(200, 0);
        for (const HitPoint& point : hit_points.points) {
            const VectorD position = VectorD(point.position) * scene.unit_length + scene.centre;
            // The image is 2 wide and 1 high on the floor; x runs to the right, which is -x, y down, which is -z.
            const double x = (1.0 - position.x) / 2.0 * 20.0;
            const double y = (0.5 - position.z) * 10.0;
            const int column = static_cast<int>(point.pixel) % 20;
            const int row = static_cast<int>(point.pixel) / 20;
            const int sample = seen[point.pixel]++;
            EXPECT_NEAR(x, column + (sample % grid + 0.5) / grid, 1e-4);
            EXPECT_NEAR(y, row + (sample / grid + 0.5) / grid, 1e-4);
            EXPECT_NEAR(point.weight.x, 1.0 / samples, 1e-7);
            EXPECT_EQ(point.camera_edges, 1);
            EXPECT_EQ(point.normal, Vector(0, 1, 0));
            EXPECT_GT(point.outgoing.y, 0.0f);
        }
        for (const int count : seen) EXPECT_EQ(count, samples);
    }
}

TEST(HitPoints, FootprintIsTheWidthOfAPixelThere) {
    const Scene scene = build_scene(floor_from_above(21, 21));
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    for (std::size_t i = 0; i < hit_points.points.size(); ++i) {
        if (hit_points.points[i].pixel != 10 * 21 + 10) continue;
        EXPECT_NEAR(hit_points.footprints[i] * scene.unit_length, 2.0 / 21.0, 1e-5);
    }
}

TEST(HitPoints, AreTheSameOnAnyNumberOfThreads) {
    const Scene scene = build_scene(room(50, 37));
    const HitPoints one = trace_hit_points(scene, 4, 1);
    for (const int threads : {2, 3}) {
        const HitPoints many = trace_hit_points(scene, 4, threads);
        ASSERT_EQ(one.points.size(), many.points.size());
        EXPECT_EQ(one.footprints, many.footprints);
        EXPECT_EQ(emission_image(one, -1), emission_image(many, -1));
        for (std::size_t i = 0; i < one.points.size(); ++i) {
            EXPECT_EQ(one.points[i].position, many.points[i].position);
            EXPECT_EQ(one.points[i].pixel, many.points[i].pixel);
        }
    }
}

// Flat and diffuse, seen directly: nothing but position, pixel and where the rest is.
TEST(HitPoints, TakeTwentyBytesEachWhereTheyAreLikeTheirNeighbours) {
    const Scene scene = build_scene(floor_from_above(160, 160));
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    ASSERT_EQ(hit_points.points.size(), 160u * 160u);
    EXPECT_GE(hit_points.points.bytes(), 20u * 160 * 160);
    EXPECT_LT(hit_points.points.bytes(), 21u * 160 * 160);
}

// Where roughness depends on the direction a hit point knows the frame in which the path saw it, in four bytes more.
TEST(HitPoints, KnowTheirFrameWhereAMaterialAsksForIt) {
    SceneDescription description = floor_from_above(40, 40);
    std::uint64_t bytes[2];
    for (const bool is_anisotropic : {false, true}) {
        description.materials[0] = {
            .id = "metal",
            .bsdf = RoughConductor{.facets = {FacetSlopes::Ggx, 0.3f, is_anisotropic ? 0.1f : 0.3f}},
            .is_anisotropic = is_anisotropic};
        const Scene scene = build_scene(description);
        const HitPoints hit_points = trace_hit_points(scene, 1, 1);
        bytes[is_anisotropic ? 1 : 0] = hit_points.points.bytes();
        ASSERT_EQ(hit_points.points.size(), 1600u);
        for (const HitPoint point : hit_points.points) {
            const Frame frame = surface_at(scene, point).frame;
            const Vector above = point.position + point.geometric_normal;
            const auto hit = intersect(scene, {above, -point.geometric_normal});
            ASSERT_TRUE(hit);
            const Frame seen = orient(scene, *hit, point.geometric_normal)->frame;
            EXPECT_NEAR((frame.tangent - seen.tangent).length(), 0.0, 1e-4);
            EXPECT_NEAR((frame.bitangent - seen.bitangent).length(), 0.0, 1e-4);
        }
    }
    EXPECT_EQ(bytes[1], bytes[0] + 4u * 1600);
}

TEST(HitPoints, SeeALightFromItsFrontAlone) {
    for (const double side : {1.0, -1.0}) {
        SceneDescription description = floor_from_above(4, 4);
        description.shapes = {disk(VectorD(0.0), VectorD(0.0, side, 0.0), 30.0, 1, ColorD(1.0, 2.0, 3.0))};
        const HitPoints hit_points = trace_hit_points(build_scene(description), 4, 1);
        for (const ColorD& emission : emission_image(hit_points, -1))
            EXPECT_EQ(emission, side > 0.0 ? ColorD(1.0, 2.0, 3.0) : ColorD(0.0));
        EXPECT_TRUE(hit_points.points.empty());  // black: nothing to gather
    }
}

TEST(HitPoints, AreNoneBehindAOneSidedSurfaceOrInTheVoid) {
    SceneDescription behind = floor_from_above(4, 4);
    behind.shapes = {disk(VectorD(0.0), VectorD(0, -1, 0), 30.0, 0)};
    SceneDescription nothing = behind;
    nothing.shapes.clear();
    for (const SceneDescription& description : {behind, nothing}) {
        const HitPoints hit_points = trace_hit_points(build_scene(description), 1, 1);
        EXPECT_TRUE(hit_points.points.empty());
        EXPECT_EQ(emission_image(hit_points, -1), std::vector<ColorD>(16, ColorD(0.0)));
    }
}

TEST(HitPoints, RefuseANumberOfSamplesThatIsNoSquare) {
    const Scene scene = build_scene(floor_from_above(2, 2));
    for (const int samples : {0, -1, 2, 3, 5, 8}) try {
            trace_hit_points(scene, samples, 1);
            ADD_FAILURE() << samples;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("perfect square"), std::string::npos) << error.what();
        }
}

}  // namespace
}  // namespace photonlab::test
