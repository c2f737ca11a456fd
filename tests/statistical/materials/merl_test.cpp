// Images of measured materials, whose tables come from formulas: against those formulas where the light is known, and
// path tracing against photon methods where it is not.

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"
#include "tests/support/merl_numbers.h"

namespace photonlab::test {
namespace {

const Formula& shiny() {
    static const Formula formula = shiny_formula({0.25, 0.12, 0.05}, 1.0, 20.0);
    return formula;
}
const Material& shiny_material() {
    static const Material material = measured(shiny());
    return material;
}

// A ball under one point of light: a pixel is f(outgoing, incoming) cos I / d^2, without noise. Between a bin's middle
// and its edge f is off by some per cent, up and down alike, so the mean is near; each pixel is within a bin of it.
TEST(MeasuredBall, UnderAPointOfLightLooksAsItsFormulaDoes) {
    SceneDescription description;
    description.materials = {shiny_material()};
    description.shapes = {sphere(VectorD(0.0), 2.0, false, 0)};
    const VectorD light(5.0, 6.0, 7.0);
    description.lights = {point_light(light, ColorD(100.0, 50.0, 25.0))};
    description.camera = look_at({3.0, 1.0, 8.0}, {0.0, 0.0, 0.0}, 48, 48, 20.0);
    const Scene scene = build_scene(description);
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);

