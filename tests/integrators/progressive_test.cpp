// Progressive photon mapping against its own definition, photon for photon: the radius of each pass, the 2008 paper's
// shrinking flux, and its limit alpha = 1, which is the average of photon maps of one radius.

#include <gtest/gtest.h>

#include "integrators/density_estimate.h"
#include "integrators/progressive.h"
#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"

namespace photonlab::test {
namespace {

constexpr double floor_radius = 0.3;

/// One hit point on the room's floor.
Scene floor_of_room() {
    SceneDescription description = room();
    description.camera = look_at(VectorD(0.0, 0.5, -2.5), VectorD(-0.4, -1.0, -0.5));
    return build_scene(description);
}

MethodSettings progressive(ScheduleName schedule, double alpha) {
    return {.schedule = schedule,
            .alpha = alpha,
            .radius = floor_radius,
            .direct = DirectMode::Photons,
            .photons_per_pass = 60};
}

FluxSum gather_at_first(const Scene& scene, const HitPoints& hit_points, const PhotonPass& pass, double radius) {
    return gather_within(PhotonMap(pass.photons), scene, hit_points.points, SearchOrder(hit_points.points), {0, 1}, {},
                         [&](std::size_t, const HitPoint&) { return GatherReach{radius}; })[0]
        .sum;
}

// Hachisuka, Ogaki & Jensen 2008: tau <- (tau + phi) rho, R^2 <- R^2 rho, L = tau / (pi R^2 N_emitted). A pass may be
// empty.
TEST(ProgressivePhotonMapping, IsTheShrinkingFluxOfItsPaper) {
    const Scene scene = floor_of_room();
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    ASSERT_EQ(hit_points.points.size(), 1u);
    for (const double alpha : {0.1, 0.5, 0.7, 0.95, 1.0}) {
        const MethodSettings method = progressive(ScheduleName::Hachisuka, alpha);
        PassLoop run = loop_of(method, scene, hit_points);
        double squared_radius = floor_radius * floor_radius / (scene.unit_length * scene.unit_length);
        double count = 0.0;
        ColorD flux(0.0);
        std::uint64_t paths = 0;
        int empty_passes = 0;
        for (std::uint64_t pass = 1; pass <= 200; ++pass) {
            EXPECT_NEAR(*run.state_now(0).report.radius_mean, std::sqrt(squared_radius) * scene.unit_length, 1e-9);
            const PhotonPass photons = trace_photons(scene, photon_settings(method, 1), pass, 1);
            const FluxSum found = gather_at_first(scene, hit_points, photons, std::sqrt(squared_radius));
            paths += photons.paths_emitted;
            empty_passes += found.count() == 0;
            if (found.count() > 0 || count > 0.0) {
                const double m = static_cast<double>(found.count());
                const double shrink = (count + alpha * m) / (count + m);
                flux = (flux + found.flux()) * shrink;
                squared_radius *= shrink;
                count += alpha * m;
            }
            run.take(pass, photons);
            const ColorD radiance = flux * (scene.total_power / (pi * squared_radius * static_cast<double>(paths)));
            const ColorD estimate = mean_of(run.image(), gathered_layer);
            for (int c = 0; c < 3; ++c)
                ASSERT_NEAR(estimate[c], radiance[c], 1e-6 * radiance[c]) << alpha << " pass " << pass;
        }
        EXPECT_GT(empty_passes, 0);
        EXPECT_LT(empty_passes, 200);
    }
}

TEST(ProgressivePhotonMapping, KnausZwickerRadiiIgnoreThePhotons) {
    const Scene scene = floor_of_room();
    for (const double alpha : {0.3, 2.0 / 3.0, 1.0})
        for (const std::uint64_t photons : {1u, 500u}) {
            MethodSettings method = progressive(ScheduleName::KnausZwicker, alpha);
            method.photons_per_pass = photons;
            const Rendering result = render(scene, method, {.passes = 60});
            // In closed form: r_i^2 / r_1^2 = Gamma(i + alpha) / (Gamma(1 + alpha) Gamma(i + 1)).
            for (std::size_t i = 1; i <= result.radii.size(); ++i) {
                const double n = static_cast<double>(i);
                const double share = std::exp(std::lgamma(n + alpha) - std::lgamma(1.0 + alpha) - std::lgamma(n + 1.0));
                EXPECT_NEAR(result.radii[i - 1], floor_radius * std::sqrt(share), 1e-9) << "pass " << i;
            }
        }
}

TEST(ProgressivePhotonMapping, WithAlphaOneIsTheAverageOfPhotonMapsOfOneRadius) {
    const Scene scene = build_scene(room(20, 20));
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    constexpr std::uint64_t passes = 12;
    for (const DirectMode direct : {DirectMode::Sampled, DirectMode::Photons})
        for (const ScheduleName schedule : {ScheduleName::Hachisuka, ScheduleName::KnausZwicker}) {
            MethodSettings method{
                .schedule = schedule, .alpha = 1.0, .radius = 0.1, .direct = direct, .photons_per_pass = 1000};
            const Image progressive = render(scene, hit_points, method, {.passes = passes}).image;
            method.integrator = "photonmapper";
            std::vector<ColorD> average(400, ColorD(0.0));
            for (std::uint64_t pass = 1; pass <= passes; ++pass) {
                PassLoop run = loop_of(method, scene, hit_points);
                run.take(1, trace_photons(scene, photon_settings(method, 1), pass, 1));
                const Image image = run.image();
                for (std::size_t i = 0; i < average.size(); ++i)
                    average[i] += ColorD(image.find(gathered_layer)->at(i)) / static_cast<double>(passes);
            }
            for (std::size_t i = 0; i < average.size(); ++i)
                for (int c = 0; c < 3; ++c)
                    ASSERT_NEAR(progressive.find(gathered_layer)->at(i)[c], average[i][c], 1e-6 * average[i][c]) << i;
        }
}

// All photons of all passes in one map, divided by all paths: the same as the average of one map a pass, at a fixed
// radius.
TEST(PhotonMapping, OverPassesIsTheAverageOfItsPasses) {
    const Scene scene = build_scene(room(20, 20));
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    const MethodSettings mapper{
        .integrator = "photonmapper", .radius = 0.1, .kernel = Kernel::Biweight, .photons_per_pass = 1000};
    MethodSettings progressive = mapper;
    progressive.integrator = "ppm";
    progressive.alpha = 1.0;
    const Image together = render(scene, hit_points, mapper, {.passes = 7}).image;
    const Image averaged = render(scene, hit_points, progressive, {.passes = 7}).image;
    for (std::size_t i = 0; i < 400; ++i)
        for (int c = 0; c < 3; ++c) {
            const double expected = averaged.find(gathered_layer)->at(i)[c];
            ASSERT_NEAR(together.find(gathered_layer)->at(i)[c], expected, 1e-6 * expected) << i;
        }
}

// Photons reach the surface from both sides of a thin wall; each side gathers its own.
TEST(PhotonMapping, GathersNothingThroughAThinWall) {
    SceneDescription description = floor_seen_at_origin(Color(0.5f));
    description.materials[0].two_sided = true;
    description.lights = {point_light(VectorD(0.0, -2.0, 0.0), ColorD(1.0))};
    const Scene scene = build_scene(description);
    for (const char* integrator : {"ppm", "photonmapper"}) {
        const MethodSettings method{
            .integrator = integrator, .radius = 2.0, .direct = DirectMode::Photons, .photons_per_pass = 5000};
        const Rendering result = render(scene, method, {});
        EXPECT_EQ(mean_total(result.image), ColorD(0.0)) << integrator;
        EXPECT_EQ(result.report.photons_gathered, 0u) << integrator;
    }
}

TEST(PhotonMapping, CountsThePhotonsThatItGathered) {
    const Scene scene = floor_of_room();
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    const double radius = floor_radius / scene.unit_length;
    std::uint64_t expected = 0;
    for (std::uint64_t pass = 1; pass <= 4; ++pass) {
        const PhotonPass photons = trace_photons(scene, {.paths = 2000, .store_direct = true}, pass, 1);
        expected += gather_at_first(scene, hit_points, photons, radius).count();
    }
    ASSERT_GT(expected, 100u);
    for (const char* integrator : {"ppm", "photonmapper"}) {
        const MethodSettings method{.integrator = integrator,
                                    .alpha = 1.0,
                                    .radius = floor_radius,
                                    .direct = DirectMode::Photons,
                                    .photons_per_pass = 2000};
        const Rendering result = render(scene, hit_points, method, {.passes = 4, .show_every_pass = true});
        EXPECT_EQ(result.report.photons_gathered, expected) << integrator;
        EXPECT_EQ(result.state.nonfinite_in_maps, 0u);
    }
}

TEST(InitialRadius, IsThreeFootprintsUnlessGivenInSceneUnits) {
    const Scene scene = build_scene(room(20, 20));
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    const auto report_of = [&](const MethodSettings& method) {
        return loop_of(method, scene, hit_points).state(0).report;
    };
    double mean = 0.0;
    for (const float footprint : hit_points.footprints)
        mean += 2.0 * footprint * scene.unit_length / static_cast<double>(hit_points.footprints.size());
    for (const char* integrator : {"ppm", "photonmapper"}) {
        EXPECT_NEAR(*report_of({.integrator = integrator}).radius_mean, mean, 1e-6 * mean) << integrator;
        EXPECT_NEAR(*report_of({.integrator = integrator, .radius = 0.07}).radius_min, 0.07, 1e-9) << integrator;
        EXPECT_NEAR(*report_of({.integrator = integrator, .radius = 0.07}).radius_max, 0.07, 1e-9) << integrator;
    }
    EXPECT_FALSE(report_of({.integrator = "path"}).radius_mean);
}

// Rough glass gathers from both of its sides, and so begins with a disc that holds as many photons of both.
TEST(ProgressivePhotonMapping, BeginsWithWhatIsNearestOnEitherSideOfRoughGlass) {
    SceneDescription description = floor_seen_at_origin(Color(0.5f));
    description.materials[0].bsdf = RoughDielectric{};
    const Scene scene = build_scene(description);
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    ASSERT_EQ(hit_points.points.size(), 1u);
    const HitPoint point = hit_points.points[0];
    const float distance = 0.001f;
    const Photon beyond{.position = point.position + Vector(distance, 0.0f, 0.0f),
                        .power = Color(1.0f),
                        .incoming = PackedDirection(-point.normal),
                        .normal = CoarseDirection(-point.normal),
                        .edges = 1,
                        .from_back = true};
    const MethodSettings settings{.test_photons = 1};
    const double squared =
        nearest_squared_radius(PhotonMap({beyond}), point, settings, {.scene = scene, .hit_points = hit_points});
    EXPECT_NEAR(std::sqrt(squared), distance, 1e-6);
}

}  // namespace
}  // namespace photonlab::test
