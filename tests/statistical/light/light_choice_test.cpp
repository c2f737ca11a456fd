// Lights are chosen by power, so a dim light close to a receiver is nearly never chosen there and yet may be most of
// its light. The estimate stays unbiased: the path tracer finds such a light by its own directions, and where powers
// are a hundred to one plain sampling shows the same.

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

const Color lit_floor_colour(0.6f);

// The dim disc, as wide as it is high above the origin, fills half of the sky's cosine; the bright sphere has a million
// times its power. Radiances are chosen so that each gives pi / 2 of irradiance, to the whole or a part of the
// channels.
TEST(LightChoice, PathTracingIsUnbiasedWithPowersAMillionToOne) {
    constexpr double height = 0.02;
    constexpr double distance = 8.0;
    constexpr double ball_radius = 1.0;
    const double inclination = pi / 3.0;  // the disc hides less than 45 degrees from the normal
    const ColorD dim(1.0, 0.5, 0.0);
    // pi^2 a^2 Le times a million = 4 pi^2 A^2 Lb
    const double bright = 1e6 * height * height * mean_channel(dim) / (4.0 * ball_radius * ball_radius);
    SceneDescription description = floor_seen_at_origin(lit_floor_colour, 20.0);
    description.shapes.push_back(disk(VectorD(0.0, height, 0.0), VectorD(0, -1, 0), height, 1, dim));
    description.shapes.push_back(
        sphere(VectorD(distance * std::sin(inclination), distance * std::cos(inclination), 0.0), ball_radius, false, 1,
               ColorD(bright)));
    description.camera = look_at(VectorD(-0.1, 0.04, 0.03), VectorD(0.0));
    const Scene scene = build_scene(description);
    EXPECT_NEAR(scene.emitters[0].choice_probability, 1e-6, 1e-9);

    std::vector<double> radiance[3];
    for (std::uint64_t seed = 1; seed <= 32; ++seed) {
        const ColorD direct =
            mean_of(render(scene, {.integrator = "path"}, {.passes = 1000, .seed = seed}).image, direct_layer);
        for (int c = 0; c < 3; ++c) radiance[c].push_back(direct[c]);
    }
    ClaimFamily claims;
    for (int c = 0; c < 3; ++c) {
        const double from_disc = pi * dim[c] * 0.5;
        const double from_ball =
            pi * bright * (ball_radius / distance) * (ball_radius / distance) * std::cos(inclination);
        claims.mean_is("channel " + std::to_string(c), radiance[c], lit_floor_colour[c] / pi * (from_disc + from_ball),
                       0.01);
    }
}

TEST(LightChoice, SampledAndPhotonDirectLightAreUnbiasedWithPowersAHundredToOne) {
    // The dim lamp hangs a tenth as high: both light the origin alike.
    SceneDescription description = floor_seen_at_origin(lit_floor_colour);
    description.lights = {point_light(VectorD(0.0, 0.4, 0.0), ColorD(0.02, 0.01, 0.0)),
                          point_light(VectorD(0.0, 4.0, 0.0), ColorD(0.0, 1.0, 2.0))};
    const Scene scene = build_scene(description);
    constexpr double radius = 0.2;
    const auto mean_irradiance = [&](const PointLightDescription& light, int c, double disc) {
        const double q = std::hypot(light.position.y, disc);
        return 2.0 * light.intensity[c] / (q * (q + light.position.y));
    };
    ClaimFamily claims;
    for (const DirectMode direct : {DirectMode::Sampled, DirectMode::Photons}) {
        std::vector<double> radiance[3];
        const bool by_photons = direct == DirectMode::Photons;
        const MethodSettings method{.integrator = "photonmapper",
                                    .radius = radius,
                                    .direct = direct,
                                    .direct_samples = 500,
                                    .photons_per_pass = by_photons ? 30'000u : 1u};
        for (std::uint64_t seed = 1; seed <= 32; ++seed) {
            const Rendering result = render(scene, method, {.passes = by_photons ? 2u : 20u, .seed = seed});
            for (int c = 0; c < 3; ++c)
                radiance[c].push_back(mean_of(result.image, by_photons ? gathered_layer : direct_layer)[c]);
        }
        for (int c = 0; c < 3; ++c) {
            double expected = 0.0;
            for (const LightDescription& any : description.lights) {
                const auto& light = std::get<PointLightDescription>(any);
                expected += lit_floor_colour[c] / pi * mean_irradiance(light, c, by_photons ? radius : 0.0);
            }
            claims.mean_is(name_of(direct) + ", channel " + std::to_string(c), radiance[c], expected, 0.05);
        }
    }
}

}  // namespace
}  // namespace photonlab::test
