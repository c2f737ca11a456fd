// Camera paths that go on from glossy surfaces: what lights bring to such a surface is found by connections and by the
// rays that go on, together once; what comes after is of the layer gathered; surfaces that are rough enough are
// gathered at all the same.

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

constexpr std::uint64_t glossy_seeds = 16;

Material rough_metal(float alpha) {
    return {.id = "metal",
            .bsdf = RoughConductor{.facets = {FacetSlopes::Ggx, alpha}, .eta = Color(0.2f), .k = Color(3.9f)}};
}

Material rough_glass(float alpha) {
    return {.id = "glass", .bsdf = RoughDielectric{.facets = {FacetSlopes::Beckmann, alpha}}};
}

/// Balls of rough metal and rough glass in a room, smooth and less so, and a mirror and glass to see them by.
SceneDescription room_of_glossy_balls() {
    SceneDescription description = room(32, 32);
    for (const Material& material :
         {rough_metal(0.05f), rough_metal(0.3f), rough_glass(0.1f), Material{.id = "glass", .bsdf = Dielectric{}},
          Material{.id = "mirror", .bsdf = Conductor{.reflectance = Color(0.9f)}}}) {
        const auto i = static_cast<double>(description.materials.size() - 5);
        description.materials.push_back(material);
        description.shapes.push_back(
            sphere(VectorD(-0.8 + 0.4 * i, -0.7 + 0.2 * i, 0.4), 0.22, false, description.materials.size() - 1));
    }
    return description;
}

/// Means of both layers over the image, by seed.
struct GlossyMeans {
    std::vector<double> direct, gathered;
};

GlossyMeans means_of(const Scene& scene, const HitPoints& points, const MethodSettings& method, std::uint64_t passes) {
    GlossyMeans means;
    for (std::uint64_t seed = 1; seed <= glossy_seeds; ++seed) {
        const Image image = render(scene, points, method, {.passes = passes, .seed = seed}).image;
        means.direct.push_back(mean_of(image, direct_layer).y);
        means.gathered.push_back(mean_of(image, gathered_layer).y);
    }
    return means;
}

const std::vector<double> none(glossy_seeds, 0.0);

// Direct light has no bias; gathered light has that of radii of 0.02, of 1.5% at most (materials_test.cpp).
void agree(ClaimFamily& claims, const std::string& what, const GlossyMeans& means, const GlossyMeans& path) {
    claims.means_agree("direct " + what, means.direct, path.direct, 0.03);
    claims.means_agree("gathered " + what, means.gathered, path.gathered, 0.03, 0.015);
}

