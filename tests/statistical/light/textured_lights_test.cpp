// Lights whose radiance is a texture, by every method: the light on a floor is the integral of radiance over them, a
// light that is black on one half is one of half the size, and the camera sees the texture itself.

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

constexpr double height = 1.5;
constexpr double radius = 0.15;
const Color floor_colour(0.6f, 0.5f, 0.7f);

std::shared_ptr<const Texture> nearest_image(int width, int rows, const std::vector<Color>& pixels) {
    return std::make_shared<const Texture>(
        Bitmap{.image = std::make_shared<const ColorImage>(ColorImage{width, rows, pixels}),
               .to_uv = Matrix(),
               .file = "a.exr",
               .is_nearest = true});
}

/// A lamp from (x, height, z) over 2 x 2, or what `along_x` makes of it, that faces down: u along x, v along z.
ShapeDescription lamp(double x, double z, double along_x, const ColorD& radiance,
                      std::shared_ptr<const Texture> texture = nullptr) {
    MeshDescription mesh = parallelogram(VectorD(x, height, z), VectorD(along_x, 0, 0), VectorD(0, 0, 2));
    mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    ShapeDescription described = shape(std::move(mesh), 1, radiance);
    described.radiance_texture = std::move(texture);
    return described;
}

SceneDescription floor_under(const ShapeDescription& light) {
    SceneDescription scene = floor_seen_at_origin(floor_colour, 20.0);
    scene.shapes.push_back(light);
    scene.camera = look_at(VectorD(0.6, 0.5, 0.3), VectorD(0.0));
    return scene;
}

/// Irradiance at (x, 0, z) from the lamp from (-1, height, -1), whose radiance is a function of u and v.
template <typename Radiance>
ColorD irradiance(double x, double z, int steps, const Radiance& radiance) {
    ColorD sum(0.0);
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double u = (i + 0.5) / steps, v = (j + 0.5) / steps;
            const VectorD to_light(2.0 * u - 1.0 - x, height, 2.0 * v - 1.0 - z);
            const double squared_distance = to_light.length2();
            sum += radiance(u, v) * (height * height / (squared_distance * squared_distance));
        }
    return sum * (4.0 / (static_cast<double>(steps) * steps));
}

/// Mean over a disc of the floor around the origin, which is what photons in it see.
template <typename Radiance>
ColorD irradiance_of_disc(double disc, const Radiance& radiance) {
    constexpr int rings = 4, around = 12;
    ColorD sum(0.0);
    for (int ring = 0; ring < rings; ++ring)
        for (int i = 0; i < around; ++i) {
            const double distance = disc * std::sqrt((ring + 0.5) / rings), angle = 2.0 * pi * (i + 0.5) / around;
            sum += irradiance(distance * std::cos(angle), distance * std::sin(angle), 120, radiance);
        }
    return sum / (rings * around);
}

/// A method, the layer that has the light on the floor, the radius over which it is smeared, and the passes that show
/// it.
struct Way {
    std::string what;
    MethodSettings method;
    std::string_view layer;
    double disc;
    std::uint64_t passes = 6;
};

std::vector<Way> ways() {
    const MethodSettings photons{
        .integrator = "photonmapper", .radius = radius, .direct = DirectMode::Photons, .photons_per_pass = 20'000};
    const auto with = [&](const auto& change) {
        MethodSettings method = photons;
        change(method);
        return method;
    };
    const auto ppm = [](MethodSettings& method) {
        method.integrator = "ppm";
        method.alpha = 1.0;
    };
    return {
        {"path", {.integrator = "path"}, direct_layer, 0.0, 1000},
        {"sampled",
         {.integrator = "photonmapper", .radius = radius, .direct_samples = 4, .photons_per_pass = 1},
         direct_layer,
         0.0,
         1000},
        {"photonmapper", photons, gathered_layer, radius},
        {"ppm", with(ppm), gathered_layer, radius},
        {"sppm", with([&](MethodSettings& method) {
             ppm(method);
             method.integrator = "sppm";
         }),
         gathered_layer, radius},
        {"learnt emission", with([&](MethodSettings& method) {
             ppm(method);
             method.emission = EmissionMode::Adaptive;
             method.learn_passes = 4;
         }),
         gathered_layer, radius},
        {"visible paths", with([&](MethodSettings& method) {
             ppm(method);
             method.photon_paths = PhotonPathMode::Visible;
             method.photons_per_pass = 4000;
         }),
         gathered_layer, radius, 60},
        {"sobol", with([](MethodSettings& method) { method.light_sequence = LightSequenceMode::Sobol; }),
         gathered_layer, radius},
    };
}

std::array<std::vector<double>, 3> radiances(const Scene& scene, const Way& way, std::uint64_t first_seed,
                                             std::uint64_t seeds) {
    std::array<std::vector<double>, 3> values;
    for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
        const Rendering result = render(scene, way.method, {.passes = way.passes, .seed = seed});
        for (int c = 0; c < 3; ++c) values[static_cast<std::size_t>(c)].push_back(mean_of(result.image, way.layer)[c]);
    }
    return values;
}

