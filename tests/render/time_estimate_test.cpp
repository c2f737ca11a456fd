#include "render/estimates/time_estimate.h"

#include <gtest/gtest.h>

#include "tests/support/two_walls.h"

namespace photonlab {
namespace {

StageTimes times(double trace, double build, double gather, double direct) {
    StageTimes all;
    all.seconds[static_cast<std::size_t>(Stage::Trace)] = trace;
    all.seconds[static_cast<std::size_t>(Stage::Build)] = build;
    all.seconds[static_cast<std::size_t>(Stage::Gather)] = gather;
    all.seconds[static_cast<std::size_t>(Stage::Direct)] = direct;
    return all;
}

TEST(TimeEstimate, EachStageIsScaledByWhatItDependsOn) {
    EXPECT_DOUBLE_EQ(scaled_seconds(times(1.0, 0.0, 0.0, 0.0), true, 10.0, 100.0), 10.0);
    EXPECT_DOUBLE_EQ(scaled_seconds(times(0.0, 1.0, 0.0, 0.0), true, 10.0, 100.0), 10.0);
    EXPECT_DOUBLE_EQ(scaled_seconds(times(0.0, 0.0, 1.0, 0.0), true, 10.0, 100.0), 1000.0);
    EXPECT_DOUBLE_EQ(scaled_seconds(times(0.0, 0.0, 0.0, 1.0), true, 10.0, 100.0), 100.0);
    // `path` is all in Trace, a path at each hit point.
    EXPECT_DOUBLE_EQ(scaled_seconds(times(1.0, 0.0, 0.0, 0.0), false, 10.0, 100.0), 100.0);
}

class EstimatedTime : public ::testing::Test {
protected:
    EstimatedTime() : scene_(build_scene(load_scene_file(folder_.write("walls/scene.xml", two_walls_scene)))) {}

    TimeEstimate estimate(RunSettings settings, Resolution resolution = {512, 512}) {
        scene_.camera.width = resolution.width;
        scene_.camera.height = resolution.height;
        settings.method.max_depth = 5;
        settings.passes = 64;
        settings.shown = {64};
        return estimate_time(scene_, trace_coarse_view(scene_, 4, 1, 1e-4), settings);
    }

    TestFolder folder_;
    Scene scene_;
};

// A coarse view has a share of the pixels, and so have the new points of a pass.
TEST_F(EstimatedTime, MethodsWithNewPointsAreMeasuredThroughTheCoarseView) {
    RunSettings settings;
    settings.method.integrator = "sppm";
    settings.method.positions = Positions::Box;
    EXPECT_GT(estimate(settings).seconds, 0.0);
}

// Work is counted: photons gathered while it is measured. Unbounded, this would be 2 * 10^8 and more of each.
TEST_F(EstimatedTime, MeasuringIsBoundedWhateverTheRunTakes) {
    RunSettings settings;
    settings.method.photons_per_pass = 1'000'000;
    for (const char* integrator : {"ppm", "photonmapper"}) {
        settings.method.integrator = integrator;
        settings.method.mode = GatherMode::Radius;
        for (const double footprints : {1.0, 64.0, 16'385.0, 1e9}) {
            settings.method.footprints = footprints;
            EXPECT_LT(estimate(settings).gathered, 40'000'000u) << integrator << ", " << footprints << " footprints";
        }
    }
}

}  // namespace
}  // namespace photonlab
