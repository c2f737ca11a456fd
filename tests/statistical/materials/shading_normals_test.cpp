// Interpolated normals that differ from the surface's own make a BSDF's adjoint another function, so photons need
// factors that camera paths do not: one at each reflection and one at the gather (docs/theory.md, section 5; Veach
// 1996). Flat walls whose vertex normals all lean the same way show either factor missing.

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

/// Gives every mesh normals that lean by `angle` from its own towards its first edge.
void lean_normals(SceneDescription& scene, double angle) {
    for (ShapeDescription& shape : scene.shapes) {
        auto& mesh = std::get<MeshDescription>(shape.geometry);
        const VectorD first = (mesh.positions[1] - mesh.positions[0]).normalized();
        const VectorD second = (mesh.positions[3] - mesh.positions[0]).normalized();
        mesh.normals.assign(4, first.cross(second) * std::cos(angle) + first * std::sin(angle));
    }
}

/// A floor seen at (0, 0, 0) below a point light at that height.
constexpr double light_height = 2.0;
SceneDescription floor_below_light(MeshDescription floor) {
    SceneDescription description;
    description.materials = {diffuse(Color(0.6f))};
    description.shapes = {shape(std::move(floor), 0)};
    description.lights = {point_light(VectorD(0.0, light_height, 0.0), ColorD(1.0))};
    description.camera = look_at(VectorD(1.0, 2.0, 0.5), VectorD(0.0));
    return description;
}

MeshDescription ten_by_ten() {
    return parallelogram(VectorD(-5, 0, -5), VectorD(0, 0, 10), VectorD(10, 0, 0));
}

/// Its direct light, by shadow rays and by photons, where the normal at the origin leans by `lean`.
void expect_light_of_leaning_normal(const SceneDescription& description, double lean) {
    constexpr double radius = 0.4;
    const Scene scene = build_scene(description);
    EXPECT_NEAR(mean_of(render(scene, {.photons_per_pass = 1}, {}).image, direct_layer).x,
                0.6 / pi * std::cos(lean) / (light_height * light_height), 1e-6);
    std::vector<double> radiance;
    for (std::uint64_t seed = 1; seed <= 32; ++seed)
        radiance.push_back(
            mean_of(render(scene,
                           {.alpha = 1.0, .radius = radius, .direct = DirectMode::Photons, .photons_per_pass = 60'000},
                           {.seed = seed})
                        .image,
                    gathered_layer)
                .x);
    const double q = std::hypot(light_height, radius);
    ClaimFamily claims;
    claims.mean_is("photons", radiance, 0.6 / pi * std::cos(lean) * 2.0 / (q * (q + light_height)), 0.01);
}

// With light from straight above at height h the shaded floor reflects rho / pi I cos(lean) / h^2: photons land with
// the density of the true floor and are weighted by the ratio of cosines. Over the disc that ratio is cos(lean) +
// sin(lean) x / h, whose second term averages to nothing.
TEST(ShadingNormals, GatheredDirectLightIsThatOfTheShadingNormal) {
    constexpr double lean = 0.6;
    SceneDescription description = floor_below_light(ten_by_ten());
    lean_normals(description, lean);
    expect_light_of_leaning_normal(description, lean);
}

// Many reflections between walls whose normals all lean. The irradiance varies over the cube's half width 1: with a
// radius of 0.1 its bias stays below 10 r^2 / 8, a hundredth, which is allowed for; each factor changes more than that.
TEST(ShadingNormals, PhotonsAndCameraPathsAgreeAfterReflections) {
    SceneDescription description = hollow_cube(Color(0.7f), std::nullopt);
    lean_normals(description, 0.6);
    description.lights = {point_light(VectorD(0.3, 0.4, -0.5), ColorD(1.0))};
    const Scene scene = build_scene(description);
    std::vector<double> paths;
    std::vector<double> photons;
    for (std::uint64_t seed = 1; seed <= 32; ++seed) {
        paths.push_back(
            mean_of(render(scene, {.integrator = "path"}, {.passes = 800, .seed = seed}).image, gathered_layer).x);
        photons.push_back(
            mean_of(render(scene, {.radius = 0.1, .photons_per_pass = 20'000}, {.passes = 4, .seed = seed}).image,
                    gathered_layer)
                .x);
    }
    ClaimFamily claims;
    claims.means_agree("photons and paths", photons, paths, 0.015, 0.01);
}

/// Squares of 0.025 scene units, of a surface whose texture coordinates run over ten, in turn with normals that lean by
/// `angle` to either side. The origin, at (1/2, 1/2), is in the middle of one.
NormalTexture leaning_squares(double angle) {
    const auto color = [](double x, double z) {
        return Color(Imath::Color3<double>(0.5 + 0.5 * x, 0.5, 0.5 + 0.5 * z));
    };
    Checkerboard board{.first = color(std::sin(angle), std::cos(angle)),
                       .second = color(-std::sin(angle), std::cos(angle))};
    board.to_uv.setScale(VectorD(200.0, 200.0, 1.0));
    board.to_uv[3][0] = board.to_uv[3][1] = 0.25;
    return {std::make_shared<const Texture>(board), false, 1.0};
}

MeshDescription with_texture_coordinates(MeshDescription mesh) {
    mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    return mesh;
}

// The same floor, flat, with a texture whose normals lean by 35 degrees to either side within a sixteenth of the radius
// of each other: photons count by the normal of the point that gathers, and neighbouring squares, 70 degrees apart, do
// not refuse each other's.
TEST(ShadingNormals, ThatATextureTurnsWithinTheRadiusAreThoseOfThePoint) {
    const double lean = 35.0 * pi / 180.0;
    SceneDescription description = floor_below_light(with_texture_coordinates(ten_by_ten()));
    description.materials[0].normals = leaning_squares(lean);
    expect_light_of_leaning_normal(description, lean);
}

// The cube of many reflections, with such squares on all of its walls.
TEST(ShadingNormals, ThatATextureTurnsAreTheSameForPhotonsAndCameraPaths) {
    SceneDescription description = hollow_cube(Color(0.7f), std::nullopt);
    for (ShapeDescription& wall : description.shapes)
        wall.geometry = with_texture_coordinates(std::get<MeshDescription>(wall.geometry));
    description.materials[0].normals = leaning_squares(35.0 * pi / 180.0);
    description.lights = {point_light(VectorD(0.3, 0.4, -0.5), ColorD(1.0))};
    const Scene scene = build_scene(description);
    std::vector<double> paths;
    std::vector<double> photons;
    for (std::uint64_t seed = 1; seed <= 32; ++seed) {
        paths.push_back(
            mean_of(render(scene, {.integrator = "path"}, {.passes = 1200, .seed = seed}).image, gathered_layer).x);
        photons.push_back(
            mean_of(render(scene, {.radius = 0.1, .photons_per_pass = 20'000}, {.passes = 10, .seed = seed}).image,
                    gathered_layer)
                .x);
    }
    ClaimFamily claims;
    claims.means_agree("photons and paths", photons, paths, 0.02, 0.01);
}

}  // namespace
}  // namespace photonlab::test
