// Albedo 0 and 1, and light of very different strength in one scene.

#include <gtest/gtest.h>

#include <string>

#include "core/error.h"
#include "scene/emitter.h"
#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

constexpr double gather_radius = 0.15;

/// A hollow sphere with a point of light in its middle: reflected radiance is I rho (1 - rho^K) / ((1 - rho) pi R^2)
/// after at most K reflections (docs/theory.md, section 5; power 4 pi I, area 4 pi R^2).
SceneDescription lit_sphere(const Color& reflectance) {
    SceneDescription scene = hollow_sphere(reflectance);
    scene.lights = {point_light(VectorD(0.0), ColorD(1.0))};
    return scene;
}

double radiance_of(double rho, int reflections) {
    double sum = 0.0;
    for (int k = 1; k <= reflections; ++k) sum += std::pow(rho, k);
    return sum / (pi * sphere_radius * sphere_radius);
}

/// Of photons that a gather accepts on the inside of a sphere: integrating_sphere_test.cpp says why.
constexpr double share_found = 1.0 - gather_radius * gather_radius / (8.0 * sphere_radius * sphere_radius);

TEST(Albedo, OfZeroIsBlack) {
    const Scene scene = build_scene(lit_sphere(Color(0.0f)));
    for (const std::string integrator : {"path", "ppm", "photonmapper"}) {
        const Rendering result =
            render(scene, {.integrator = integrator, .radius = gather_radius, .photons_per_pass = 1000}, {.passes = 3});
        EXPECT_EQ(mean_total(result.image), ColorD(0.0)) << integrator;
        EXPECT_EQ(result.report.photons_gathered, 0u);
    }
}

// With a depth the answer is exact whatever the albedo: also where nothing is absorbed, and where a channel has a
// millionth of the flux of another.
TEST(Albedo, FromAMillionthToOneHasTheClosedForm) {
    ClaimFamily claims;
    const Color reflectance(1.0f, 1e-3f, 1e-6f);
    const Scene scene = build_scene(lit_sphere(reflectance));
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    for (const std::string integrator : {"path", "ppm", "photonmapper"})
        for (const int reflections : {2, 6}) {
            std::vector<double> values[3];
            for (std::uint64_t seed = 1; seed <= 24; ++seed) {
                const Rendering result = render(scene, hit_points,
                                                {.integrator = integrator,
                                                 .radius = gather_radius,
                                                 .max_depth = reflections + 1,
                                                 .photons_per_pass = 2000},
                                                {.passes = 8, .seed = seed});
                for (int c = 0; c < 3; ++c) values[c].push_back(mean_of(result.image, gathered_layer)[c]);
            }
            for (int c = 0; c < 3; ++c) {
                const double rho = reflectance[c];
                const double expected = radiance_of(rho, reflections) - radiance_of(rho, 1);
                claims.mean_is(
                    integrator + ", " + std::to_string(reflections) + " reflections, channel " + std::to_string(c),
                    values[c], expected * (integrator == "path" ? 1.0 : share_found), 0.02);
            }
        }
}

