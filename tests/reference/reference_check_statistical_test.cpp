// The comparison of paths with photons: its standard errors are those that repetition shows, it raises no alarm over
// the references in the repository, and where paths are too noisy to tell it says how much light could be missing.

#include "reference/reference_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/pass_loop.h"
#include "tests/support/two_walls.h"

namespace photonlab {
namespace {

/// The layers after so many passes of `path`, as a half of a reference has them.
Image half_of(const Scene& scene, const HitPoints& hit_points, std::uint64_t samples, std::uint64_t seed,
              RandomPurpose purpose) {
    PassLoop path(scene, hit_points, {{.method = {.integrator = "path", .max_depth = scene.max_depth}, .seed = seed}},
                  {.paths = purpose});
    for (std::uint64_t sample = 1; sample <= samples; ++sample) path.take(sample);
    return path.image();
}

// The difference in standard errors, squared and summed over 40 seeds, has a chi-square distribution, were it not that
// standard errors are themselves estimates, which widens it by a few hundredths; outside of 14 to 85 are 2 in 10,000.
TEST(MeansByPathsAndPhotons, DifferByTheirStandardErrors) {
    const TestFolder folder;
    const Scene scene = build_scene(load_scene_file(folder.write("scene.xml", two_walls_scene)));
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    constexpr std::uint64_t seeds = 40;
    for (const ComparedLight light : compared_lights) {
        double sum = 0.0;
        double squares = 0.0;
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
            const MeanByPaths paths =
                mean_by_paths(half_of(scene, hit_points, 16, seed, RandomPurpose::ReferenceHalfA),
                              half_of(scene, hit_points, 16, seed, RandomPurpose::ReferenceHalfB), light);
            const auto photons =
                measure_light_by_photons(scene, hit_points, {.max_depth = scene.max_depth, .seed = seed});
            const ComparedMeans compared = compare_means(paths, photons->means[static_cast<std::size_t>(light)]);
            EXPECT_EQ(compared.verdict, Verdict::Agreed);
            const double deviate = compared.difference / compared.standard_error;
            sum += deviate;
            squares += deviate * deviate;
        }
        EXPECT_GT(squares, 14.0);
        EXPECT_LT(squares, 85.0);
        EXPECT_LT(std::abs(sum) / std::sqrt(static_cast<double>(seeds)), 3.9);
    }
}

class CommittedReferences : public ::testing::TestWithParam<const char*> {};

TEST_P(CommittedReferences, AreNotDisputed) {
    const std::filesystem::path source = PHOTONLAB_SOURCE_DIR;
    const Scene scene =
        build_scene(load_scene_file(source / "scenes" / GetParam() / "scene.xml"), Resolution{128, 128});
    const Reference reference = load_reference(source / "reference" / GetParam(), std::nullopt);
    const auto photons =
        measure_light_by_photons(scene, trace_hit_points(scene, 1, 2), {.max_depth = scene.max_depth, .threads = 2});
    const Json check = check_json(reference.half_a, reference.half_b, *photons);
    EXPECT_EQ(check.at("verdict"), "not disputed") << check.dump(1);
    for (const char* light : {"gathered", "direct_and_gathered"})
        EXPECT_LT(std::abs(check.at(light).at("standard_errors_beyond_photons").get<double>()), 3.0) << check.dump(1);
}

INSTANTIATE_TEST_SUITE_P(All, CommittedReferences,
                         ::testing::Values("cornell-box", "cornell-spheres", "mirror-sphere", "glass-sphere", "lamp"));

// Paths find the caustics of a lamp over water hardly ever; photons do.
// Paths find the light of the pool, though seldom: after 256 samples a half their mean is that of the photons to 2%.
// After 8 the comparison cannot tell, and must not sound as if it could.
TEST(PathsInTheWater, AreNotDisputedAndItIsSaidHowMuchWouldHaveShown) {
    const std::filesystem::path source = PHOTONLAB_SOURCE_DIR;
    const Scene scene = build_scene(load_scene_file(source / "scenes/water/scene.xml"), Resolution{64, 64});
    const HitPoints hit_points = trace_hit_points(scene, 1, 2);
    const auto photons = measure_light_by_photons(scene, hit_points, {.max_depth = scene.max_depth, .threads = 2});
    const Json check = check_json(half_of(scene, hit_points, 8, 1, RandomPurpose::ReferenceHalfA),
                                  half_of(scene, hit_points, 8, 1, RandomPurpose::ReferenceHalfB), *photons);
    EXPECT_EQ(check.at("verdict"), "not disputed") << check.dump(1);
    EXPECT_NE(check.at("why").get<std::string>().find("would have shown"), std::string::npos) << check.dump(1);
}

}  // namespace
}  // namespace photonlab
