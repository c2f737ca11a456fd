// The integrating sphere: whatever shines inside a diffuse sphere, the light it reflects is the same everywhere, and
// known order by order. It holds photons, gathers and path tracer to exact numbers, and as its photons are uniform it
// is where progressive photon mapping must be unbiased at every radius and alpha.
//
// One thing is not flat about it. A photon at distance d from the gather point arrived from a point of the sphere; it
// is refused when it comes from below the gather point's own horizon, which is when that point is nearer than d. After
// at least one reflection that point is uniform on the sphere, so the share refused is d^2 / (4 R^2): averaged over a
// disc of radius r the gather finds 1 - r^2 / (8 R^2) of the light. Photons from a source at the centre are never
// refused.

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

const Color wall_colour(0.2f, 0.5f, 0.8f);
const ColorD lamp_intensity(3.0, 2.0, 1.0);
const VectorD off_centre(1.1, -0.6, 0.8);
constexpr double sphere_area = 4.0 * pi * sphere_radius * sphere_radius;

SceneDescription describe(const VectorD& lamp, int resolution = 8) {
    SceneDescription scene = hollow_sphere(wall_colour, std::nullopt, resolution);
    scene.lights = {point_light(lamp, lamp_intensity)};
    return scene;
}

/// Radiance after exactly `reflections` reflections; a central source where that is 1.
double radiance_of_order(int c, int reflections) {
    return std::pow(static_cast<double>(wall_colour[c]), reflections) * 4.0 * pi * lamp_intensity[c] /
           (pi * sphere_area);
}

/// Sum over orders from `first` to `last`, or to infinity for last = 0.
double radiance_of_orders(int c, int first, int last = 0) {
    const double rho = wall_colour[c];
    const double beyond = last == 0 ? 0.0 : radiance_of_order(c, last + 1);
    return (radiance_of_order(c, first) - beyond) / (1.0 - rho);
}

/// Share of indirect photons that a gather of this radius finds (above): `moment` is the kernel's mean of s^2, 1/2 for
/// the disc.
double share_found(double radius, double moment = 0.5) {
    return 1.0 - moment * radius * radius / (4.0 * sphere_radius * sphere_radius);
}

/// Values of each channel of one layer, mean over the image, over seeds.
struct Channels {
    std::vector<double> values[3];
    void add(const ColorD& colour) {
        for (int c = 0; c < 3; ++c) values[c].push_back(colour[c]);
    }
};

TEST(IntegratingSphere, PathTracingFindsTheExactRadiance) {
    ClaimFamily claims;
    for (const VectorD& lamp : {VectorD(0.0), off_centre}) {
        const std::string where = lamp == VectorD(0.0) ? "central" : "off centre";
        const Scene scene = build_scene(describe(lamp));
        Channels gathered;
        for (std::uint64_t seed = 1; seed <= 32; ++seed) {
            const Rendering result = render(scene, {.integrator = "path"}, {.passes = 30, .seed = seed});
            gathered.add(mean_of(result.image, gathered_layer));
            if (lamp != VectorD(0.0)) continue;
            for (int c = 0; c < 3; ++c)
                EXPECT_NEAR(mean_of(result.image, direct_layer)[c], radiance_of_order(c, 1),
                            1e-5 * radiance_of_order(c, 1));
        }
        for (int c = 0; c < 3; ++c) claims.mean_is(where, gathered.values[c], radiance_of_orders(c, 2), 0.01);
    }
}