    std::vector<ColorD> expected(pixel_count(hit_points), ColorD(0.0));
    for (const HitPoint& point : hit_points.points) {
        const VectorD normal(point.normal);
        const VectorD to_light = light - (VectorD(point.position) * scene.unit_length + scene.centre);
        const VectorD incoming = to_light.normalized();
        if (incoming.dot(normal) < 0.05 || VectorD(point.outgoing).dot(normal) < 0.05) continue;
        // Directions in a frame with the normal along z: the angle around it does not matter.
        const VectorD tangent = normal.cross(VectorD(0.3, 0.4, -0.5)).normalized();
        const VectorD bitangent = normal.cross(tangent);
        const auto local = [&](const VectorD& v) { return VectorD(v.dot(tangent), v.dot(bitangent), v.dot(normal)); };
        expected[point.pixel] = shiny()(local(VectorD(point.outgoing)), local(incoming)) * ColorD(100.0, 50.0, 25.0) *
                                (incoming.dot(normal) / to_light.length2());
    }
    for (const char* integrator : {"path", "ppm"}) {
        const Image image =
            render(scene, hit_points, {.integrator = integrator, .radius = 0.1, .photons_per_pass = 100}, {}).image;
        const std::vector<Color>& direct = *image.find(direct_layer);
        ColorD sum(0.0);
        ColorD sum_expected(0.0);
        int lit = 0;
        for (std::size_t pixel = 0; pixel < expected.size(); ++pixel) {
            if (is_black(expected[pixel])) continue;
            ++lit;
            sum += ColorD(direct[pixel]);
            sum_expected += expected[pixel];
            EXPECT_NEAR(direct[pixel].x / expected[pixel].x, 1.0, 0.15) << integrator << ", pixel " << pixel;
        }
        EXPECT_GT(lit, 900);
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(sum[channel] / sum_expected[channel], 1.0, 0.003) << integrator;
    }
}

// A table that holds 0.5 / pi everywhere is a diffuse surface of reflectance 0.5: the same image to the bit from the
// same photons, and the light of a furnace for all.
TEST(MeasuredWalls, ThatAreDiffuseLookDiffuse) {
    const Formula half_grey = [](const VectorD&, const VectorD&) { return ColorD(0.5 / pi); };
    // Without the bins that lie across the horizon, which are black.
    std::vector<double> numbers = numbers_of(half_grey);
    const double scale[] = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = 0.5 / pi / scale[i / MerlTable::bins];
    SceneDescription description = hollow_sphere(Color(0.5f), ColorD(1.0, 2.0, 3.0));
    description.materials = {measured(make_merl_table(numbers, "test"))};
    const Scene scene = build_scene(description);
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    constexpr double radius = 0.2;
    const double share_found = 1.0 - radius * radius / (8.0 * sphere_radius * sphere_radius);
    ClaimFamily claims;
    for (const auto& [name, settings, passes] :
         {std::tuple{"path", MethodSettings{.integrator = "path"}, 64},
          std::tuple{"ppm", MethodSettings{.radius = radius, .direct_samples = 16, .photons_per_pass = 5000}, 4},
          std::tuple{
              "photonmapper",
              MethodSettings{
                  .integrator = "photonmapper", .radius = radius, .direct_samples = 16, .photons_per_pass = 5000},
              4}}) {
        std::vector<double> values[3];
        for (std::uint64_t seed = 1; seed <= 16; ++seed) {
            const Image image =
                render(scene, hit_points, settings, {.passes = static_cast<std::uint64_t>(passes), .seed = seed}).image;
            for (int c = 0; c < 3; ++c)
                values[c].push_back(mean_of(image, gathered_layer)[c] + mean_of(image, direct_layer)[c]);
        }
        // Le rho / (1 - rho) = Le; direct light, half of it, is not gathered.
        const double found = std::string(name) == "path" ? 1.0 : (1.0 + share_found) / 2.0;
        for (int c = 0; c < 3; ++c)
            claims.mean_is(std::string(name) + ", channel " + std::to_string(c), values[c], (c + 1.0) * found, 0.004);
    }
}

// A shiny ball in a furnace: what it reflects of a uniform surround is its albedo, seen from each pixel.
TEST(MeasuredBall, ReflectsItsAlbedoOfAUniformSurround) {
    SceneDescription description = hollow_sphere(Color(0.0f), ColorD(1.0, 2.0, 3.0), 1);
    description.materials.push_back(shiny_material());
    description.shapes.push_back(disk({0.4, 0.2, 0.9}, {0.0, 0.0, -1.0}, 0.5, 1));
    ClaimFamily claims;
    for (const double degrees : {0.0, 40.0, 70.0}) {
        const double angle = degrees * pi / 180.0;
        const VectorD centre(0.4, 0.2, 0.9);
        description.camera = look_at(centre + VectorD(std::sin(angle), 0.0, -std::cos(angle)), centre);
        const Scene scene = build_scene(description);
        const ColorD albedo = albedo_of(shiny(), VectorD(std::sin(angle), 0.0, std::cos(angle)));
        std::vector<double> values[3];
        for (std::uint64_t seed = 1; seed <= 32; ++seed) {
            const Image image = render(scene, {.integrator = "path"}, {.passes = 2000, .seed = seed}).image;
            for (int c = 0; c < 3; ++c) values[c].push_back(mean_total(image)[c]);
        }
        // Beyond 60 degrees the bins across the horizon, which are black, and the steep highlight cost up to 1%.
        for (int c = 0; c < 3; ++c)
            claims.mean_is(std::to_string(degrees) + " degrees, channel " + std::to_string(c), values[c],
                           albedo[c] * (c + 1.0), 0.004, degrees > 60.0 ? 0.01 : 0.003);
    }
}

// A room with a measured floor, back wall and block: paths, and photons by both methods, per layer. Compared are means
// over the image, whose largest bias is that of gathering across edges: below 3% at this radius (room_test.cpp is exact
// away from them).
TEST(MeasuredRoom, LooksTheSameByPathsAndByPhotons) {
    SceneDescription description = room(24, 24);
    description.materials[3] = shiny_material();
    description.shapes[0].material = 3;
    description.shapes[2].material = 3;
    const Scene scene = build_scene(description);
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    std::vector<Image> paths, ppm, pm;
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
        paths.push_back(render(scene, hit_points, {.integrator = "path"}, {.passes = 100, .seed = seed}).image);
        ppm.push_back(render(scene, hit_points,
                             {.alpha = 0.8, .radius = 0.06, .direct_samples = 4, .photons_per_pass = 20'000},
                             {.passes = 4, .seed = seed})
                          .image);
        pm.push_back(
            render(scene, hit_points,
                   {.integrator = "photonmapper", .radius = 0.05, .direct_samples = 4, .photons_per_pass = 20'000},
                   {.passes = 4, .seed = seed})
                .image);
    }
    const auto means = [](const std::vector<Image>& images, std::string_view layer, int channel) {
        std::vector<double> values;
        for (const Image& image : images) values.push_back(mean_of(image, layer)[channel]);
        return values;
    };
    ClaimFamily claims;
    for (int c = 0; c < 3; ++c)
        for (const std::string_view layer : {direct_layer, gathered_layer})
            for (const auto& [name, images] : {std::pair("ppm", &ppm), std::pair("photonmapper", &pm)})
                claims.means_agree(std::string(name) + ", " + std::string(layer) + ", channel " + std::to_string(c),
                                   means(*images, layer, c), means(paths, layer, c), 0.01,
                                   layer == direct_layer ? 0.0 : 0.03);
}

}  // namespace
}  // namespace photonlab::test
