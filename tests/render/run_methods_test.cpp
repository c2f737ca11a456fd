#include "render/run_methods.h"

#include <gtest/gtest.h>

#include <map>
#include <numeric>

#include "integrators/registry.h"
#include "tests/support/two_walls.h"

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
    Outcome run(MethodSettings method, std::vector<std::uint64_t> shown, int threads = 1) {
        method.photons_per_pass = 500;
        Outcome outcome;
        outcome.final_state = run_methods(scene_, hit_points_, {{method, 3, 6, threads, std::move(shown)}},
                                          [&](std::size_t, const RunState& state, const Image& image) {
                                              outcome.states[state.pass] = state;
                                              outcome.last = image;
                                          })[0];
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

TEST_F(Runner, MethodsThatShareTheirPhotonsGiveTheBitsThatTheyGiveAlone) {
    std::vector<RunSettings> together;
    for (MethodSettings method : methods()) {
        method.photons_per_pass = 500;
        if (method.integrator == "path" || method.direct == DirectMode::Photons) continue;
        together.push_back({method, 3, 6, 1, {0, 2, 6}});
        method.alpha = 0.4;
        method.radius = 0.3;
        together.push_back({method, 3, 6, 1, {0, 2, 6}});
    }
    ASSERT_EQ(together.size(), 8u);
    std::vector<Image> images(together.size());
    const std::vector<RunState> states =
        run_methods(scene_, hit_points_, together,
                    [&](std::size_t method, const RunState&, const Image& image) { images[method] = image; });
    for (std::size_t i = 0; i < together.size(); ++i) {
        const Outcome alone = run(together[i].method, {0, 2, 6});
        expect_same_bits(images[i], alone.last);
        EXPECT_EQ(states[i].photons_stored, alone.final_state.photons_stored);
        EXPECT_EQ(states[i].report.photons_gathered, alone.final_state.report.photons_gathered);
        EXPECT_EQ(states[i].map_bytes, alone.final_state.map_bytes);
    }
}

// Each is charged in full for what it shares.
TEST_F(Runner, MethodsThatShareTheirPhotonsAreAllChargedForThem) {
    MethodSettings ppm;
    ppm.photons_per_pass = 500;
    MethodSettings mapper = ppm;
    mapper.integrator = "photonmapper";
    const std::vector<RunState> states =
        run_methods(scene_, hit_points_, {{ppm, 3, 6, 1, {6}}, {ppm, 3, 6, 1, {6}}, {mapper, 3, 6, 1, {6}}},
                    [](std::size_t, const RunState&, const Image&) {});
    EXPECT_GT(states[0].times.of(Stage::Trace), 0.0);
    EXPECT_GT(states[0].times.of(Stage::Build), 0.0);
    for (const RunState& state : states) EXPECT_EQ(state.times.of(Stage::Trace), states[0].times.of(Stage::Trace));
    constexpr auto build = static_cast<std::size_t>(Stage::Build);
    EXPECT_EQ(states[1].times.cpu_seconds[build], states[0].times.cpu_seconds[build]);
    EXPECT_GT(states[2].times.of(Stage::Build), 0.0);
}

TEST(OverlappedWork, OfOneMethodIsDividedInProportionToItsCpuTime) {
    const StageTimes times =
        times_alone({.seconds = 4.0, .build_seconds = 3.5, .build_cpu = 3.0, .direct_cpu = {2.0}}, 0);
    EXPECT_DOUBLE_EQ(times.of(Stage::Build), 2.4);
    EXPECT_DOUBLE_EQ(times.of(Stage::Direct), 1.6);
    EXPECT_DOUBLE_EQ(times.cpu_total(), 5.0);
    EXPECT_EQ(times_alone({.direct_cpu = {0.0}}, 0).total(), 0.0);
}

// Two threads: 3 s of building beside 9 s of direct light take 6 s. Alone, the first method would have taken what
// building takes, and the second half of its 11 s.
TEST(OverlappedWork, OfSeveralMethodsIsChargedToEachAsIfItWereAlone) {
    const OverlappedWork work{.seconds = 6.0, .build_seconds = 3.0, .build_cpu = 3.0, .direct_cpu = {1.0, 8.0}};
    EXPECT_DOUBLE_EQ(times_alone(work, 0).total(), 3.0);
    EXPECT_DOUBLE_EQ(times_alone(work, 0).cpu_total(), 4.0);
    EXPECT_DOUBLE_EQ(times_alone(work, 1).total(), 5.5);
    EXPECT_DOUBLE_EQ(times_alone(work, 1).cpu_total(), 11.0);
    EXPECT_DOUBLE_EQ(times_alone(work, 1).of(Stage::Build), 1.5);
}

TEST_F(Runner, OnlyMethodsWithTheSamePhotonsHitPointsAndPassesCanRunTogether) {
    const RunSettings settings{MethodSettings{}, 3, 6, 1, {6}};
    const auto can_together = [&](const std::function<void(RunSettings&)>& change) {
        RunSettings other = settings;
        change(other);
        return can_run_together(settings, other);
    };
    EXPECT_TRUE(can_together([](RunSettings& other) { other.method.alpha = 0.3; }));
    EXPECT_TRUE(can_together([](RunSettings& other) { other.method.eps = 1.0; }));
    EXPECT_TRUE(can_together([](RunSettings& other) { other.method.integrator = "photonmapper"; }));
    EXPECT_FALSE(can_together([](RunSettings& other) { other.method.integrator = "path"; }));
    EXPECT_FALSE(can_together([](RunSettings& other) { other.method.photons_per_pass = 5; }));
    EXPECT_FALSE(can_together([](RunSettings& other) { other.method.max_depth = 3; }));
    EXPECT_FALSE(can_together([](RunSettings& other) { other.method.direct = DirectMode::Photons; }));
    EXPECT_FALSE(can_together([](RunSettings& other) { other.method.branch_cutoff = 0.01; }));
    EXPECT_FALSE(can_together([](RunSettings& other) { other.method.emission = EmissionMode::Adaptive; }));
    EXPECT_FALSE(can_together([](RunSettings& other) { other.method.photon_paths = PhotonPathMode::Visible; }));
    EXPECT_FALSE(can_together([](RunSettings& other) { other.seed = 4; }));
    EXPECT_FALSE(can_together([](RunSettings& other) { other.passes = 7; }));
    EXPECT_FALSE(can_together([](RunSettings& other) { other.shown = {1, 6}; }));
}

// They follow from where a method gathers and from what it found.
TEST_F(Runner, PhotonsOfAMethodsOwnAreSharedWithNone) {
    RunSettings adaptive{MethodSettings{.emission = EmissionMode::Adaptive}, 3, 6, 1, {6}};
    EXPECT_FALSE(can_run_together(adaptive, adaptive));
    adaptive.method.integrator = "photonmapper";  // which does not use the setting
    EXPECT_TRUE(can_run_together(adaptive, adaptive));
}

TEST_F(Runner, TellsWhatIsGatheredAtAHitPoint) {
    for (const char* integrator : {"ppm", "photonmapper"}) {
        MethodSettings method;
        method.integrator = integrator;
        method.radius = 0.5;
        method.photons_per_pass = 500;
        std::vector<std::uint64_t> passes;
        GatherState last;
        Image image;
        std::size_t hit_point = 40;
        run_methods(
            scene_, hit_points_, {{method, 3, 6, 1, {0, 2, 6}}},
            [&](std::size_t, const RunState&, const Image& estimated) { image = estimated; },
            [](std::uint64_t, bool) {},
            [&](std::size_t, std::uint64_t pass, const Integrator& running) {
                passes.push_back(pass);
                last = running.gather_state(hit_point).value();
            });
        EXPECT_EQ(passes, integrator == std::string("ppm") ? (std::vector<std::uint64_t>{1, 2, 3, 4, 5, 6})
                                                           : (std::vector<std::uint64_t>{0, 2, 6}));
        // One hit point a pixel here, of weight 1.
        const HitPoint& point = hit_points_.points[hit_point];
        EXPECT_FLOAT_EQ(static_cast<float>(last.radiance.x), image.find(gathered_layer)->at(point.pixel).x)
            << integrator;
        EXPECT_GT(last.photons, 0.0);
        EXPECT_NEAR(last.density.value(), last.photons / (pi * last.radius * last.radius), 1e-9 * *last.density);
        if (integrator == std::string("ppm"))
            EXPECT_LT(last.radius, 0.5);
        else
            EXPECT_NEAR(last.radius, 0.5, 1e-9);
    }
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