TEST(IntegratingSphere, PhotonMethodsFindTheExactRadiance) {
    struct Method {
        std::string name;
        MethodSettings settings;
    };
    constexpr double radius = 0.25;  // a twelfth of the sphere's: 0.09% are refused
    std::vector<Method> methods{{"photonmapper", {.integrator = "photonmapper", .radius = radius}}};
    for (const double alpha : {0.3, 0.7, 1.0})
        for (const ScheduleName schedule : {ScheduleName::Hachisuka, ScheduleName::KnausZwicker})
            methods.push_back({"ppm " + name_of(schedule) + " alpha " + std::to_string(alpha),
                               {.schedule = schedule, .alpha = alpha, .radius = radius}});

    ClaimFamily claims;
    for (const VectorD& lamp : {VectorD(0.0), off_centre}) {
        const bool central = lamp == VectorD(0.0);
        const Scene scene = build_scene(describe(lamp));
        for (Method& method : methods) {
            if (!central && method.settings.alpha != 0.7) continue;
            method.settings.photons_per_pass = 2000;
            Channels gathered;
            std::vector<double> expected[3];
            for (std::uint64_t seed = 1; seed <= 24; ++seed) {
                const Rendering result = render(scene, method.settings, {.passes = 5, .seed = seed});
                gathered.add(mean_of(result.image, gathered_layer));
                const double share = mean_over(result.radii, [](double r) { return share_found(r); });
                for (int c = 0; c < 3; ++c) {
                    expected[c].push_back(radiance_of_orders(c, 2) * share);
                }
                if (!central) continue;
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(mean_of(result.image, direct_layer)[c], radiance_of_order(c, 1),
                                1e-5 * radiance_of_order(c, 1));
            }
            for (int c = 0; c < 3; ++c)
                claims.means_are(
                    method.name + (central ? ", central" : ", off centre") + ", channel " + std::to_string(c),
                    gathered.values[c], expected[c], 0.02);
        }
    }
}

// With at most K reflections max_depth is K + 1: K edges between surfaces and lamp, and one to the camera.
TEST(IntegratingSphere, DepthLimitsTheNumberOfReflections) {
    const Scene scene = build_scene(describe(VectorD(0.0)));
    ClaimFamily claims;
    for (int reflections = 0; reflections <= 3; ++reflections) {
        const std::string limit = std::to_string(reflections) + " reflections";
        for (const std::string integrator : {"ppm", "photonmapper", "path"})
            for (const DirectMode direct : {DirectMode::Sampled, DirectMode::Photons}) {
                if (integrator == "path" && direct == DirectMode::Photons) continue;
                const MethodSettings method{.integrator = integrator,
                                            .radius = 0.25,
                                            .direct = direct,
                                            .max_depth = reflections + 1,
                                            .photons_per_pass = 4000};
                Channels totals;
                for (std::uint64_t seed = 1; seed <= 24; ++seed)
                    totals.add(mean_total(
                        render(scene, method, {.passes = integrator == "path" ? 16u : 3u, .seed = seed}).image));
                for (int c = 0; c < 3; ++c) {
                    if (reflections == 0) {
                        EXPECT_EQ(SampleMean(totals.values[c]).mean, 0.0) << integrator;
                        continue;
                    }
                    // Orders above 1 are gathered everywhere but in the path tracer, which refuses nothing.
                    const double indirect = radiance_of_orders(c, 1, reflections) - radiance_of_order(c, 1);
                    const double share = integrator == "path" ? 1.0 : share_found(0.25);
                    claims.mean_is(integrator + (direct == DirectMode::Photons ? ", photons, " : ", sampled, ") + limit,
                                   totals.values[c], radiance_of_order(c, 1) + indirect * share, 0.01);
                }
            }
    }
}