MethodSettings continuing(double gather_roughness, DirectMode direct = DirectMode::Sampled) {
    return {.integrator = "sppm",
            .glossy = GlossyMode::Continue,
            .gather_roughness = gather_roughness,
            .radius = 0.02,
            .direct = direct,
            .direct_samples = direct == DirectMode::Sampled ? 4 : 1,
            .photons_per_pass = 20'000};
}

TEST(GoingOn, LeavesHitPointsWhereItIsRoughEnoughAlone) {
    const Scene scene = build_scene(room_of_glossy_balls());
    const auto has_points_on = [&](double gather_roughness, float alpha) {
        const NewPoints kind{.positions = Positions::Box, .gather_roughness = gather_roughness};
        for (const HitPoint point : trace_new_hit_points(scene, 1, kind, {}, 1).points)
            if (roughness(scene.materials[point.material].bsdf) == alpha) return true;
        return false;
    };
    for (const float alpha : {0.05f, 0.1f, 0.3f}) {
        EXPECT_TRUE(has_points_on(0.0, alpha));
        EXPECT_EQ(has_points_on(0.2, alpha), alpha >= 0.2f) << alpha;
        EXPECT_FALSE(has_points_on(1.0, alpha)) << alpha;
    }
}

// All of it is direct light, and none is gathered: a flat disk of glossy metal in a surround of radiance 1.
TEST(GoingOn, FindsAUniformSurroundOnce) {
    for (const float alpha : {0.02f, 0.3f}) {
        SceneDescription description;
        description.materials = {rough_metal(alpha)};
        description.shapes = {disk(VectorD(0.0), VectorD(0, 0, 1), 5.0, 0)};
        description.lights = {ConstantDescription{.radiance = ColorD(1.0), .place = "test"}};
        description.camera = look_at(VectorD(30, 0, 85), VectorD(0.0), 8, 8, 1.6);
        const Scene scene = build_scene(description);
        const HitPoints points = trace_hit_points(scene, 1, 1);
        ClaimFamily claims;
        MethodSettings method = continuing(0.5);
        method.photons_per_pass = 10;
        const GlossyMeans means = means_of(scene, points, method, 200);
        const GlossyMeans path = means_of(scene, points, {.integrator = "path"}, 200);
        claims.means_agree("direct", means.direct, path.direct, 0.01);
        EXPECT_EQ(means.gathered, none);
    }
}

TEST(RoomOfGlossyBalls, IsTheSameByPathsThatGoOnAndByPathTracing) {
    const Scene scene = build_scene(room_of_glossy_balls());
    const HitPoints points = trace_hit_points(scene, 1, 1);
    ClaimFamily claims;
    const GlossyMeans path = means_of(scene, points, {.integrator = "path"}, 64);
    for (const double gather_roughness : {0.2, 1.0})
        agree(claims, "below " + std::to_string(gather_roughness),
              means_of(scene, points, continuing(gather_roughness), 8), path);
}

// Photons that carry direct light: all but emission is of the layer gathered.
TEST(RoomOfGlossyBalls, HoldsAllLightOnceWherePhotonsCarryIt) {
    const Scene scene = build_scene(room_of_glossy_balls());
    const HitPoints points = trace_hit_points(scene, 1, 1);
    GlossyMeans path = means_of(scene, points, {.integrator = "path"}, 64);
    for (std::size_t i = 0; i < glossy_seeds; ++i) path.gathered[i] += path.direct[i];
    const GlossyMeans means = means_of(scene, points, continuing(0.2, DirectMode::Photons), 8);
    ClaimFamily claims;
    claims.means_agree("gathered", means.gathered, path.gathered, 0.02, 0.015);
    EXPECT_EQ(means.direct, none);
}

// Direct light of hit points on narrow lobes, by a connection and a drawn direction together. By connections alone the
// second moment below is 33 times path tracing's: few connections are within the lobe, and those weigh much.
TEST(HitPointsOnNarrowLobes, FindDirectLightAsPathTracingDoes) {
    SceneDescription description;
    description.materials = {rough_metal(0.01f), diffuse(Color(0.0f))};
    description.shapes = {disk(VectorD(0.0), VectorD(0, 0, 1), 5.0, 0)};
    description.shapes.push_back(
        shape(parallelogram(VectorD(-14, -4, 20), VectorD(0, 8, 0), VectorD(8, 0, 0)), 1, ColorD(2.0)));
    description.camera = look_at(VectorD(10, 0, 20), VectorD(0.0), 8, 8, 12.0);
    const Scene scene = build_scene(description);
    const HitPoints points = trace_hit_points(scene, 1, 1);
    const auto squares_of = [&](const MethodSettings& method, std::vector<double>& means) {
        double squares = 0.0;
        for (std::uint64_t seed = 1; seed <= 64; ++seed) {
            const Image image = render(scene, points, method, {.passes = 1, .seed = seed}).image;
            means.push_back(mean_of(image, direct_layer).y);
            for (const Color& pixel : *image.find(direct_layer)) squares += pixel.y * pixel.y;
        }
        return squares;
    };
    std::vector<double> of_ppm, of_path;
    const double squares = squares_of({.integrator = "ppm", .photons_per_pass = 10}, of_ppm);
    const double expected = squares_of({.integrator = "path"}, of_path);
    ClaimFamily claims;
    claims.means_agree("direct", of_ppm, of_path, 0.02);
    EXPECT_NEAR(squares / expected, 1.0, 0.1);
}

// A light without size is found by connections alone.
TEST(GoingOn, FindsLightWithoutSize) {
    SceneDescription description = room(24, 24);
    description.materials[0] = rough_metal(0.15f);  // floor, ceiling, back wall
    description.materials[3] = rough_metal(0.05f);  // block
    description.materials[4] = diffuse(Color(0.5f));
    for (ShapeDescription& one : description.shapes) one.radiance = std::nullopt;
    description.lights = {point_light(VectorD(0.2, 0.5, -0.3), ColorD(1.0))};
    const Scene scene = build_scene(description);
    const HitPoints points = trace_hit_points(scene, 1, 1);
    ClaimFamily claims;
    MethodSettings method = continuing(0.2);
    method.photons_per_pass = 5000;
    agree(claims, "of a point", means_of(scene, points, method, 32),
          means_of(scene, points, {.integrator = "path"}, 128));
}

// By a mirror or through glass nobody would find it.
TEST(GoingOn, RefusesLightThatItCannotFind) {
    SceneDescription description = room_of_glossy_balls();
    description.lights = {point_light(VectorD(0.2, 0.5, -0.3), ColorD(1.0))};
    const Scene scene = build_scene(description);
    const HitPoints points = trace_hit_points(scene, 1, 1);
    EXPECT_THROW(loop_of(continuing(0.2), scene, points), InputError);
    MethodSettings short_paths = continuing(0.2);
    short_paths.max_depth = 2;
    EXPECT_NO_THROW(loop_of(short_paths, scene, points));
    EXPECT_NO_THROW(loop_of(continuing(0.04), scene, points)) << "all are rough enough to be gathered at";
}

// What paths of at most `max_depth` edges bring is path tracing's, too.
TEST(RoomOfGlossyBalls, CountsEdgesOfPathsThatGoOn) {
    const Scene scene = build_scene(room_of_glossy_balls());
    const HitPoints points = trace_hit_points(scene, 1, 1);
    ClaimFamily claims;
    for (const int max_depth : {2, 3}) {
        MethodSettings method = continuing(1.0);
        method.max_depth = max_depth;
        const GlossyMeans means = means_of(scene, points, method, 8);
        const GlossyMeans path = means_of(scene, points, {.integrator = "path", .max_depth = max_depth}, 64);
        if (max_depth > 2)
            agree(claims, "to three edges", means, path);
        else
            claims.means_agree("direct to two edges", means.direct, path.direct, 0.03);
    }
}

}  // namespace
}  // namespace photonlab::test
