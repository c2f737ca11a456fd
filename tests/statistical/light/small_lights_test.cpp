// A floor under a point light, a disc and a sphere: irradiance in closed form, and for photon mapping even its bias,
// since the mean irradiance over the gather disc is known at any radius (docs/theory.md, section 5). Every method is
// held to it.

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

constexpr double lamp_height = 2.0;
const ColorD small_lamp_intensity(3.0, 1.0, 2.0);
const Color floor_colour(0.3f, 0.6f, 0.8f);

/// The channel that is looked at: all three see the same photons of one light, and their ratios are tested exactly.
constexpr int channel = 1;
constexpr double floor_reflectance = 0.6f;

Scene floor_under_lamp() {
    SceneDescription scene = floor_seen_at_origin(floor_colour);
    scene.lights = {point_light(VectorD(0.0, lamp_height, 0.0), small_lamp_intensity)};
    return build_scene(scene);
}

/// Mean of the point light's irradiance over the disc of radius `radius` around the foot of its perpendicular.
double lamp_irradiance_over_disc(double radius) {
    const double q = std::hypot(lamp_height, radius);
    return 2.0 * small_lamp_intensity[channel] / (q * (q + lamp_height));
}

/// Mean of `irradiance(x, z)` over a disc around the origin: midpoints in squared radius and angle.
template <typename Irradiance>
double mean_over_disc(double radius, const Irradiance& irradiance) {
    constexpr int steps = 64;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double distance = radius * std::sqrt((i + 0.5) / steps);
            const double angle = 2.0 * pi * (j + 0.5) / steps;
            sum += irradiance(distance * std::cos(angle), distance * std::sin(angle));
        }
    return sum / (steps * steps);
}

// Up to 1.5 times the lamp's height, where the bias is far from its small-radius limit.
const double gather_radii[] = {0.2 * lamp_height, 0.7 * lamp_height, 1.5 * lamp_height};

TEST(PointLightOverFloor, SampledDirectLightIsExact) {
    const Scene scene = floor_under_lamp();
    for (const char* integrator : {"ppm", "photonmapper", "path"}) {
        const Rendering result =
            render(scene, {.integrator = integrator, .direct_samples = 3, .photons_per_pass = 10}, {.passes = 3});
        for (int c = 0; c < 3; ++c) {
            const double exact = floor_colour[c] / pi * small_lamp_intensity[c] / (lamp_height * lamp_height);
            EXPECT_NEAR(mean_of(result.image, direct_layer)[c], exact, 2e-6 * exact) << integrator << " channel " << c;
        }
        EXPECT_EQ(mean_of(result.image, gathered_layer), ColorD(0.0)) << integrator;
        EXPECT_EQ(mean_of(result.image, emission_layer), ColorD(0.0)) << integrator;
    }
}

TEST(PointLightOverFloor, ThreeChannelsOfPhotonsKeepTheirRatio) {
    const Scene scene = floor_under_lamp();
    const Rendering result =
        render(scene, {.radius = lamp_height, .direct = DirectMode::Photons, .photons_per_pass = 1000}, {});
    const ColorD radiance = mean_of(result.image, gathered_layer);
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(radiance[c] / radiance[channel],
                    floor_colour[c] * small_lamp_intensity[c] / (floor_colour[channel] * small_lamp_intensity[channel]),
                    1e-5);
}

TEST(PointLightOverFloor, PhotonMappingHasExactlyTheBiasOfItsDisc) {
    const Scene scene = floor_under_lamp();
    ClaimFamily claims;
    for (const double radius : gather_radii) {
        std::vector<double> radiance;
        for (std::uint64_t seed = 1; seed <= 64; ++seed) {
            const MethodSettings method{.integrator = "photonmapper",
                                        .radius = radius,
                                        .direct = DirectMode::Photons,
                                        .photons_per_pass = 2000};
            radiance.push_back(
                mean_of(render(scene, method, {.passes = 3, .seed = seed}).image, gathered_layer)[channel]);
        }
        claims.mean_is("radius " + std::to_string(radius), radiance,
                       floor_reflectance / pi * lamp_irradiance_over_disc(radius), 0.02);
    }
}

// A pass's estimate has, given the radius before it, the expectation of that disc; so the run's estimate minus the mean
// of these over its own radii has expectation 0, though Hachisuka's radii depend on the photons.
TEST(PointLightOverFloor, ProgressivePhotonMappingIsUnbiasedOverItsOwnRadii) {
    const Scene scene = floor_under_lamp();
    ClaimFamily claims;
    for (const ScheduleName schedule : {ScheduleName::Hachisuka, ScheduleName::KnausZwicker})
        for (const double alpha : {0.25, 0.7, 1.0})
            for (const double radius : gather_radii) {
                std::vector<double> radiance;
                std::vector<double> expected;
                for (std::uint64_t seed = 1; seed <= 64; ++seed) {
                    const MethodSettings method{.schedule = schedule,
                                                .alpha = alpha,
                                                .radius = radius,
                                                .direct = DirectMode::Photons,
                                                .photons_per_pass = 400};
                    const Rendering result = render(scene, method, {.passes = 12, .seed = seed});
                    EXPECT_NEAR(result.radii[0], radius, 1e-9);
                    radiance.push_back(mean_of(result.image, gathered_layer)[channel]);
                    expected.push_back(floor_reflectance / pi * mean_over(result.radii, lamp_irradiance_over_disc));
                }
                claims.means_are(
                    name_of(schedule) + " alpha " + std::to_string(alpha) + " radius " + std::to_string(radius),
                    radiance, expected, 0.06);
            }
}

