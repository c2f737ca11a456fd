// Names and ranges of settings: what is refused, with words that say what would have been accepted, and which settings
// a method uses.

#include <gtest/gtest.h>

#include <limits>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"

namespace photonlab::test {
namespace {

std::string refusal(const MethodSettings& settings) {
    try {
        require_valid(settings);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

TEST(Registry, RefusesValuesOutOfRangeAndSaysWhatItExpects) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const double too_large = std::numeric_limits<double>::infinity();
    EXPECT_EQ(refusal({}), "");
    EXPECT_NE(refusal({.integrator = "pppm"}).find("did you mean \"ppm\"? Known here: photonmapper, ppm, sppm, path"),
              std::string::npos);
    for (const double alpha : {0.0, -0.5, 1.0001, nan})
        EXPECT_NE(refusal({.alpha = alpha}).find("alpha"), std::string::npos);
    for (const double radius : {0.0, -1.0, nan, too_large}) {
        EXPECT_NE(refusal({.radius = radius}).find("radius"), std::string::npos);
        EXPECT_NE(refusal({.footprints = radius}).find("footprints"), std::string::npos);
        EXPECT_NE(refusal({.max_radius = radius}).find("max_radius"), std::string::npos);
    }
    for (const int k : {1, 0, -3}) EXPECT_NE(refusal({.k = k}).find("k:"), std::string::npos);
    for (const int depth : {0, -2}) EXPECT_NE(refusal({.max_depth = depth}).find("max_depth"), std::string::npos);
    EXPECT_NE(refusal({.direct_samples = 0}).find("direct_samples"), std::string::npos);
    for (const double eps : {-1e-9, nan, too_large})
        EXPECT_NE(refusal({.eps = eps}).find("eps: expected at least 0"), std::string::npos);
    for (const double cutoff : {0.0, -1.0, 1e-13, 1.001, nan})
        EXPECT_NE(refusal({.branch_cutoff = cutoff}).find("branch_cutoff: expected from 1e-12 to 1"),
                  std::string::npos);
    EXPECT_NE(refusal({.photons_per_pass = 0}).find("photons_per_pass"), std::string::npos);
}

TEST(Registry, MakesNothingFromRefusedSettings) {
    const Scene scene = build_scene(room(2, 2));
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    EXPECT_THROW(make_integrator(find_integrator_kind("ppm"), {.alpha = 2.0}, {scene, hit_points}), InputError);
}

// Radii below 1e-7 of the scene are raised to that, which is said.
TEST(Registry, CountsRadiiThatFloatsDoNotResolve) {
    const Scene scene = build_scene(room(2, 2));
    HitPoints hit_points = trace_hit_points(scene, 1, 1);
    ASSERT_EQ(hit_points.footprints.size(), 4u);
    EXPECT_EQ(count_raised_radii({}, hit_points), 0u);
    EXPECT_FALSE(note_of_raised_radii({}, scene, hit_points));
    hit_points.footprints = {1e-9f, 4.9e-8f, 5.1e-8f, 1e-3f};
    EXPECT_EQ(count_raised_radii({}, hit_points), 2u);
    EXPECT_EQ(count_raised_radii({.footprints = 1.0}, hit_points), 3u);
    EXPECT_EQ(count_raised_radii({.radius = 0.5}, hit_points), 0u);
    EXPECT_EQ(count_raised_radii({.integrator = "path"}, hit_points), 0u);
    const auto note = note_of_raised_radii({}, scene, hit_points);
    ASSERT_TRUE(note);
    EXPECT_TRUE(note->starts_with("at 2 of 4 hit points 2 footprints of the pixel are less than 1e-07 of the scene"))
        << *note;
}

TEST(Registry, KnowsWhichSettingsAMethodUses) {
    const MethodSettings nearest{.integrator = "photonmapper", .mode = GatherMode::Nearest};
    const MethodSettings fixed{.integrator = "photonmapper"};
    EXPECT_TRUE(uses_setting(nearest, "k"));
    EXPECT_FALSE(uses_setting(nearest, "radius"));
    EXPECT_FALSE(uses_setting(nearest, "footprints"));
    EXPECT_TRUE(uses_setting(fixed, "footprints"));
    EXPECT_FALSE(uses_setting({.radius = 2.0}, "footprints"));
    EXPECT_FALSE(uses_setting(fixed, "k"));
    EXPECT_TRUE(uses_setting(fixed, "radius"));
    EXPECT_FALSE(uses_setting(fixed, "alpha"));
    EXPECT_TRUE(uses_setting({}, "alpha"));
    EXPECT_TRUE(uses_setting({}, "direct_samples"));
    EXPECT_FALSE(uses_setting({.direct = DirectMode::Photons}, "direct_samples"));
    EXPECT_FALSE(uses_setting({.integrator = "path"}, "photons_per_pass"));
    EXPECT_FALSE(uses_setting({.integrator = "path"}, "eps"));
    EXPECT_TRUE(uses_setting(nearest, "eps"));
    EXPECT_TRUE(uses_setting({.integrator = "path"}, "branch_cutoff"));
    EXPECT_TRUE(uses_setting({.integrator = "path"}, "max_depth"));
}

// A search that misses photons finds fewer of them within a radius, and the k nearest in a larger one.
TEST(Registry, EpsIsThatOfEverySearch) {
    const Scene scene = build_scene(room(16, 16));
    const auto report = [&](MethodSettings method, double eps) {
        method.eps = eps;
        method.photons_per_pass = 4000;
        return render(scene, method, {}).report;
    };
    for (const char* integrator : {"ppm", "photonmapper"}) {
        const MethodSettings by_radius{.integrator = integrator, .radius = 0.4};
        EXPECT_LT(report(by_radius, 4.0).photons_gathered, report(by_radius, 0.0).photons_gathered) << integrator;
    }
    const MethodSettings nearest{.integrator = "photonmapper", .mode = GatherMode::Nearest, .max_radius = 10.0};
    EXPECT_GT(*report(nearest, 4.0).radius_mean, *report(nearest, 0.0).radius_mean);
}

}  // namespace
}  // namespace photonlab::test
