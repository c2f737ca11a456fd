// Photons that are moved apart lie more evenly, stay on their surface, keep all flux, and with features protected stay
// on their side of an edge. Variances of counts are those of a simulation on a torus without surfaces, rays or maps.

#include "integrators/relaxation/photon_relaxation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "integrators/relaxation/relaxed_photon_mapping.h"
#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/support/laid_photons.h"

namespace photonlab::test {
namespace {

std::vector<Neighbour> hexagon(double radius) {
    std::vector<Neighbour> corners;
    for (int corner = 0; corner < 6; ++corner) {
        const double angle = pi / 3.0 * corner;
        corners.push_back({VectorD(radius * std::cos(angle), radius * std::sin(angle), 0.0), 1.0});
    }
    return corners;
}

TEST(RelaxationForce, OfSymmetricNeighboursIsNone) {
    std::vector<Neighbour> neighbours = hexagon(0.5);
    for (const Neighbour& outer : hexagon(1.0)) neighbours.push_back(outer);
    EXPECT_NEAR(relaxation_force(neighbours, 1.0).length(), 0.0, 1e-15);
}

TEST(RelaxationForce, PushesAwayFromTheNearerAndTheBrighter) {
    // (0.5 (1/0.5 - 1) + 0) / 2
    const std::vector<Neighbour> nearer{{VectorD(0.5, 0, 0), 1.0}, {VectorD(-1, 0, 0), 1.0}};
    EXPECT_NEAR(relaxation_force(nearer, 1.0).x, -0.25, 1e-15);
    std::vector<Neighbour> brighter{{VectorD(0.5, 0, 0), 3.0}, {VectorD(-0.5, 0, 0), 1.0}, {VectorD(0, 1, 0), 1.0}};
    // Weights by the mean flux of 1.5: 2 and 2/3.
    EXPECT_NEAR(relaxation_force(brighter, 1.0).x, -0.5 * (2.0 - 2.0 / 3.0) / 3.0, 1e-15);
}

// One percent of discs of even light: 10,000 of them, a binomial deviation of 10.
TEST(SignificantGradient, IsSeenInOnePercentOfEvenLight) {
    RandomStream random(1, RandomPurpose::Test, 0, 0);
    int seen = 0;
    for (int trial = 0; trial < 10'000; ++trial) {
        std::vector<Neighbour> neighbours;
        for (std::size_t i = 0; i < feature_neighbours; ++i) {
            const double distance = 2.0 * std::sqrt(random.next_double());
            const double angle = 2.0 * pi * random.next_double();
            neighbours.push_back({VectorD(distance * std::cos(angle), distance * std::sin(angle), 0.0), 0.7});
        }
        if (significant_gradient(neighbours, 2.0)) ++seen;
    }
    EXPECT_NEAR(seen, 100, 40);
}

TEST(SignificantGradient, PointsToTheLight) {
    std::vector<Neighbour> half;
    for (std::size_t i = 0; i < feature_neighbours; ++i)
        half.push_back({VectorD(0.5, i % 2 == 0 ? 0.5 : -0.5, 0.0), 1.0});
    const std::optional<VectorD> gradient = significant_gradient(half, 1.0);
    ASSERT_TRUE(gradient);
    EXPECT_NEAR(gradient->x, 1.0, 1e-12);
}

// Of 4000 photons on a square, counts in discs where 5, 20, 50 and 100 are expected: the simulation has variances
// of 5.2, 21, 53, 102 before and 1.8, 12, 38, 83 after 10 steps.
TEST(Relaxation, MakesCountsEven) {
    const Scene scene = floor_for_photons();
    const double expected_before[] = {5.0, 20.0, 50.0, 100.0};
    const double expected_after[] = {1.8, 12.0, 38.0, 83.0};
    double before[4] = {};
    double after[4] = {};
    constexpr int seeds = 4;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const PhotonMap raw(lay_photons(scene, 4000, 1.0, seed));
        const PhotonMap moved = relaxed(scene, raw, {.steps = 10, .protects_features = false}, 1);
        ASSERT_EQ(moved.size(), raw.size());
        for (int size = 0; size < 4; ++size) {
            before[size] += count_variance(scene, raw, expected_before[size]) / seeds;
            after[size] += count_variance(scene, moved, expected_before[size]) / seeds;
        }
    }
    for (int size = 0; size < 4; ++size) {
        EXPECT_NEAR(before[size], expected_before[size], 0.2 * expected_before[size]);
        EXPECT_NEAR(after[size], expected_after[size], 0.2 * expected_after[size]);
    }
}

TEST(Relaxation, KeepsPhotonsOnTheirSurface) {
    const Scene scene = build_scene(hollow_sphere(Color(0.5f), ColorD(1.0)));
    PhotonPass traced = trace_photons(scene, {.paths = 2000, .store_direct = true}, 1, 1);
    const PhotonMap moved = relaxed(scene, PhotonMap(std::move(traced.photons)), {.steps = 5}, 1);
    std::size_t turned = 0;
    for (const Photon& photon : moved.photons()) {
        EXPECT_NEAR(photon.position.length() * scene.unit_length, sphere_radius, 1e-4);
        const Vector inward = -photon.position.normalized();
        if (photon.normal.unit().dot(inward) < 0.999f) ++turned;
    }
    EXPECT_EQ(turned, 0u);
}

// A square nine times as bright on one side, as wide a strip in the dark as a fiftieth of it: what it has of its
// photons after 10 steps.
TEST(Relaxation, LeavesTheDarkDarkWithFeaturesProtected) {
    const Scene scene = floor_for_photons();
    const PhotonMap raw(lay_photons(scene, 8000, 9.0, 1));
    const double before = beyond_the_edge(scene, raw);
    const double ignored =
        beyond_the_edge(scene, relaxed(scene, raw, {.steps = 10, .protects_features = false}, 1)) / before;
    const double kept = beyond_the_edge(scene, relaxed(scene, raw, {.steps = 10}, 1)) / before;
    EXPECT_GT(ignored, 2.0);
    EXPECT_LT(kept, 1.25);
}

TEST(Relaxation, IsTheSameOnAnyNumberOfThreads) {
    const Scene scene = build_scene(room(8, 8));
    const auto map_of = [&](std::uint64_t pass) {
        return PhotonMap(trace_photons(scene, {.paths = 1000, .store_direct = true}, pass, 1).photons);
    };
    const PhotonMap one = relaxed(scene, map_of(1), {.steps = 3}, 1);
    const PhotonMap three = relaxed(scene, map_of(1), {.steps = 3}, 3);
    std::vector<ColorD> sums_of_one(one.size(), ColorD(0.0));
    std::vector<ColorD> sums_of_three(one.size(), ColorD(0.0));
    add_to_nearest(one, map_of(2), 1, sums_of_one);
    add_to_nearest(three, map_of(2), 3, sums_of_three);
    ASSERT_EQ(one.size(), three.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
        EXPECT_EQ(one.photons()[i].position, three.photons()[i].position);
        EXPECT_EQ(sums_of_one[i], sums_of_three[i]);
    }
}

TEST(Relaxation, KeepsAllFluxOfLaterPhotons) {
    const Scene scene = build_scene(room(8, 8));
    const auto photons_of = [&](std::uint64_t pass) {
        return PhotonMap(trace_photons(scene, {.paths = 1000, .store_direct = true}, pass, 1).photons);
    };
    const PhotonMap primal = relaxed(scene, photons_of(1), {.steps = 2}, 1);
    std::vector<ColorD> sums(primal.size(), ColorD(0.0));
    ColorD brought(0.0);
    for (std::uint64_t pass = 2; pass <= 4; ++pass) {
        const PhotonMap photons = photons_of(pass);
        EXPECT_EQ(add_to_nearest(primal, photons, 1, sums), 0u);
        for (const Photon& photon : photons.photons()) brought += ColorD(photon.power);
    }
    ColorD held(0.0);
    const PhotonMap with_flux = with_power(primal, sums, 3000.0);
    for (const Photon& photon : with_flux.photons()) held += ColorD(photon.power) * 3000.0;
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(held[c], brought[c], 1e-6 * brought[c]);
}

TEST(RelaxedPhotonMapping, WithoutStepsIsPhotonMappingAfterOnePass) {
    const Scene scene = build_scene(room(12, 12));
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    MethodSettings method{.integrator = "photonmapper",
                          .radius = 0.15,
                          .relaxation_steps = 0,
                          .direct = DirectMode::Photons,
                          .photons_per_pass = 2000};
    const Rendering plain = render(scene, hit_points, method, {});
    method.mode = GatherMode::Relaxed;
    const Rendering relaxed = render(scene, hit_points, method, {});
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(mean_of(relaxed.image, gathered_layer)[c], mean_of(plain.image, gathered_layer)[c], 1e-6);
    EXPECT_EQ(relaxed.report.photons_gathered, plain.report.photons_gathered);
}

TEST(RelaxedPhotonMapping, HoldsAsMuchAfterManyPassesAsAfterThree) {
    const Scene scene = build_scene(room(8, 8));
    const MethodSettings method{
        .integrator = "photonmapper", .mode = GatherMode::Relaxed, .relaxation_steps = 2, .photons_per_pass = 1000};
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    PassLoop loop = loop_of(method, scene, hit_points);
    std::uint64_t after_four = 0;
    for (std::uint64_t pass = 1; pass <= 64; ++pass) {
        loop.take(pass);
        if (pass == 4) after_four = loop.state_now(0).report.bytes;
    }
    EXPECT_NEAR(static_cast<double>(loop.state_now(0).report.bytes) / static_cast<double>(after_four), 1.0, 0.02);
    EXPECT_GT(loop.state_now(0).times.of(Stage::Relax), 0.0);
}

TEST(RelaxedPhotonMapping, RefusesSurfacesThatLookDifferentFromElsewhere) {
    const MethodSettings method{.integrator = "photonmapper", .mode = GatherMode::Relaxed};
    EXPECT_NO_THROW(require_renderable(method, build_scene(room(4, 4))));
    SceneDescription glossy = room(4, 4);
    glossy.materials[0] = {.id = "brushed", .bsdf = Phong{10.0f, {Color(0.2f), Color(0.3f)}}};
    try {
        require_renderable(method, build_scene(glossy));
        FAIL();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(),
                     "material \"brushed\": expected a diffuse one, mirrors or glass with mode \"relaxed\", whose "
                     "photons stand for light from all directions");
    }
}

// Photons that stand for all depths, and for normals as they are, cannot answer these.
TEST(RelaxedPhotonMapping, RefusesFiniteDepthsBehindMirrorsAndTurnedNormals) {
    MethodSettings method{.integrator = "photonmapper", .mode = GatherMode::Relaxed, .max_depth = 3};
    EXPECT_NO_THROW(require_renderable(method, build_scene(room(4, 4))));
    SceneDescription mirrored = room(4, 4);
    mirrored.materials[3] = {.id = "mirror", .bsdf = Conductor{.reflectance = Color(0.9f)}};
    EXPECT_THROW(require_renderable(method, build_scene(mirrored)), InputError);
    method.max_depth = -1;
    EXPECT_NO_THROW(require_renderable(method, build_scene(mirrored)));
    SceneDescription bumpy = room(4, 4);
    bumpy.materials[0].normals = NormalTexture{};
    EXPECT_THROW(require_renderable(method, build_scene(bumpy)), InputError);
}

}  // namespace
}  // namespace photonlab::test