/// Sampled direct light by ppm and path, each over 32 seeds, and photons over a disc; `irradiance` is that of
/// channel 1.
template <typename Irradiance>
void expect_irradiance(ClaimFamily& claims, const std::string& light, const Scene& scene, const Irradiance& irradiance,
                       double photon_radius, std::uint64_t photons) {
    const double at_origin = floor_reflectance / pi * irradiance(0.0, 0.0);
    for (const char* integrator : {"ppm", "path"}) {
        std::vector<double> radiance;
        for (std::uint64_t seed = 1; seed <= 32; ++seed)
            radiance.push_back(
                mean_of(render(scene, {.integrator = integrator, .direct_samples = 4, .photons_per_pass = 1},
                               {.passes = 100, .seed = seed})
                            .image,
                        direct_layer)[channel]);
        claims.mean_is(light + ", direct by " + integrator, radiance, at_origin, 0.015);
    }
    std::vector<double> radiance;
    for (std::uint64_t seed = 1; seed <= 32; ++seed)
        radiance.push_back(mean_of(render(scene,
                                          {.integrator = "photonmapper",
                                           .radius = photon_radius,
                                           .direct = DirectMode::Photons,
                                           .photons_per_pass = photons},
                                          {.seed = seed})
                                       .image,
                                   gathered_layer)[channel]);
    claims.mean_is(light + ", photons", radiance, floor_reflectance / pi * mean_over_disc(photon_radius, irradiance),
                   0.02);
}

TEST(DiscLightOverFloor, MatchesTheClosedFormOnItsAxis) {
    constexpr double height = 1.5;
    const ColorD radiance(1.0, 4.0, 2.0);
    ClaimFamily claims;
    for (const double radius : {0.3, 1.0, 4.0}) {
        SceneDescription description = floor_seen_at_origin(floor_colour);
        description.shapes.push_back(disk(VectorD(0.0, height, 0.0), VectorD(0, -1, 0), radius, 1, radiance));
        // From below the disc, which hides the floor from above.
        description.camera = look_at(VectorD(1.2, 0.8, 0.4), VectorD(0.0));
        const Scene scene = build_scene(description);
        const auto& light = scene.emitters.at(0);
        const double power = pi * pi * radius * radius * radiance[channel];
        EXPECT_NEAR(light.power[channel] * scene.unit_length * scene.unit_length, power, 1e-5 * power);
        // Off the axis as well, for the disc of photons. [Howell, "A Catalog of Radiation Heat Transfer Configuration
        // Factors", B-13]
        const auto irradiance = [&](double x, double z) {
            const double sum = x * x + z * z + height * height;
            const double root =
                std::sqrt((sum + radius * radius) * (sum + radius * radius) - 4.0 * radius * radius * (x * x + z * z));
            return pi * radiance[channel] / 2.0 * (1.0 - (sum - radius * radius) / root);
        };
        const double on_axis = pi * radiance[channel] * radius * radius / (radius * radius + height * height);
        EXPECT_NEAR(irradiance(0.0, 0.0), on_axis, 1e-12 * on_axis);
        expect_irradiance(claims, "disc of radius " + std::to_string(radius), scene, irradiance, 0.4, 30'000);
    }
}

TEST(SphereLightOverFloor, MatchesTheClosedFormAtAnyInclination) {
    constexpr double radius = 0.5;
    constexpr double distance = 2.0;
    const ColorD radiance(1.0, 4.0, 2.0);
    ClaimFamily claims;
    for (const double inclination : {0.0, 35.0, 70.0}) {
        const double angle = inclination * pi / 180.0;
        const VectorD centre(distance * std::sin(angle), distance * std::cos(angle), 0.0);
        SceneDescription description = floor_seen_at_origin(floor_colour, 10.0);
        description.shapes.push_back(sphere(centre, radius, false, 1, radiance));
        description.camera = look_at(VectorD(-2.0, 2.5, 1.0), VectorD(0.0));
        const Scene scene = build_scene(description);
        const double power = 4.0 * pi * pi * radius * radius * radiance[channel];
        EXPECT_NEAR(scene.emitters.at(0).power[channel] * scene.unit_length * scene.unit_length, power, 1e-5 * power);
        const auto irradiance = [&](double x, double z) {
            const double squared = (VectorD(x, 0.0, z) - centre).length2();
            return pi * radiance[channel] * radius * radius * centre.y / (squared * std::sqrt(squared));
        };
        // The disc stays inside the region from which the whole sphere is above the horizon.
        expect_irradiance(claims, "sphere at " + std::to_string(inclination), scene, irradiance, 0.35, 60'000);
    }
}

}  // namespace
}  // namespace photonlab::test