TEST(TexturedLights, OfACheckerboardLightAFloorAsTheirIntegralByEveryMethod) {
    const Color first(3.0f, 0.5f, 9.0f), second(0.5f, 2.0f, 0.0f);
    Matrix to_uv;
    to_uv[0][0] = to_uv[1][1] = 1.5;  // three squares by three: not alike in all corners
    const auto board = std::make_shared<const Texture>(Checkerboard{first, second, to_uv});
    const auto radiance = [&](double u, double v) {
        const bool is_alike = (std::fmod(1.5 * u, 1.0) > 0.5) == (std::fmod(1.5 * v, 1.0) > 0.5);
        return ColorD(is_alike ? first : second);
    };
    const Scene scene = build_scene(floor_under(lamp(-1.0, -1.0, 2.0, ColorD(1.0), board)));
    ClaimFamily claims;
    for (const Way& way : ways()) {
        const auto values = radiances(scene, way, 1, 12);
        const ColorD expected =
            (way.disc > 0.0 ? irradiance_of_disc(way.disc, radiance) : irradiance(0.0, 0.0, 900, radiance)) *
            ColorD(floor_colour) / pi;
        for (int c = 0; c < 3; ++c)
            claims.mean_is(way.what + ", channel " + std::to_string(c), values[static_cast<std::size_t>(c)],
                           expected[c], 0.04, 2e-3);
    }
}

// The bright half is where x is below 0, or in another scene where it is above: a lamp there of half the size. Seen
// from a point to one side, so that one half for the other shows.
TEST(TexturedLights, ThatAreHalfBlackAreHalfTheSize) {
    const ColorD bright(4.0, 1.0, 2.0);
    ClaimFamily claims;
    for (const bool is_left : {true, false}) {
        const Color white(1.0f), black(0.0f);
        const auto image = nearest_image(2, 1, {is_left ? white : black, is_left ? black : white});
        // Shifted, so that the halves light the origin differently.
        const Scene textured = build_scene(floor_under(lamp(-0.5, -1.0, 2.0, bright, image)));
        const Scene plain = build_scene(floor_under(lamp(is_left ? -0.5 : 0.5, -1.0, 1.0, bright)));
        EXPECT_NEAR(textured.total_power * textured.unit_length * textured.unit_length,
                    plain.total_power * plain.unit_length * plain.unit_length, 1e-5 * textured.total_power);
        for (const Way& way : ways()) {
            if (way.what != "path" && way.what != "sampled" && way.what != "photonmapper" && way.what != "ppm")
                continue;
            const auto values = radiances(textured, way, 1, 8);
            const auto expected = radiances(plain, way, 101, 8);
            for (int c = 0; c < 3; ++c)
                claims.means_agree(way.what + (is_left ? ", left" : ", right"), values[static_cast<std::size_t>(c)],
                                   expected[static_cast<std::size_t>(c)], 0.05);
        }
    }
}

// The layer of emission is the texture, pixel by pixel, whichever method makes the picture.
TEST(TexturedLights, MeetTheCameraAsTheyAre) {
    std::vector<Color> pixels;
    for (int i = 0; i < 12; ++i)
        pixels.emplace_back(static_cast<float>(i) * 10.0f, 1.0f / static_cast<float>(i + 1), i % 2 == 0 ? 0.0f : 3.0f);
    SceneDescription description = floor_under(lamp(-1.0, -1.0, 2.0, ColorD(2.0), nearest_image(4, 3, pixels)));
    // From below, x to the right: the camera's up is +z, so that v runs from below to above. All of the lamp and no
    // more.
    CameraDescription camera;
    camera.to_world = Matrix(-1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0.5, 0, 1);
    camera.fov_x = 90.0;
    camera.width = 4;
    camera.height = 4;
    description.camera = camera;
    const Scene scene = build_scene(description);
    for (const std::string integrator : {"path", "ppm", "sppm", "photonmapper"}) {
        const Image image = render(scene, {.integrator = integrator, .photons_per_pass = 100}, {.passes = 2}).image;
        const std::vector<Color>& seen = *image.find(emission_layer);
        for (int y = 0; y < 4; ++y)
            for (int x = 0; x < 4; ++x) {
                const Imath::V2f uv((static_cast<float>(x) + 0.5f) / 4.0f,
                                    1.0f - (static_cast<float>(y) + 0.5f) / 4.0f);
                const Color expected =
                    pixels[static_cast<std::size_t>(static_cast<int>(uv.y * 3.0f) * 4 + static_cast<int>(uv.x * 4.0f))];
                EXPECT_EQ(seen[static_cast<std::size_t>(4 * y + x)], expected * 2.0f) << integrator << x << " " << y;
            }
    }
}

}  // namespace
}  // namespace photonlab::test
