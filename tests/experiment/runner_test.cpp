#include "experiment/runner.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>

#include "integrators/registry.h"
#include "test_folder.h"

namespace photonlab {
namespace {

/// Runs methods on two walls.
class Runner : public ::testing::Test {
protected:
    Runner()
        : scene_(build_scene(load_scene_file(folder_.write("scene.xml", two_walls_scene)))),
          hit_points_(trace_hit_points(scene_, 1, 1)) {}

    struct Outcome {
        std::map<std::uint64_t, RunState> states;  // by pass
        Image last;
        RunState final_state;
    };
    Outcome run(MethodSettings method, std::vector<std::uint64_t> estimated, int threads = 1) {
        method.photons_per_pass = 500;
        Outcome outcome;
        outcome.final_state = run_method(scene_, hit_points_, {method, 3, 6, threads, std::move(estimated)},
                                         [&](const RunState& state, const Image& image) {
                                             outcome.states[state.pass] = state;
                                             outcome.last = image;
                                         });
        return outcome;
    }
    std::vector<MethodSettings> methods() {
        std::vector<MethodSettings> result;
        for (const IntegratorKind& kind : integrator_kinds()) {
            MethodSettings settings;
            settings.integrator = kind.name;
            result.push_back(settings);
        }
        MethodSettings nearest;
        nearest.integrator = "photonmapper";
        nearest.mode = GatherMode::Nearest;
        result.push_back(nearest);
        MethodSettings direct_photons;
        direct_photons.direct = DirectMode::Photons;
        result.push_back(direct_photons);
        return result;
    }

    TestFolder folder_;
    Scene scene_;
    HitPoints hit_points_;
};

void expect_same_bits(const Image& a, const Image& b) {
    ASSERT_EQ(a.layers.size(), b.layers.size());
    for (std::size_t layer = 0; layer < a.layers.size(); ++layer)
        EXPECT_TRUE(a.layers[layer].pixels == b.layers[layer].pixels) << a.layers[layer].name;
}

TEST_F(Runner, TheChoiceOfRecordedPassesChangesNoPixel) {
    for (const MethodSettings& method : methods())
        expect_same_bits(run(method, {6}).last, run(method, {0, 1, 2, 3, 4, 5, 6}).last);
}

TEST_F(Runner, OneThreadAndTwoGiveTheSameBits) {
    for (const MethodSettings& method : methods()) expect_same_bits(run(method, {6}, 1).last, run(method, {6}, 2).last);
}

TEST_F(Runner, CountsEveryPathThatWasEmitted) {
    const Outcome outcome = run(MethodSettings{}, {0, 2, 6});
    EXPECT_EQ(outcome.states.at(0).paths_emitted, 0u);
    EXPECT_EQ(outcome.states.at(2).paths_emitted, 1000u);
    EXPECT_EQ(outcome.states.at(6).paths_emitted, 3000u);
    EXPECT_GT(outcome.states.at(6).photons_stored, outcome.states.at(2).photons_stored);
}

TEST_F(Runner, TracesNoPhotonsForAMethodThatNeedsNone) {
    MethodSettings path;
    path.integrator = "path";
    EXPECT_EQ(run(path, {6}).final_state.paths_emitted, 0u);
}

TEST_F(Runner, TheFirstEstimateTakesNoPhotonTime) {
    const Outcome outcome = run(MethodSettings{}, {0, 6});
    EXPECT_EQ(outcome.states.at(0).times.of(Stage::Trace), 0.0);
    EXPECT_GT(outcome.states.at(6).times.of(Stage::Trace), 0.0);
}

TEST_F(Runner, TheInitialRadiusIsTheOneThatWasGiven) {
    MethodSettings method;
    method.radius = 0.75;
    const Outcome outcome = run(method, {6});
    EXPECT_NEAR(outcome.final_state.initial_radius.value(), 0.75, 1e-9);
    EXPECT_LT(outcome.final_state.report.radius_mean.value(), 0.75);
}

TEST(StageClock, CountsOnlyBetweenEnterAndStop) {
    StageClock clock;
    clock.stop();
    EXPECT_EQ(clock.times().total(), 0.0);
    clock.enter(Stage::Gather);
    volatile double work = 0.0;
    for (int i = 0; i < 100'000; ++i) work = work + 1.0;
    clock.enter(Stage::Direct);
    clock.stop();
    const double gather = clock.times().of(Stage::Gather);
    EXPECT_GT(gather, 0.0);
    for (int i = 0; i < 100'000; ++i) work = work + 1.0;
    clock.stop();
    EXPECT_EQ(clock.times().of(Stage::Gather), gather);
    EXPECT_EQ(clock.times().of(Stage::Trace), 0.0);
}

}  // namespace
}  // namespace photonlab