// Nothing is absorbed and nothing leaves: the true radiance is infinite, and what is computed is what the cap on edges
// leaves of it. Survival of at most 0.99 ends every path long before, so the cap cuts nothing, which is recorded.
TEST(Albedo, OfOneWithoutALimitTerminatesAndSaysWhatTheCapCut) {
    const Scene scene = build_scene(lit_sphere(Color(1.0f)));
    const PhotonPass pass = trace_photons(scene, {.paths = 20'000, .store_direct = true}, 1, 1);
    EXPECT_EQ(pass.paths_cut, 0u);
    EXPECT_EQ(pass.power_cut, 0.0);
    EXPECT_EQ(pass.nonfinite, 0u);
    // A photon goes on with probability 0.99: 100 of them a path, with a standard deviation of 99.5.
    EXPECT_NEAR(static_cast<double>(pass.photons.size()) / 20'000.0, 100.0, 4.0 * 99.5 / std::sqrt(20'000.0));
    // Of the n-th generation each carries 0.99^(1 - n), so that every generation brings as much as the first.
    double of_edge[60] = {};
    for (const Photon& photon : pass.photons)
        if (photon.edges < 60) of_edge[photon.edges] += photon.power.x / 20'000.0;
    for (const int edge : {1, 2, 10, 30}) {
        const double survivors = std::pow(0.99, edge - 1);
        EXPECT_NEAR(of_edge[edge], 1.0, 4.0 * std::sqrt((1.0 / survivors - 1.0) / 20'000.0) + 1e-5) << edge;
    }
    for (const std::string integrator : {"path", "ppm"}) {
        const Image image =
            render(scene, {.integrator = integrator, .radius = gather_radius, .photons_per_pass = 500}, {}).image;
        for (const ColorD& pixel : total(image)) EXPECT_TRUE(is_finite(pixel));
    }
    // From the camera mirrors that lose nothing are followed to the cap, and everything is cut there.
    SceneDescription mirrors = hollow_sphere(Color(1.0f), std::nullopt, 2);
    mirrors.materials = {{.id = "mirror", .bsdf = Conductor{}}};
    EXPECT_NEAR(trace_hit_points(build_scene(mirrors), 1, 1).weight_cut, 1.0, 1e-6);
}

TEST(Albedo, AboveOneIsRefused) {
    for (const float bad : {std::nextafter(1.0f, 2.0f), 1.5f, 1e30f, -1e-6f, std::nanf("")}) {
        for (int channel = 0; channel < 3; ++channel) {
            Color albedo(0.5f);
            albedo[channel] = bad;
            EXPECT_THROW(build_scene(lit_sphere(albedo)), InputError) << bad;
        }
        SceneDescription mirror = hollow_sphere(Color(0.5f));
        mirror.materials = {{.id = "mirror", .bsdf = Conductor{.reflectance = Color(bad)}}};
        EXPECT_THROW(build_scene(mirror), InputError) << bad;
    }
    EXPECT_NO_THROW(build_scene(lit_sphere(Color(1.0f))));
}

// ---------------------------------------------------------------------------------------------------------------------

/// Two closed rooms, each with a lamp of its own, one of them `ratio` times as strong; the camera is in one of them.
SceneDescription two_rooms(double ratio, bool in_the_weak_one) {
    SceneDescription scene;
    scene.materials = {diffuse(Color(0.5f))};
    const VectorD centres[] = {{-2.0, 0.0, 0.0}, {2.0, 0.0, 0.0}};
    for (const VectorD& centre : centres) scene.shapes.push_back(sphere(centre, 1.5, true, 0));
    scene.lights = {point_light(centres[0], ColorD(1.0)), point_light(centres[1], ColorD(ratio))};
    const VectorD& seen = centres[in_the_weak_one ? 0 : 1];
    scene.camera = look_at(seen + VectorD(0.1, 0.2, -0.5), seen + VectorD(0.2, -0.3, 1.0), 8, 8, 90.0);
    return scene;
}

// Lights are chosen by power, so a photon of either room carries as much, and the dark room gets one in `ratio`.
TEST(UnequalLights, GiveEachRoomItsOwn) {
    ClaimFamily claims;
    for (const double ratio : {1.0, 1e3, 1e6, 1e9})
        for (const bool in_the_weak_one : {false, true}) {
            const Scene scene = build_scene(two_rooms(ratio, in_the_weak_one));
            EXPECT_NEAR(scene.emitters[0].choice_probability * (1.0 + ratio), 1.0, 1e-12);
            for (const Emitter& emitter : scene.emitters) EXPECT_EQ(emitter.photon_power, Color(1.0f));
            if (in_the_weak_one && ratio > 1.0) continue;
            std::vector<double> values;
            for (std::uint64_t seed = 1; seed <= 24; ++seed)
                values.push_back(mean_of(render(scene,
                                                {.radius = gather_radius,
                                                 .direct = DirectMode::Photons,
                                                 .max_depth = 3,
                                                 .photons_per_pass = 2000},
                                                {.passes = 8, .seed = seed})
                                             .image,
                                         gathered_layer)
                                     .x);
            const double own = in_the_weak_one ? 1.0 : ratio;
            claims.mean_is("ratio " + std::to_string(ratio), values, own * 0.75 / (pi * 2.25), 0.02,
                           gather_radius * gather_radius / (8.0 * 2.25));
        }
}

// One in a million numbers chooses the weak light: exactly those, to the last of 53 bits.
TEST(UnequalLights, AreChosenByTheirShareOfThePower) {
    for (const double ratio : {1e6, 1e12}) {
        const Scene scene = build_scene(two_rooms(ratio, false));
        const double share = 1.0 / (1.0 + ratio);
        EXPECT_EQ(choose_emitter(scene, 0.0), 0u);
        EXPECT_EQ(choose_emitter(scene, share * (1.0 - 1e-9)), 0u);
        EXPECT_EQ(choose_emitter(scene, share * (1.0 + 1e-9)), 1u);
        EXPECT_EQ(choose_emitter(scene, 1.0 - 0x1p-53), 1u);
    }
}

}  // namespace
}  // namespace photonlab::test
