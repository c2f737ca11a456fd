// Stochastic progressive photon mapping against ppm where both are the same method, and against the mean over a region
// where they are not.

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <utility>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

// One position a pixel and one hit point each: statistics of a pixel are those of its hit point. r_1^2 S is rounded in
// another order than r^2.
TEST(StochasticProgressive, OfOnePositionIsProgressivePhotonMapping) {
    const Scene scene = build_scene(room(12, 12));
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    for (const auto& [schedule, name] : schedule_names)
        for (const std::optional<double> radius : {std::optional<double>(), std::optional<double>(0.2)}) {
            // By the disc: an area that is measured anew in every pass is not that of a point that stays, to 1e-12.
            MethodSettings method{.schedule = schedule,
                                  .radius = radius,
                                  .footprints = 3.0,
                                  .area = AreaMode::Disc,
                                  .photons_per_pass = 500};
            PassLoop fixed = loop_of(method, scene, hit_points);
            method.integrator = "sppm";
            PassLoop stochastic = loop_of(method, scene, hit_points);
            for (std::uint64_t pass = 1; pass <= 40; ++pass) {
                fixed.take(pass);
                stochastic.take(pass);
            }
            for (std::size_t i = 0; i < hit_points.points.size(); ++i) {
                const GatherState a = *fixed.integrator(0).gather_state(i);
                const GatherState b = *stochastic.integrator(0).gather_state(i);
                EXPECT_NEAR(b.radius, a.radius, 1e-12 * a.radius) << name;
                EXPECT_EQ(b.photons, a.photons) << name;
                for (int c = 0; c < 3; ++c) EXPECT_NEAR(b.radiance[c], a.radiance[c], 1e-12 * a.radiance[c]) << name;
            }
        }
}

// Hachisuka's second invariant: N / S is the sum of M_k / S_k over the passes, S_k being the factor before the pass
// shrank it; and one pass multiplies S by alpha at most.
TEST(StochasticProgressive, KeepsHachisukasInvariant) {
    for (const double alpha : {0.3, 0.7, 0.95}) {
        const auto rule = make_radius_rule({.alpha = alpha}, 1);
        GatherStatistics pixel{.squared_radius = 1.0};
        double sum = 0.0;
        RandomStream random(3, RandomPurpose::Test, 0, 0);
        for (std::uint64_t pass = 1; pass <= 2000; ++pass) {
            const double found = std::floor(4.0 * static_cast<double>(random.next()));
            const double before = pixel.squared_radius;
            sum += found / before;
            take_pass(pixel, *rule, 0, {.pass = pass, .passes = pass, .found = found}, 0.0);
            EXPECT_GE(pixel.squared_radius, alpha * before * (1.0 - 1e-15));
        }
        EXPECT_NEAR(pixel.count / pixel.squared_radius, sum, 1e-12 * sum) << alpha;
    }
}

TEST(StochasticProgressive, WithAlphaOneNeverShrinks) {
    const Scene scene = build_scene(room(6, 6));
    for (const ScheduleName schedule : {ScheduleName::Hachisuka, ScheduleName::KnausZwicker}) {
        const MethodSettings method{
            .integrator = "sppm", .schedule = schedule, .alpha = 1.0, .radius = 0.2, .photons_per_pass = 200};
        const Rendering rendering = render(scene, method, {.passes = 20, .samples_per_pixel = 4});
        for (const double radius : rendering.radii) EXPECT_NEAR(radius, 0.2, 1e-15);
    }
}

/// A floor lit by a point light of intensity `intensity` at height 1 above the origin, seen from straight above: pixels
/// of 0.2 x 0.2 over x in [1, 1.6], z in [-0.2, 0.2].
Scene floor_region(const Color& reflectance) {
    SceneDescription description;
    description.materials = {diffuse(reflectance)};
    description.shapes = {disk(VectorD(0.0), VectorD(0, 1, 0), 40.0, 0)};
    description.lights = {point_light(VectorD(0, 1, 0), ColorD(1.0))};
    const double height = 10.0;
    description.camera =
        look_at(VectorD(1.3, height, 0.0), VectorD(1.3, 0.0, 0.0), 2, 3, 2.0 * std::atan(0.2 / height) * 180.0 / pi);
    return build_scene(description);
}