// Three paths a pass and a disc of a sixteenth of the sphere: most passes find nothing, and must count all the same.
TEST(IntegratingSphere, ProgressiveEstimateIsUnbiasedThoughMostPassesAreEmpty) {
    const Scene scene = build_scene(describe(VectorD(0.0), 1));
    const double radius = 0.5 * sphere_radius;
    constexpr int c = 1;
    ClaimFamily claims;
    for (const ScheduleName schedule : {ScheduleName::Hachisuka, ScheduleName::KnausZwicker})
        for (const double alpha : {0.3, 0.7, 1.0})
            for (const DirectMode direct : {DirectMode::Sampled, DirectMode::Photons}) {
                std::vector<double> radiance;
                std::vector<double> expected;
                for (std::uint64_t seed = 1; seed <= 200; ++seed) {
                    const MethodSettings method{.schedule = schedule,
                                                .alpha = alpha,
                                                .radius = radius,
                                                .direct = direct,
                                                .photons_per_pass = 3};
                    const Rendering result = render(scene, method, {.passes = 40, .seed = seed});
                    radiance.push_back(mean_of(result.image, gathered_layer)[c]);
                    const double share = mean_over(result.radii, [](double r) { return share_found(r); });
                    expected.push_back(radiance_of_orders(c, 2) * share +
                                       (direct == DirectMode::Photons ? radiance_of_order(c, 1) : 0.0));
                }
                claims.means_are(name_of(schedule) + " alpha " + std::to_string(alpha) +
                                     (direct == DirectMode::Photons ? ", photons" : ", sampled"),
                                 radiance, expected, 0.06);
            }
}

// The kernel's mean of s^2 over the disc: of the photons' share refused (at the top) and nothing else here.
double second_moment(Kernel kernel) {
    switch (kernel) {
        case Kernel::Disc:
            return 1.0 / 2.0;
        case Kernel::Cone:
            return 3.0 / 10.0;
        case Kernel::Epanechnikov:
            return 1.0 / 3.0;
        case Kernel::Biweight:
            return 1.0 / 4.0;
    }
    return 0.0;
}

TEST(IntegratingSphere, EveryKernelIsUnbiasedOnUniformDensity) {
    const Scene scene = build_scene(describe(VectorD(0.0), 1));
    constexpr int c = 1;
    ClaimFamily claims;
    for (const auto& kernel : kernel_names)
        for (const std::string integrator : {"ppm", "photonmapper"}) {
            std::vector<double> radiance;
            std::vector<double> expected;
            for (std::uint64_t seed = 1; seed <= 32; ++seed) {
                const MethodSettings method{.integrator = integrator,
                                            .radius = 0.4 * sphere_radius,
                                            .kernel = kernel.value,
                                            .direct = DirectMode::Photons,
                                            .photons_per_pass = 500};
                const Rendering result = render(scene, method, {.passes = 6, .seed = seed});
                radiance.push_back(mean_of(result.image, gathered_layer)[c]);
                const double share =
                    mean_over(result.radii, [&](double r) { return share_found(r, second_moment(kernel.value)); });
                expected.push_back(radiance_of_order(c, 1) + radiance_of_orders(c, 2) * share);
            }
            claims.means_are(integrator + " " + std::string(kernel.name), radiance, expected, 0.02);
        }
}

