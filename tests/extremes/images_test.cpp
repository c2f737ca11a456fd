// Images of a single pixel or a single row, and scenes without light, without a surface or without one that scatters:
// the image is right, plain as it is, and why is said.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "image/exr.h"
#include "image/metrics.h"
#include "integrators/layers.h"
#include "tests/extremes/foot_of_light.h"
#include "tests/statistical/rendering.h"
#include "transport/camera/plain_images.h"

namespace photonlab::test {
namespace {

constexpr double image_radius = 0.1;

/// Every way to make an image.
std::vector<MethodSettings> all_methods() {
    return {{.integrator = "path"},
            {.radius = image_radius, .photons_per_pass = 500},
            {.photons_per_pass = 500},  // automatic radius
            {.schedule = ScheduleName::KnausZwicker, .direct = DirectMode::Photons, .photons_per_pass = 500},
            {.integrator = "photonmapper", .photons_per_pass = 500},
            {.integrator = "photonmapper", .mode = GatherMode::Nearest, .photons_per_pass = 500},
            {.integrator = "photonmapper",
             .mode = GatherMode::Nearest,
             .max_radius = image_radius,
             .direct = DirectMode::Photons,
             .photons_per_pass = 500}};
}

SceneDescription foot_seen_by(int width, int height, double fov_x) {
    SceneDescription scene = FootOfLight{}.description();
    scene.camera.width = width;
    scene.camera.height = height;
    scene.camera.fov_x = fov_x;
    return scene;
}

/// Field of view of the middle pixel alone, of `count` across `fov_x` degrees.
double fov_of_one(double fov_x, int count) {
    return std::atan(std::tan(fov_x * pi / 360.0) / count) * 360.0 / pi;
}

void expect_pixels_agree(const Image& image, std::size_t pixel, const Image& other, std::size_t other_pixel,
                         double tolerance, const std::string& what) {
    for (const std::string_view layer : {direct_layer, gathered_layer})
        for (int c = 0; c < 3; ++c) {
            const float found = (*image.find(layer))[pixel][c];
            EXPECT_NEAR(found, (*other.find(layer))[other_pixel][c], tolerance * std::abs(found)) << what;
        }
}

TEST(ImageSize, OfOnePixelIsTheMiddleOfALargerImage) {
    for (const DirectMode direct : {DirectMode::Sampled, DirectMode::Photons})
        for (const std::string integrator : {"ppm", "photonmapper"}) {
            const MethodSettings method{
                .integrator = integrator, .radius = image_radius, .direct = direct, .photons_per_pass = 2000};
            const Image one = render(build_scene(foot_seen_by(1, 1, 10.0)), method, {.passes = 3}).image;
            const Image many = render(build_scene(foot_seen_by(33, 33, 10.0)), method, {.passes = 3}).image;
            ASSERT_EQ(one.find(direct_layer)->size(), 1u);
            EXPECT_GT(mean_total(one).x, 0.0);
            expect_pixels_agree(one, 0, many, 16 * 33 + 16, 1e-6, integrator);
        }
    // The automatic radius is of the pixel, which is 33 times as wide.
    const MethodSettings automatic{.photons_per_pass = 1};
    const Rendering one = render(build_scene(foot_seen_by(1, 1, 0.1)), automatic, {});
    const Rendering many = render(build_scene(foot_seen_by(33, 33, 0.1)), automatic, {});
    EXPECT_NEAR(one.radii[0] / many.radii[0], 33.0, 33.0 * 1e-3);
}

TEST(ImageSize, OfOneRowOrColumnIsThatOfALargerImage) {
    constexpr int side = 257;
    constexpr double fov = 20.0;
    const MethodSettings method{.radius = image_radius, .photons_per_pass = 300};
    const Image square = render(build_scene(foot_seen_by(side, side, fov)), method, {.passes = 2}).image;
    const Image row = render(build_scene(foot_seen_by(side, 1, fov)), method, {.passes = 2}).image;
    const Image column = render(build_scene(foot_seen_by(1, side, fov_of_one(fov, side))), method, {.passes = 2}).image;
    constexpr std::size_t middle = side / 2;
    for (std::size_t i = 0; i < side; i += 8) {
        expect_pixels_agree(row, i, square, middle * side + i, 2e-5, "row");
        expect_pixels_agree(column, i, square, i * side + middle, 2e-5, "column");
    }
}

TEST(ImageSize, OfOnePixelIsStoredAndJudged) {
    const auto file = std::filesystem::temp_directory_path() / "photonlab-ImageSize-one-pixel.exr";
    Image image{.width = 1, .height = 1, .layers = {}};
    for (const std::string_view layer : {emission_layer, direct_layer, gathered_layer})
        image.layers.push_back({std::string(layer), {Color(1e30f, 0.25f, 1e-30f)}});
    write_exr(file, image);
    const Image read = read_exr(file);
    std::filesystem::remove(file);
    ASSERT_EQ(read.layers.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(read.layers[i].pixels, image.layers[i].pixels);
    const ErrorMetrics errors = compare({ColorD(3.0)}, {{ColorD(1.0)}, {ColorD(0.0)}, {ColorD(2.0)}});
    EXPECT_EQ(errors.of("mse").value(), 4.0);
    EXPECT_EQ(errors.of("mse_unbiased").value(), 3.0);
    EXPECT_EQ(errors.of("bias").value(), 2.0);
    EXPECT_EQ(errors.of("reference_floor").value(), 1.0);
}

// ---------------------------------------------------------------------------------------------------------------------

/// Every method's image is black, to the bit.
void expect_black(const SceneDescription& description, const std::string& what,
                  const std::vector<MethodSettings>& methods = all_methods()) {
    const Scene scene = build_scene(description);
    for (const MethodSettings& method : methods) {
        const Rendering result = render(scene, method, {.passes = 3});
        ASSERT_EQ(result.image.layers.size(), 3u);
        for (const Layer& layer : result.image.layers)
            for (const Color& pixel : layer.pixels) EXPECT_EQ(pixel, Color(0.0f)) << what << ", " << method.integrator;
        EXPECT_EQ(result.report.photons_gathered, 0u);
        EXPECT_EQ(result.state.nonfinite_in_maps, 0u);
        for (const double radius : result.radii) EXPECT_TRUE(std::isfinite(radius)) << what;
    }
}

std::vector<std::string> reasons_of(const SceneDescription& description) {
    const Scene scene = build_scene(description);
    return why_images_are_plain(scene, trace_hit_points(scene, 1, 1));
}

const std::string no_light = "there is no light: every image of this scene is black";
const std::string no_surface = "there is no surface: every image of this scene is black";
const std::string only_specular =
    "every surface is a mirror or glass: nothing is gathered, and images show emission alone";
const std::string nothing_seen =
    "the camera sees no surface to gather at: nothing is gathered, and images show emission alone";

TEST(PlainScene, WithALightAndASurfaceIsNone) {
    EXPECT_TRUE(reasons_of(FootOfLight{}.description()).empty());
}

TEST(PlainScene, WithoutLightIsBlack) {
    SceneDescription scene = foot_seen_by(5, 4, 10.0);
    scene.lights.clear();
    expect_black(scene, "no light");
    EXPECT_EQ(reasons_of(scene), std::vector{no_light});
    // Light without power is none.
    scene.lights = {point_light(VectorD(0.0), ColorD(0.0))};
    scene.shapes[0].radiance = ColorD(0.0);
    expect_black(scene, "no power");
    EXPECT_EQ(reasons_of(scene), std::vector{no_light});
}

TEST(PlainScene, WithoutASurfaceIsBlack) {
    SceneDescription scene = foot_seen_by(5, 4, 10.0);
    scene.shapes.clear();
    expect_black(scene, "no surface");
    EXPECT_EQ(reasons_of(scene), std::vector{no_surface});
    scene.lights.clear();
    expect_black(scene, "nothing");
    EXPECT_EQ(reasons_of(scene), (std::vector{no_light, no_surface}));
    // Triangles without area are no surface that anything meets.
    scene = foot_seen_by(5, 4, 10.0);
    scene.shapes = {shape({.positions = {VectorD(0.0), VectorD(1.0), VectorD(1.0)},
                           .normals = {},
                           .texture_coordinates = {},
                           .triangles = {{0, 1, 2}}},
                          0)};
    expect_black(scene, "no area");
    EXPECT_EQ(reasons_of(scene), std::vector{nothing_seen});
}

// A point has no surface that could be seen, and nothing else shines. Paths from the camera are refused here, whatever
// they would find.
TEST(PlainScene, OfMirrorsAndGlassUnderAPointIsBlack) {
    SceneDescription scene;
    scene.materials = {{.id = "mirror", .bsdf = Conductor{}}, {.id = "glass", .bsdf = Dielectric{}}};
    scene.shapes = {sphere(VectorD(-1.0, 0.0, 0.0), 0.8, false, 0), sphere(VectorD(1.0, 0.0, 0.0), 0.8, false, 1),
                    disk(VectorD(0.0, -1.0, 0.0), VectorD(0, 1, 0), 4.0, 0)};
    scene.lights = {point_light(VectorD(0.0, 3.0, 0.0), ColorD(5.0))};
    scene.camera = look_at(VectorD(0.0, 1.0, -5.0), VectorD(0.0), 8, 8, 50.0);
    std::vector<MethodSettings> methods = all_methods();
    std::erase_if(methods, [](const MethodSettings& method) { return method.integrator == "path"; });
    expect_black(scene, "specular", methods);
    EXPECT_EQ(reasons_of(scene), std::vector{only_specular});
}

// The inside of a cube of mirrors that shine: Le (1 - rho^d) / (1 - rho) with paths of at most d edges, and without a
// limit what is missing of Le / (1 - rho) is what was cut, and said to be (docs/theory.md, section 5).
TEST(PlainScene, OfMirrorsThatShineIsTheirFurnace) {
    constexpr double radiance = 3.0;
    const Color reflectance(0.5f, 0.25f, 0.75f);
    SceneDescription description = hollow_cube(Color(0.0f), ColorD(radiance));
    description.materials = {{.id = "mirror", .bsdf = Conductor{.reflectance = reflectance}}};
    EXPECT_EQ(reasons_of(description), std::vector{only_specular});
    const Scene scene = build_scene(description);
    for (MethodSettings method : all_methods())
        for (const int depth : {1, 2, 5, 20}) {
            method.max_depth = depth;
            const Image image = render(scene, method, {.passes = 2}).image;
            for (const Color& pixel : *image.find(emission_layer))
                for (int c = 0; c < 3; ++c) {
                    const double rho = reflectance[c];
                    EXPECT_NEAR(pixel[c] * (1.0 - rho) / (radiance * (1.0 - std::pow(rho, depth))), 1.0, 1e-5)
                        << method.integrator << ", depth " << depth;
                }
            EXPECT_EQ(mean_of(image, direct_layer), ColorD(0.0));
            EXPECT_EQ(mean_of(image, gathered_layer), ColorD(0.0));
        }
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    // Every channel goes on as long as the strongest: 0.75^33 is the first below 1e-4.
    for (const ColorD& pixel : emission_image(hit_points, -1))
        for (int c = 0; c < 3; ++c) {
            const double rho = reflectance[c];
            EXPECT_NEAR(pixel[c] * (1.0 - rho) / radiance, 1.0 - std::pow(rho, 33), 1e-5);
        }
    EXPECT_NEAR(hit_points.weight_cut, std::pow(0.75, 33) / 3.0, 1e-7);
}

// A lamp that reflects nothing, and nothing beside it.
TEST(PlainScene, OfALampAloneIsTheLamp) {
    SceneDescription scene;
    scene.materials = {diffuse(Color(0.0f))};
    scene.shapes = {sphere(VectorD(0.0), 1.0, false, 0, ColorD(2.0, 1.0, 0.5))};
    scene.camera = look_at(VectorD(0.0, 0.0, -5.0), VectorD(0.0), 4, 4, 5.0);
    EXPECT_EQ(reasons_of(scene), std::vector{nothing_seen});
    for (const MethodSettings& method : all_methods()) {
        const Image image = render(build_scene(scene), method, {.passes = 2}).image;
        for (const ColorD& pixel : total(image)) EXPECT_EQ(pixel, ColorD(2.0, 1.0, 0.5)) << method.integrator;
    }
}

}  // namespace
}  // namespace photonlab::test