// Before anything is concluded from it.
TEST(StochasticProgressive, LooksAtTheRegion) {
    const Scene scene = floor_region(Color(0.5f));
    for (std::uint64_t pass = 1; pass <= 50; ++pass) {
        const HitPoints points = trace_new_hit_points(scene, 1, {.positions = Positions::Box}, {.pass = pass}, 1);
        ASSERT_EQ(points.points.size(), 6u);
        for (const HitPoint point : points.points) {
            const VectorD at = VectorD(point.position) * scene.unit_length + scene.centre;
            EXPECT_NEAR(at.y, 0.0, 1e-6);
            EXPECT_LE(std::abs(at.x - 1.3), 0.3 + 1e-5);
            EXPECT_LE(std::abs(at.z), 0.2 + 1e-5);
        }
    }
}

// Radii that do not depend on photons: the expected mean after 6 passes is a quadrature over the region of the mean
// over passes of the blurred irradiance, 0.2390122 for r_1 = 0.5 and alpha 2/3; without blur it is 0.2329921.
TEST(StochasticProgressive, ConvergesToTheMeanOverARegionOfTheBlurredLight) {
    const Scene scene = floor_region(Color(0.5f));
    ClaimFamily claims;
    for (const Positions positions : {Positions::Box, Positions::Sobol}) {
        const MethodSettings method{.integrator = "sppm",
                                    .schedule = ScheduleName::KnausZwicker,
                                    .alpha = 2.0 / 3.0,
                                    .positions = positions,
                                    .radius = 0.5,
                                    .direct = DirectMode::Photons,
                                    .photons_per_pass = 20'000};
        const HitPoints grid = trace_hit_points(scene, 1, 1);
        std::vector<double> irradiance;
        for (std::uint64_t seed = 1; seed <= 100; ++seed) {
            const Rendering rendering = render(scene, grid, method, {.passes = 6, .seed = seed});
            irradiance.push_back(mean_of(rendering.image, gathered_layer).x * pi / 0.5);
        }
        claims.mean_is(std::string(name_of(positions)), irradiance, 0.2390122, 0.004);
    }
}

// The first two dimensions of Sobol's sequence: of 64 points in succession, from the first on, one in each of 8 x 8
// squares, and of any 16 one in each of 4 x 4; pixels have sequences of their own. Four paths a pixel and pass are four
// points in succession.
TEST(NewHitPoints, OfASequenceAreStratifiedOverPasses) {
    for (const std::uint64_t paths : {1u, 4u}) {
        const Scene scene = floor_region(Color(0.5f));
        std::map<std::tuple<std::uint32_t, int, std::uint64_t>, std::vector<int>>
            met;  // by pixel, squares a side and block
        std::set<std::pair<float, float>> first_points;
        for (std::uint64_t pass = 1; pass <= 64 / paths; ++pass) {
            const NewPoints kind{.positions = Positions::Sobol, .all_cells = paths > 1};
            const HitPoints found =
                trace_new_hit_points(scene, static_cast<int>(paths), kind, {.seed = 3, .pass = pass}, 1);
            EXPECT_EQ(found.points.size(), 6 * paths);
            for (const HitPoint point : found.points) {
                const VectorD at = VectorD(point.position) * scene.unit_length + scene.centre;
                const double across = (at.x - 1.0) / 0.2;
                const double along = (at.z + 0.2) / 0.2;
                const double x = across - std::floor(across);
                const double y = along - std::floor(along);
                if (pass == 1) first_points.insert({static_cast<float>(x), static_cast<float>(y)});
                for (const int squares : {4, 8}) {
                    auto& counts = met[{point.pixel, squares, squares == 4 ? (pass - 1) * paths / 16 : 0}];
                    counts.resize(static_cast<std::size_t>(squares * squares));
                    ++counts[static_cast<std::size_t>(static_cast<int>(y * squares) * squares +
                                                      static_cast<int>(x * squares))];
                }
            }
        }
        EXPECT_EQ(met.size(), 6u * (4 + 1));
        EXPECT_EQ(first_points.size(), 6 * paths);
        for (const auto& [of, counts] : met)
            for (const int count : counts) EXPECT_EQ(count, 1) << std::get<0>(of) << ' ' << paths;
    }
}

// A reference is known by what pictures converge to.
TEST(NewHitPoints, OfASequenceConvergeToThePixelsArea) {
    EXPECT_EQ(limit_of(Positions::Sobol), Positions::Box);
    EXPECT_EQ(limit_of(Positions::Box), Positions::Box);
    EXPECT_EQ(limit_of(Positions::Grid), Positions::Grid);
}

// Direct light alone, which has no radius: by path tracing, with four paths a pixel and pass.
TEST(NewHitPoints, OfASequenceHaveTheMeanOfIndependentOnes) {
    const Scene scene = build_scene(room(6, 6));
    const HitPoints grid = trace_hit_points(scene, 4, 1);
    std::map<Positions, std::vector<double>> radiance;
    for (const Positions positions : {Positions::Box, Positions::Sobol})
        for (std::uint64_t seed = 1; seed <= 40; ++seed) {
            const MethodSettings method{.integrator = "path", .positions = positions};
            radiance[positions].push_back(
                mean_of(render(scene, grid, method, {.passes = 8, .seed = seed, .samples_per_pixel = 4}).image,
                        direct_layer)
                    .x);
        }
    ClaimFamily claims;
    claims.means_agree("direct", radiance.at(Positions::Sobol), radiance.at(Positions::Box), 0.02);
}

// Counts steer radii, and a sequence steers counts where a pixel is half bright; but what a pass adds does not depend
// on the radius there.
TEST(StochasticProgressive, ASequenceOfPositionsLeavesTheMeanWhereRadiiFollowCounts) {
    SceneDescription description;
    description.materials = {diffuse(Color(0.8f)), diffuse(Color(0.1f))};
    description.shapes = {shape(parallelogram(VectorD(-20, 0, -20), VectorD(0, 0, 40), VectorD(20, 0, 0)), 0),
                          shape(parallelogram(VectorD(0, 0, -20), VectorD(0, 0, 40), VectorD(20, 0, 0)), 1)};
    description.lights = {point_light(VectorD(0, 7.5, 0), ColorD(1000.0))};
    description.camera = look_at(VectorD(0.0, 8.0, 0.0), VectorD(0.0), 1, 1, 5.0);
    const Scene scene = build_scene(description);
    const MethodSettings method{.integrator = "sppm",
                                .alpha = 0.5,
                                .positions = Positions::Sobol,
                                .radius = 0.3,
                                .direct = DirectMode::Photons,
                                .max_depth = 2,
                                .photons_per_pass = 20'000};
    const HitPoints grid = trace_hit_points(scene, 1, 1);
    std::vector<double> radiance;
    for (std::uint64_t seed = 1; seed <= 200; ++seed)
        radiance.push_back(mean_of(render(scene, grid, method, {.passes = 8, .seed = seed}).image, gathered_layer).x);
    // As in AveragesOverWhatThePixelSees: 0.4% less at most, by the pixel and the disc.
    ClaimFamily claims;
    claims.mean_is("half bright", radiance, 0.45 / pi * 1000.0 / 56.25, 0.02, 0.004);
}

// One of the grid's positions a pass converges to what ppm gives with all of them in every pass; each comes once in as
// many passes as there are.
TEST(StochasticProgressive, OnTheGridAgreesWithProgressivePhotonMappingOfAllPositions) {
    const Scene scene = build_scene(room(8, 8));
    constexpr int positions = 16;
    const HitPoints grid = trace_hit_points(scene, positions, 1);
    MethodSettings method{.schedule = ScheduleName::KnausZwicker, .footprints = 1.0, .photons_per_pass = 3000};
    ClaimFamily claims;
    for (const std::string_view layer : {direct_layer, gathered_layer}) {
        std::vector<double> all;
        std::vector<double> one;
        for (std::uint64_t seed = 1; seed <= 24; ++seed) {
            method.integrator = "ppm";
            all.push_back(
                mean_of(render(scene, grid, method, {.passes = 16, .seed = seed, .samples_per_pixel = 16}).image, layer)
                    .x);
            method.integrator = "sppm";
            one.push_back(
                mean_of(render(scene, grid, method, {.passes = 16, .seed = 100 + seed, .samples_per_pixel = 16}).image,
                        layer)
                    .x);
        }
        claims.means_agree(std::string(layer), one, all, 0.02);
    }
}

TEST(NewHitPoints, TakeEveryPositionOfTheGridOnceInACycle) {
    const Scene scene = build_scene(room(4, 4));
    for (const int positions : {1, 4, 9, 16}) {
        const HitPoints grid = trace_hit_points(scene, positions, 1);
        for (const std::uint64_t cycle : {0u, 3u}) {
            std::vector<int> met(grid.points.size(), 0);
            for (std::uint64_t place = 1; place <= static_cast<std::uint64_t>(positions); ++place) {
                const HitPoints points =
                    trace_new_hit_points(scene, positions, {},
                                         {.seed = 9, .pass = cycle * static_cast<std::uint64_t>(positions) + place}, 1);
                for (const HitPoint point : points.points)
                    for (std::size_t i = 0; i < grid.points.size(); ++i)
                        met[i] += grid.points[i].pixel == point.pixel && grid.points[i].position == point.position;
            }
            for (const int times : met) EXPECT_EQ(times, 1) << positions;
        }
    }
}

// A pixel half of which a black card hides has half the radiance; and one over two materials the mean of theirs.
TEST(StochasticProgressive, AveragesOverWhatThePixelSees) {
    for (const bool is_half_hidden : {true, false}) {
        SceneDescription description;
        description.materials = {diffuse(Color(0.8f)), diffuse(Color(is_half_hidden ? 0.8f : 0.2f)),
                                 diffuse(Color(0.0f), true)};
        description.shapes = {shape(parallelogram(VectorD(-20, 0, -20), VectorD(0, 0, 40), VectorD(20, 0, 0)), 0),
                              shape(parallelogram(VectorD(0, 0, -20), VectorD(0, 0, 40), VectorD(20, 0, 0)), 1)};
        if (is_half_hidden)
            description.shapes.push_back(
                shape(parallelogram(VectorD(0, 7.9, -1), VectorD(0, 0, 2), VectorD(1, 0, 0)), 2));
        description.lights = {point_light(VectorD(0, 7.5, 0), ColorD(1000.0))};
        description.camera = look_at(VectorD(0.0, 8.0, 0.0), VectorD(0.0), 1, 1, 5.0);
        const Scene scene = build_scene(description);
        const MethodSettings method{.integrator = "sppm",
                                    .alpha = 1.0,
                                    .positions = Positions::Box,
                                    .radius = 0.3,
                                    .direct = DirectMode::Photons,
                                    .max_depth = 2,
                                    .photons_per_pass = 3000};
        const HitPoints grid = trace_hit_points(scene, 1, 1);
        std::vector<double> radiance;
        for (std::uint64_t seed = 1; seed <= 40; ++seed)
            radiance.push_back(
                mean_of(render(scene, grid, method, {.passes = 100, .seed = seed}).image, gathered_layer).x);
        // The irradiance of the middle; over the pixel and the disc, 0.35 and 0.3 wide, it is 0.4% less at most.
        const double albedo = is_half_hidden ? 0.4 : 0.5;
        ClaimFamily claims;
        claims.mean_is(is_half_hidden ? "half hidden" : "two materials", radiance, albedo / pi * 1000.0 / 56.25, 0.03,
                       0.004);
    }
}

// Glass between camera and floor: all ways of the camera path, or one by chance.
TEST(StochasticProgressive, OfOneBranchHasTheMeanOfAll) {
    SceneDescription description = room(8, 8);
    description.materials.push_back({.id = "glass", .bsdf = Dielectric{}});
    description.shapes.push_back(sphere(VectorD(-0.2, -0.3, -0.9), 0.5, false, description.materials.size() - 1));
    const Scene scene = build_scene(description);
    const HitPoints grid = trace_hit_points(scene, 1, 1);
    MethodSettings method{.integrator = "sppm", .alpha = 1.0, .radius = 0.3, .photons_per_pass = 3000};
    std::vector<std::vector<double>> means(2);
    for (const Branches branches : {Branches::All, Branches::One})
        for (std::uint64_t seed = 1; seed <= 60; ++seed) {
            method.branches = branches;
            means[branches == Branches::One].push_back(
                mean_total(
                    render(scene, grid, method, {.passes = 16, .seed = seed + (branches == Branches::One ? 500 : 0)})
                        .image)
                    .x);
        }
    ClaimFamily claims;
    claims.means_agree("one branch against all", means[1], means[0], 0.01);
}

}  // namespace
}  // namespace photonlab::test
