// Rough and layered materials under light from everywhere, by every method: what they reflect of a uniform surround is
// known, and a slab of rough glass, thinner than the gather radius, must not gather on its far face.
//
// A flat disk in a surround of radiance 1 has radiance A, the share of it that comes back along the camera's ray, in
// all its layers together: single directions see the surround (emission), what is spread is direct light. A is the
// integral of f cos over all directions by the midpoint rule, and the weights of the single directions. The camera is
// so far away that all its pixels see the disk at the same angle to within a degree.

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"
#include "tests/support/layered.h"

namespace photonlab::test {
namespace {

constexpr std::uint64_t material_seeds = 16;
constexpr double disk_radius = 5.0;
constexpr double material_radius = 0.4;

SceneDescription in_a_surround(const Material& material, double degrees) {
    SceneDescription scene;
    scene.materials = {material};
    scene.shapes = {disk(VectorD(0.0), VectorD(0, 0, 1), disk_radius, 0)};
    scene.lights = {ConstantDescription{.radiance = ColorD(1.0), .place = "test"}};
    const double angle = degrees * pi / 180.0;
    scene.camera = look_at(VectorD(std::sin(angle), 0.0, std::cos(angle)) * 90.0, VectorD(0.0), 8, 8, 1.6);
    return scene;
}

double reflected_share(const Material& material, double degrees) {
    const double angle = degrees * pi / 180.0;
    const Vector outgoing(Vector(VectorD(std::sin(angle), 0.0, std::cos(angle))));
    const Bsdf bsdf = bsdf_at(material, {0, 0}, false);
    double sum = 0.0;
    for (const SpecularBranch& branch : specular_branches(bsdf, outgoing, Carried::Radiance)) sum += branch.weight.y;
    constexpr int steps = 1000;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double z = -1.0 + 2.0 * (i + 0.5) / steps;
            const double azimuth = 2.0 * pi * (j + 0.5) / steps;
            const double sine = std::sqrt(1.0 - z * z);
            const Vector incoming(VectorD(sine * std::cos(azimuth), sine * std::sin(azimuth), z));
            sum += evaluate(bsdf, outgoing, incoming).y * std::abs(z) * 4.0 * pi / (static_cast<double>(steps) * steps);
        }
    return sum;
}

struct Case {
    std::string name;
    Material material;
};

std::vector<Case> cases() {
    const Microfacets ggx{FacetSlopes::Ggx, 0.4f};
    const Microfacets beckmann{FacetSlopes::Beckmann, 0.3f};
    const Material metal{.id = "metal", .bsdf = RoughConductor{.facets = ggx, .eta = Color(0.2f), .k = Color(3.9f)}};
    return {{"rough metal", metal},
            {"rough plastic", rough_plastic(beckmann, Color(0.5f))},
            {"plastic", {.id = "plastic", .bsdf = plastic_of(Color(0.5f))}},
            {"rough glass", {.id = "glass", .bsdf = RoughDielectric{.facets = beckmann}}},
            {"inside of rough glass", {.id = "glass", .bsdf = RoughDielectric{.facets = ggx}.turned_over()}},
            {"phong", {.id = "phong", .bsdf = Phong{.exponent = 10.0f}}},
            {"rough diffuse", {.id = "cloth", .bsdf = RoughDiffuse{.alpha = 0.4f}}},
            {"coated grey", coated(grey, Color(0.2f))},
            {"masked grey", masked(grey, Color(0.6f))},
            {"blend", blended(grey, metal, 0.4f)}};
}

std::vector<double> totals(const Scene& scene, const MethodSettings& method, std::uint64_t passes) {
    std::vector<double> values;
    for (std::uint64_t seed = 1; seed <= material_seeds; ++seed)
        values.push_back(mean_total(render(scene, method, {.passes = passes, .seed = seed}).image).y);
    return values;
}

TEST(UniformSurround, IsReflectedByItsShare) {
    ClaimFamily claims;
    for (const Case& tried : cases())
        for (const double degrees : {20.0, 65.0}) {
            const std::string what = tried.name + " at " + std::to_string(degrees) + " by ";
            const Scene scene = build_scene(in_a_surround(tried.material, degrees));
            const double expected = reflected_share(tried.material, degrees);
            claims.mean_is(what + "path", totals(scene, {.integrator = "path"}, 100), expected, 0.02);
            claims.mean_is(what + "ppm", totals(scene, {.radius = material_radius, .photons_per_pass = 10}, 200),
                           expected, 0.05);
            claims.mean_is(
                what + "ppm with photons",
                totals(scene, {.radius = material_radius, .direct = DirectMode::Photons, .photons_per_pass = 20'000},
                       4),
                expected, 0.05);
            claims.mean_is(what + "photonmapper",
                           totals(scene,
                                  {.integrator = "photonmapper",
                                   .radius = material_radius,
                                   .caustic_radius = material_radius,
                                   .direct = DirectMode::Photons,
                                   .photons_per_pass = 60'000},
                                  1),
                           expected, 0.05);
        }
}

// Seen from above, all of the slab's far face lies within the gather radius. What arrives there from below lies on the
// side on which what the near face lets through would lie.
TEST(ThinSlabOfRoughGlass, GathersOnlyWhatItsNearFaceLetsThrough) {
    SceneDescription description;
    const Microfacets facets{FacetSlopes::Beckmann, 0.5f};
    description.materials = {{.id = "glass", .bsdf = RoughDielectric{.facets = facets}}, diffuse(Color(0.5f))};
    const double thickness = 0.02;
    description.shapes = {disk(VectorD(0.0), VectorD(0, 0, 1), disk_radius, 0),
                          disk(VectorD(0, 0, -thickness), VectorD(0, 0, -1), disk_radius, 0),
                          disk(VectorD(0, 0, -2.0), VectorD(0, 0, 1), 10.0, 1)};
    description.lights = {ConstantDescription{.radiance = ColorD(1.0), .place = "test"}};
    description.camera = look_at(VectorD(2, 1, 8), VectorD(0.0), 12, 12, 12.0);
    const Scene scene = build_scene(description);
    ClaimFamily claims;
    const std::vector<double> path = totals(scene, {.integrator = "path"}, 100);
    claims.means_agree("ppm", totals(scene, {.radius = 0.2, .direct_samples = 4, .photons_per_pass = 100'000}, 20),
                       path, 0.03, 0.01);
}

/// Means of both layers over the image, by seed.
struct LayerMeans {
    std::vector<double> direct, gathered;
};

LayerMeans layer_means(const Scene& scene, const HitPoints& points, const MethodSettings& method,
                       std::uint64_t passes) {
    LayerMeans means;
    for (std::uint64_t seed = 1; seed <= material_seeds; ++seed) {
        const Image image = render(scene, points, method, {.passes = passes, .seed = seed}).image;
        means.direct.push_back(mean_of(image, direct_layer).y);
        means.gathered.push_back(mean_of(image, gathered_layer).y);
    }
    return means;
}

// A room with a ball of each material, lit by its lamp: whole layers of PPM against path tracing. The radius is small
// beside the balls; a tenth of the image lies within it of an edge, where it is wrong by half at most: 1.5% are
// allowed.
TEST(RoomOfRoughAndLayeredBalls, IsTheSameByPhotonsAndByPaths) {
    SceneDescription description = room(40, 40);
    const std::vector<Case> tried = cases();
    for (std::size_t i = 0; i < 9; ++i) {
        Material material = tried[i].material;
        if (tried[i].name == "inside of rough glass") material.bsdf = Conductor{.reflectance = Color(0.9f)};
        description.materials.push_back(material);
        description.shapes.push_back(
            sphere(VectorD(-0.7 + 0.35 * static_cast<double>(i % 3), -0.8 + 0.55 * static_cast<double>(i / 3), 0.5),
                   0.16, false, description.materials.size() - 1));
    }
    const Scene scene = build_scene(description);
    const HitPoints points = trace_hit_points(scene, 1, 1);
    ClaimFamily claims;
    const LayerMeans path = layer_means(scene, points, {.integrator = "path"}, 64);
    const LayerMeans ppm =
        layer_means(scene, points, {.radius = 0.02, .direct_samples = 4, .photons_per_pass = 20'000}, 16);
    claims.means_agree("direct", ppm.direct, path.direct, 0.01);
    claims.means_agree("gathered", ppm.gathered, path.gathered, 0.01, 0.015);
}

// One point of a floor that is brushed at 30 degrees to the axes, lit so that its facets must lean along u, where they
// do: f of the directions in the frame of u, times cosine and intensity over the squared distance. Along v it would be
// a hundredth. Photons within 0.15 of the point arrive from directions that change f by 0.3%.
TEST(BrushedFloor, ShinesAlongUByEveryWayOfGathering) {
    const RoughConductor metal{.facets = {FacetSlopes::Beckmann, 0.6f, 0.2f}};
    const VectorD along_u(std::cos(pi / 6.0), 0.0, -std::sin(pi / 6.0));
    const VectorD along_v = VectorD(0, 1, 0).cross(along_u);
    const VectorD light = along_u * 3.6 + VectorD(0, 4, 0);
    const VectorD eye = along_u * 0.6 + VectorD(0, 3, 0);
    SceneDescription description;
    description.materials = {anisotropic(metal)};
    MeshDescription floor = parallelogram((along_u + along_v) * -10.0, along_u * 20.0, along_v * 20.0);
    floor.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    description.shapes = {shape(floor, 0)};
    description.lights = {point_light(light, ColorD(100.0))};
    description.camera = look_at(eye, VectorD(0.0));
    const Scene scene = build_scene(description);
    const auto local = [&](const VectorD& v) {
        const VectorD unit = v.normalized();
        return Vector(VectorD(unit.dot(along_u), unit.dot(along_v), unit.y));
    };
    const double f = evaluate(Bsdf(metal), local(eye), local(light)).y;
    const double expected = f * 100.0 * light.normalized().y / light.length2();
    ClaimFamily claims;
    claims.mean_is("path", totals(scene, {.integrator = "path"}, 1), expected, 1e-4);
    claims.mean_is("ppm", totals(scene, {.radius = 0.15, .photons_per_pass = 10}, 1), expected, 1e-4);
    claims.mean_is("ppm with photons",
                   totals(scene, {.radius = 0.15, .direct = DirectMode::Photons, .photons_per_pass = 100'000}, 8),
                   expected, 0.1, 0.003);
}

/// Balls and a plate of metal and glass that are brushed, and a coat over such metal.
SceneDescription room_of_brushed_things() {
    SceneDescription description = room(40, 40);
    const RoughConductor metal{.facets = {FacetSlopes::Ggx, 0.6f, 0.12f}, .eta = Color(0.2f), .k = Color(3.9f)};
    const RoughDielectric glass{.facets = {FacetSlopes::Beckmann, 0.15f, 0.5f}};
    Material coat = coated(anisotropic(metal), Color(0.2f));
    coat.is_anisotropic = true;
    for (const Material& material : {anisotropic(metal), anisotropic(glass), coat}) {
        const auto i = static_cast<double>(description.materials.size() - 5);
        description.materials.push_back(material);
        description.shapes.push_back(
            sphere(VectorD(-0.6 + 0.5 * i, -0.6, 0.3), 0.3, false, description.materials.size() - 1));
    }
    MeshDescription plate = parallelogram(VectorD(-0.8, -0.1, 0.9), VectorD(0.4, 0.8, 0), VectorD(0.8, -0.2, 0));
    plate.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    description.shapes.push_back(shape(plate, 5));
    return description;
}

// A frame that a hit point lost, or that light and view see differently, changes what is gathered: on these things the
// lobe is five times as long as it is wide.
TEST(RoomOfBrushedThings, IsTheSameByPhotonsAndByPaths) {
    const Scene scene = build_scene(room_of_brushed_things());
    const HitPoints points = trace_hit_points(scene, 1, 1);
    ClaimFamily claims;
    const LayerMeans path = layer_means(scene, points, {.integrator = "path"}, 128);
    const LayerMeans ppm =
        layer_means(scene, points, {.radius = 0.02, .direct_samples = 4, .photons_per_pass = 20'000}, 24);
    claims.means_agree("direct", ppm.direct, path.direct, 0.01);
    claims.means_agree("gathered", ppm.gathered, path.gathered, 0.01, 0.015);
}

}  // namespace
}  // namespace photonlab::test