// The k-th nearest photon sets the radius and carries nothing; then uniform photons are estimated without bias. Where
// fewer than k are within the maximum radius, it is the gather of that radius.
TEST(IntegratingSphere, NearestPhotonsAreUnbiasedForEveryKernelAndSmallNumbers) {
    const Scene scene = build_scene(describe(VectorD(0.0)));
    constexpr int c = 1;
    ClaimFamily claims;
    struct Nearest {
        int k;
        double max_radius;  // in shares of the sphere's
    };
    for (const auto& kernel : kernel_names)
        for (const Nearest& nearest : {Nearest{6, 0.5}, Nearest{40, 0.5}, Nearest{100'000, 0.2}}) {
            std::vector<double> radiance;
            for (std::uint64_t seed = 1; seed <= 32; ++seed) {
                const MethodSettings method{.integrator = "photonmapper",
                                            .mode = GatherMode::Nearest,
                                            .k = nearest.k,
                                            .max_radius = nearest.max_radius * sphere_radius,
                                            .kernel = kernel.value,
                                            .direct = DirectMode::Photons,
                                            .photons_per_pass = 3000};
                radiance.push_back(mean_of(render(scene, method, {.seed = seed}).image, gathered_layer)[c]);
            }
            // 6000 photons on the whole sphere: k of them lie within a radius of 2 R sqrt(k / 6000).
            const double squared_radius = std::min(nearest.max_radius * nearest.max_radius, 4.0 * nearest.k / 6000.0);
            const double share = share_found(std::sqrt(squared_radius) * sphere_radius, second_moment(kernel.value));
            claims.mean_is("k " + std::to_string(nearest.k) + " " + std::string(kernel.name), radiance,
                           radiance_of_order(c, 1) + radiance_of_orders(c, 2) * share, 0.02);
        }
}

TEST(IntegratingSphere, BlackWallsGatherExactlyNothing) {
    SceneDescription description = hollow_sphere(Color(0.0f));
    description.lights = {point_light(off_centre, lamp_intensity)};
    const Scene scene = build_scene(description);
    for (const char* integrator : {"ppm", "photonmapper", "path"})
        for (const DirectMode direct : {DirectMode::Sampled, DirectMode::Photons}) {
            const Rendering result =
                render(scene, {.integrator = integrator, .direct = direct, .photons_per_pass = 1000}, {.passes = 2});
            EXPECT_EQ(mean_total(result.image), ColorD(0.0)) << integrator;
        }
}

// The number of photons that a path leaves is geometric: the k-th reflection happens with probability rho^k.
TEST(IntegratingSphere, PathsLeaveTheExpectedNumberAndPowerOfPhotons) {
    ClaimFamily claims;
    for (const bool store_direct : {false, true}) {
        const Scene scene = build_scene(describe(off_centre));
        std::vector<double> stored;
        Channels power;
        for (std::uint64_t seed = 1; seed <= 32; ++seed) {
            const PhotonPass pass =
                trace_photons(scene, {.paths = 2000, .seed = seed, .store_direct = store_direct}, 1, 1);
            stored.push_back(static_cast<double>(pass.photons.size()) / 2000.0);
            ColorD sum(0.0);
            for (const Photon& photon : pass.photons) sum += ColorD(photon.power) / 2000.0;
            power.add(sum);
        }
        const std::string what = store_direct ? "with direct, " : "without direct, ";
        const double survival = 0.8f;  // the largest channel
        const double first = store_direct ? 1.0 : survival;
        claims.mean_is(what + "number", stored, first / (1.0 - survival), 0.01);
        for (int c = 0; c < 3; ++c) {
            const double rho = wall_colour[c];
            const double share = lamp_intensity[c] / mean_channel(lamp_intensity);  // of the emitted power, mean 1
            claims.mean_is(what + "power", power.values[c], share * (store_direct ? 1.0 : rho) / (1.0 - rho), 0.01);
        }
    }
}

// A white sphere would keep a path for ever; survival of at most 0.99 ends it after 100 edges on average.
TEST(IntegratingSphere, WhiteWallsEndPathsByTheHighestSurvival) {
    SceneDescription description = hollow_sphere(Color(1.0f));
    description.lights = {point_light(off_centre, ColorD(1.0))};
    const Scene scene = build_scene(description);
    std::vector<double> stored;
    for (std::uint64_t seed = 1; seed <= 32; ++seed) {
        const PhotonPass pass = trace_photons(scene, {.paths = 300, .seed = seed, .store_direct = true}, 1, 1);
        EXPECT_EQ(pass.paths_cut, 0u);
        EXPECT_EQ(pass.nonfinite, 0u);
        stored.push_back(static_cast<double>(pass.photons.size()) / 300.0);
        // The survivors carry the share of those that ended: 1 / 0.99 a reflection.
        for (const Photon& photon : pass.photons)
            EXPECT_NEAR(photon.power.x * std::pow(0.99, photon.edges - 1.0), 1.0, 1e-6 * photon.edges);
    }
    ClaimFamily claims;
    claims.mean_is("edges", stored, 1.0 / (1.0 - 0.99), 0.02);
}

}  // namespace
}  // namespace photonlab::test
