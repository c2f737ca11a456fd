// Direct light where one sample is already exact: a point light has nothing to choose, and inside a uniformly emitting
// sphere every point on it contributes alike. What is left are the cosine, the square of the distance, sides and
// shadows.

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "transport/direct_light.h"

namespace photonlab::test {
namespace {

/// One sample at the only hit point of a 1 x 1 camera.
ColorD sample_once(const Scene& scene, std::uint64_t seed = 1) {
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    EXPECT_EQ(hit_points.points.size(), 1u);
    RandomStream random(seed, RandomPurpose::Test, 0, 0);
    const HitPoint& point = hit_points.points.at(0);
    const auto light = connect_to_light(scene, surface_at(scene, point), point.outgoing, random);
    return light ? light->contribution : ColorD(0.0);
}

TEST(DirectLight, OfAPointLightHasItsCosineAndSquaredDistance) {
    for (const double angle : {0.0, 0.5, 1.0, 1.4})
        for (const double distance : {0.1, 1.0, 20.0}) {
            SceneDescription description = floor_seen_at_origin(Color(0.2f, 0.5f, 0.8f));
            description.lights = {point_light(VectorD(distance * std::sin(angle), distance * std::cos(angle), 0.0),
                                              ColorD(1.0, 2.0, 3.0))};
            const ColorD radiance = sample_once(build_scene(description));
            for (int c = 0; c < 3; ++c) {
                const double exact = (0.2 + 0.3 * c) / pi * (c + 1.0) * std::cos(angle) / (distance * distance);
                // float32 positions: 60 units wide, so 4e-6 of a unit.
                EXPECT_NEAR(radiance[c], exact, exact * (1e-5 + 2e-5 / (distance * std::cos(angle))));
            }
        }
}

TEST(DirectLight, FromBehindIsNone) {
    for (const bool two_sided : {false, true}) {
        SceneDescription description = floor_seen_at_origin(Color(0.5f));
        description.materials[0].two_sided = two_sided;
        description.lights = {point_light(VectorD(0.5, -1.0, 0.0), ColorD(1.0))};
        EXPECT_EQ(sample_once(build_scene(description)), ColorD(0.0));
    }
}

TEST(DirectLight, OfATwoSidedSurfaceSeenFromBehindIsThatOfItsBack) {
    SceneDescription description = floor_seen_at_origin(Color(0.5f));
    description.materials[0].two_sided = true;
    description.camera = look_at(VectorD(1.0, -2.0, 0.5), VectorD(0.0));
    description.lights = {point_light(VectorD(0.0, -2.0, 0.0), ColorD(1.0))};
    EXPECT_NEAR(sample_once(build_scene(description)).x, 0.5 / pi / 4.0, 1e-6);
}

TEST(DirectLight, IsBlockedByAnythingBetweenAndNothingBeyond) {
    for (const double height : {0.01, 1.0, 1.99, 2.01, 3.0}) {
        SceneDescription description = floor_seen_at_origin(Color(0.5f));
        description.lights = {point_light(VectorD(0.0, 2.0, 0.0), ColorD(1.0))};
        // Small enough not to hide the floor from the camera; its face looks away from either end.
        description.shapes.push_back(disk(VectorD(0.0, height, 0.0), VectorD(0, 1, 0), 0.005, 1));
        EXPECT_EQ(sample_once(build_scene(description)) == ColorD(0.0), height < 2.0) << height;
    }
}

// From x inside a sphere of radius R, on it: f Le cos cos' / d^2 times the area 4 pi R^2 is rho Le, whatever the point.
TEST(DirectLight, InsideAUniformSphereIsTheSameForEverySample) {
    const Scene scene = build_scene(hollow_sphere(Color(0.2f, 0.5f, 0.8f), ColorD(1.0, 2.0, 3.0), 1));
    for (std::uint64_t seed = 1; seed <= 1000; ++seed) {
        const ColorD radiance = sample_once(scene, seed);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(radiance[c], (0.2 + 0.3 * c) * (c + 1.0), 1e-3) << seed;
    }
}

// An outward sphere is sampled inside its visible cone: f Le cos / density varies only with the cosine, so a small
// sphere overhead is nearly exact in one sample: cos theta >= sqrt(1 - (a/D)^2).
TEST(DirectLight, OfASmallSphereOverheadIsNearlyExactInOneSample) {
    SceneDescription description = floor_seen_at_origin(Color(0.5f));
    description.shapes.push_back(sphere(VectorD(0.0, 2.0, 0.0), 0.02, false, 1, ColorD(100.0)));
    const Scene scene = build_scene(description);
    for (std::uint64_t seed = 1; seed <= 200; ++seed)
        EXPECT_NEAR(sample_once(scene, seed).x, 0.5 * 100.0 * 1e-4, 0.5 * 100.0 * 1e-4 * 2e-4) << seed;
}

TEST(DirectLight, IsNoneWithoutLights) {
    EXPECT_EQ(sample_once(build_scene(floor_seen_at_origin(Color(0.5f)))), ColorD(0.0));
}

}  // namespace
}  // namespace photonlab::test
