// What must not change an image: threads, the unit of light, the unit of length, where the origin is, and which passes
// were looked at. No reference is needed for any of it (docs/theory.md, section 6).

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/support/radius_rules.h"

namespace photonlab::test {
namespace {

constexpr double gather_radius = 0.15;
constexpr int resolution = 24;  // more than one tile and one block of hit points; the lamp is two pixels high

std::vector<NamedMethod> methods(double unit = 1.0) {
    const double radius = gather_radius * unit;
    std::vector<NamedMethod> methods{
        {"path", {.integrator = "path"}},
        {"ppm", {.radius = radius, .direct_samples = 2, .photons_per_pass = 3000}},
        {"ppm, footprint",
         {.schedule = ScheduleName::KnausZwicker, .direct = DirectMode::Photons, .photons_per_pass = 3000}},
        {"photonmapper",
         {.integrator = "photonmapper", .radius = radius, .kernel = Kernel::Cone, .photons_per_pass = 3000}},
        {"photonmapper nearest",
         {.integrator = "photonmapper",
          .mode = GatherMode::Nearest,
          .k = 20,
          .max_radius = 2.0 * radius,
          .max_depth = 4,
          .photons_per_pass = 3000}},
        {"photonmapper nearest, default radius",
         {.integrator = "photonmapper",
          .mode = GatherMode::Nearest,
          .direct = DirectMode::Photons,
          .photons_per_pass = 3000}},
    };
    for (const NamedMethod& method : methods_by_every_radius_rule({.radius = radius, .photons_per_pass = 3000}))
        methods.push_back(method);
    for (const NamedMethod& method : methods_of_own_photons({.radius = radius, .photons_per_pass = 3000}))
        methods.push_back(method);
    return methods;
}

/// The room with a point light beside its lamp, all light times `light`, all lengths times `unit`, moved by `offset`.
SceneDescription changed_room(double light, double unit = 1.0, const VectorD& offset = VectorD(0.0)) {
    SceneDescription scene = room(resolution, resolution);
    scene.lights = {point_light(VectorD(-0.5, 0.2, -0.6), ColorD(0.5, 1.0, 2.0))};
    for (ShapeDescription& shape : scene.shapes) {
        if (shape.radiance) *shape.radiance *= light;
        for (VectorD& position : std::get<MeshDescription>(shape.geometry).positions)
            position = position * unit + offset;
    }
    for (LightDescription& light_of_scene : scene.lights) {
        auto& lamp = std::get<PointLightDescription>(light_of_scene);
        lamp.position = lamp.position * unit + offset;
        lamp.intensity *= light * unit * unit;
    }
    Matrix& camera = scene.camera.to_world;
    for (int axis = 0; axis < 3; ++axis) camera[3][axis] = camera[3][axis] * unit + offset[axis];
    return scene;
}

Image image_of(const SceneDescription& scene, const NamedMethod& method, const RenderOptions& options = {.passes = 3}) {
    return render(build_scene(scene), method.settings, options).image;
}

void expect_same_bits(const Image& expected, const Image& actual, double factor, const std::string& what) {
    for (const Layer& layer : expected.layers) {
        const std::vector<Color>& pixels = *actual.find(layer.name);
        ASSERT_EQ(pixels.size(), layer.pixels.size());
        for (std::size_t i = 0; i < pixels.size(); ++i)
            ASSERT_EQ(pixels[i], layer.pixels[i] * static_cast<float>(factor))
                << what << ", " << layer.name << ", pixel " << i;
    }
}

/// Number of pixels of the whole image that differ by more than `tolerance`, relative.
int pixels_that_differ(const Image& expected, const Image& actual, double tolerance) {
    const std::vector<ColorD> a = total(expected);
    const std::vector<ColorD> b = total(actual);
    int count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += !((a[i] - b[i]).length() <= tolerance * a[i].length());
    return count;
}

TEST(Invariance, EveryLayerHasLightInTheSceneTested) {
    for (const NamedMethod& method : methods()) {
        const Image image = image_of(changed_room(1.0), method);
        EXPECT_GT(mean_of(image, emission_layer).x, 0.0) << method.name;
        EXPECT_GT(mean_of(image, gathered_layer).x, 0.0) << method.name;
        EXPECT_EQ(mean_of(image, direct_layer).x > 0.0, method.settings.direct == DirectMode::Sampled) << method.name;
    }
}

TEST(Invariance, AnyNumberOfThreadsGivesTheSameBits) {
    for (const NamedMethod& method : methods()) {
        const Image one = image_of(changed_room(1.0), method, {.passes = 3, .threads = 1, .samples_per_pixel = 4});
        for (const int threads : {2, 5})
            expect_same_bits(
                one, image_of(changed_room(1.0), method, {.passes = 3, .threads = threads, .samples_per_pixel = 4}),
                1.0, method.name + ", threads " + std::to_string(threads));
    }
}

TEST(Invariance, LightTimesAPowerOfTwoIsTheImageTimesIt) {
    for (const NamedMethod& method : methods()) {
        const Image image = image_of(changed_room(1.0), method);
        for (const int exponent : {1, -3, -100, 90})
            expect_same_bits(image, image_of(changed_room(std::ldexp(1.0, exponent)), method),
                             std::ldexp(1.0, exponent), method.name + ", 2^" + std::to_string(exponent));
    }
}

TEST(Invariance, LightTimesAnyFactorIsTheImageTimesItToRounding) {
    for (const NamedMethod& method : methods()) {
        const Image image = image_of(changed_room(1.0), method);
        for (const double factor : {3.0, 1e-30, 1e30}) {
            Image scaled = image_of(changed_room(factor), method);
            for (Layer& layer : scaled.layers)
                for (Color& pixel : layer.pixels) pixel = Color(ColorD(pixel) / factor);
            EXPECT_EQ(pixels_that_differ(image, scaled, 1e-6), 0) << method.name << " times " << factor;
        }
    }
}

TEST(Invariance, SceneScaledByAPowerOfTwoHasTheSameBits) {
    const std::vector<NamedMethod> original = methods();
    for (const int exponent : {1, -7, 30, -30}) {
        const double unit = std::ldexp(1.0, exponent);
        const std::vector<NamedMethod> scaled = methods(unit);
        for (std::size_t i = 0; i < original.size(); ++i)
            expect_same_bits(image_of(changed_room(1.0), original[i]), image_of(changed_room(1.0, unit), scaled[i]),
                             1.0, original[i].name + ", 2^" + std::to_string(exponent));
    }
}

// Another unit or origin changes a coordinate in the unit box by at most its last bit, 6e-8, which a few bounces make
// 1e-6: of the photons within a radius of 0.15 units, 1e-6 / 0.04 of the box, some 5e-5 cross the rim, and the image's
// 576 pixels gather about 1e5 photons in all. So about five pixels may gain or lose a photon, and as many paths of the
// path tracer may take another side of an edge; the rest agrees to rounding.
// Where photons are a method's own, one of them makes all later paths others.
constexpr int pixels_allowed = 10;
constexpr double rounding = 2e-4;

std::vector<NamedMethod> methods_of_shared_photons(double unit = 1.0) {
    std::vector<NamedMethod> shared = methods(unit);
    std::erase_if(shared, [](const NamedMethod& method) { return needs_of(method.settings).has_own_photons; });
    return shared;
}

TEST(Invariance, SceneInAnotherUnitGivesTheSameImage) {
    const std::vector<NamedMethod> original = methods_of_shared_photons();
    for (const double unit : {1e-4, 1e4, 1e-9, 1e12}) {
        const std::vector<NamedMethod> scaled = methods_of_shared_photons(unit);
        for (std::size_t i = 0; i < original.size(); ++i)
            EXPECT_LE(pixels_that_differ(image_of(changed_room(1.0), original[i]),
                                         image_of(changed_room(1.0, unit), scaled[i]), rounding),
                      pixels_allowed)
                << original[i].name << ", unit " << unit;
    }
}

TEST(Invariance, SceneMovedGivesTheSameImage) {
    for (const NamedMethod& method : methods_of_shared_photons()) {
        const Image image = image_of(changed_room(1.0), method);
        for (const VectorD& offset : {VectorD(0.1, -0.2, 0.3), VectorD(1e5, -3e4, 2e5)})
            EXPECT_LE(pixels_that_differ(image, image_of(changed_room(1.0, 1.0, offset), method), rounding),
                      pixels_allowed)
                << method.name << ", by " << offset.x;
    }
}

TEST(Invariance, PassesLookedAtDoNotChangeTheLast) {
    for (const NamedMethod& method : methods())
        expect_same_bits(image_of(changed_room(1.0), method, {.passes = 5}),
                         image_of(changed_room(1.0), method, {.passes = 5, .show_every_pass = true}), 1.0, method.name);
}

TEST(Invariance, LookingBeforeTheFirstPassShowsEmissionAndDirectLightAndChangesNothing) {
    const Scene scene = build_scene(changed_room(1.0));
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    for (const NamedMethod& method : methods()) {
        PassLoop run = loop_of(method.settings, scene, hit_points);
        const Image before = run.image();
        EXPECT_EQ(mean_of(before, gathered_layer), ColorD(0.0)) << method.name;
        EXPECT_EQ(mean_of(before, direct_layer).x > 0.0, method.settings.direct == DirectMode::Sampled) << method.name;
        for (std::uint64_t pass = 1; pass <= 2; ++pass)
            if (run.needs(0).has_own_photons)
                run.take(pass);
            else
                run.take(pass, trace_photons(scene, photon_settings(method.settings, 1), pass, 1));
        expect_same_bits(render(scene, hit_points, method.settings, {.passes = 2}).image, run.image(), 1.0,
                         method.name);
    }
}

// Where a pixel has several hit points, since glass divides what it sees.
TEST(Invariance, PathsShowTheSameBeforeTheirFirstPassWhereverTheyWillBegin) {
    SceneDescription description = room(resolution, resolution);
    description.materials.push_back({.id = "glass", .bsdf = Dielectric{}});
    const std::size_t glass = description.materials.size() - 1;
    description.shapes.push_back(sphere(VectorD(-0.3, 0.0, 0.0), 0.4, false, glass));
    const Scene scene = build_scene(description);
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    ASSERT_GT(hit_points.points.size(), pixel_count(hit_points) + 20);
    const MethodSettings grid{.integrator = "path"};
    MethodSettings box = grid;
    box.positions = Positions::Box;
    expect_same_bits(loop_of(grid, scene, hit_points).image(), loop_of(box, scene, hit_points).image(), 1.0, "box");
}

TEST(Invariance, DarknessIsBlackAndFinite) {
    SceneDescription no_light = room(resolution, resolution);
    for (ShapeDescription& shape : no_light.shapes) shape.radiance.reset();
    SceneDescription no_surface;
    no_surface.lights = {point_light(VectorD(0.0), ColorD(1.0))};
    no_surface.camera = look_at(VectorD(0, 0, -1), VectorD(0.0), 4, 4);
    SceneDescription nothing;
    nothing.camera = no_surface.camera;
    for (const SceneDescription& scene : {no_light, no_surface, nothing})
        for (const NamedMethod& method : methods())
            for (const ColorD& pixel : total(image_of(scene, method))) ASSERT_EQ(pixel, ColorD(0.0)) << method.name;
}

}  // namespace
}  // namespace photonlab::test
