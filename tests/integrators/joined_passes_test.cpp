// Passes that are taken in parts and joined give the bits of a run that takes all of them, however they were parted and
// in whatever order they are put together; and radii of a late start are those of a run from the first pass on.

#include <gtest/gtest.h>

#include <sstream>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/support/radius_rules.h"

namespace photonlab::test {
namespace {

constexpr std::uint64_t all_passes = 12;
constexpr int learning_passes = 3;

std::vector<NamedMethod> joined_methods() {
    std::vector<NamedMethod> methods;
    const MethodSettings knaus_zwicker{.schedule = ScheduleName::KnausZwicker, .photons_per_pass = 500};
    for (const std::string integrator : {"ppm", "sppm"}) {
        MethodSettings settings = knaus_zwicker;
        settings.integrator = integrator;
        methods.push_back({integrator, settings});
        settings.light_sequence = LightSequenceMode::Sobol;
        methods.push_back({integrator + "_sobol", settings});
        settings.emission = EmissionMode::Adaptive;
        settings.learn_passes = learning_passes;
        methods.push_back({integrator + "_learning", settings});
        settings.emission = EmissionMode::Plain;
        settings.positions = Positions::Box;
        settings.kernel = Kernel::Cone;
        settings.area = AreaMode::Linear;
        settings.area_lines = 4;
        settings.direct = DirectMode::Photons;
        methods.push_back({integrator + "_otherwise", settings});
    }
    methods.push_back({"path", {.integrator = "path"}});
    methods.push_back({"path_box", {.integrator = "path", .positions = Positions::Box}});
    return methods;
}

class JoinedPasses : public ::testing::TestWithParam<NamedMethod> {
protected:
    JoinedPasses() : scene_(build_scene(room(16, 12))), hit_points_(trace_hit_points(scene_, 1, 1)) {}

    PassLoop loop() const { return loop_of(GetParam().settings, scene_, hit_points_, {.seed = 5}); }

    /// The state after these passes alone; emission goes by `learnt` where that is there.
    std::string part(const PassRange& passes, const std::optional<EmissionMap>& learnt = std::nullopt) const {
        PassLoop of_part = loop();
        if (learnt) of_part.freeze_emission(*learnt);
        for (std::uint64_t pass = passes.first; pass <= passes.last; ++pass) of_part.take(pass);
        std::ostringstream stream;
        StateArchive archive(stream);
        of_part.exchange(0, archive);
        return stream.str();
    }

    static void join(PassLoop& joined, const std::string& state) {
        std::istringstream stream(state);
        StateArchive archive(stream, state.size());
        if (joined.state(0).pass > 0) archive.begin_joining();
        joined.exchange(0, archive);
        EXPECT_EQ(archive.bytes_left(), 0u);
    }

    std::optional<EmissionMap> learnt_by(const PassRange& passes) const {
        PassLoop learning = loop();
        if (learning.needs(0).passes != Needs::Passes::AfterLearning) return std::nullopt;
        for (std::uint64_t pass = passes.first; pass <= passes.last; ++pass) learning.take(pass);
        return learning.state_now(0).emission_map;
    }

    Scene scene_;
    HitPoints hit_points_;
};

TEST_P(JoinedPasses, HaveTheBitsOfARunOfAll) {
    PassLoop whole = loop();
    for (std::uint64_t pass = 1; pass <= all_passes; ++pass) whole.take(pass);
    const Image expected = whole.image();

    const PassRange first{1, learning_passes + 1};
    const std::optional<EmissionMap> learnt = learnt_by(first);
    const std::vector<PassRange> ranges{first, {5, 5}, {6, 8}, {9, all_passes}};
    for (const std::vector<std::size_t>& order : {std::vector<std::size_t>{0, 1, 2, 3}, {2, 0, 1, 3}}) {
        PassLoop joined = loop();
        for (const std::size_t i : order) join(joined, part(ranges[i], i == 0 ? std::nullopt : learnt));
        const Image image = joined.image();
        ASSERT_EQ(image.layers.size(), expected.layers.size());
        for (std::size_t layer = 0; layer < image.layers.size(); ++layer)
            EXPECT_TRUE(image.layers[layer].pixels == expected.layers[layer].pixels) << image.layers[layer].name;
        EXPECT_EQ(image.radius, expected.radius);

        const RunState a = joined.state_now(0);
        const RunState b = whole.state_now(0);
        EXPECT_EQ(a.pass, all_passes);
        EXPECT_EQ(count_passes(a.ranges), all_passes);
        EXPECT_EQ(describe(b.ranges), "");
        EXPECT_EQ(a.photons_stored, b.photons_stored);
        EXPECT_EQ(a.paths_emitted, b.paths_emitted);
        EXPECT_EQ(a.report.photons_gathered, b.report.photons_gathered);
        EXPECT_EQ(a.report.radius_mean, b.report.radius_mean);
        EXPECT_EQ(a.report.inexact_additions, 0u);
    }
}

TEST_P(JoinedPasses, RadiiOfALateStartAreThoseOfARunFromTheFirst) {
    if (GetParam().settings.integrator == "path" || learnt_by({1, 1})) return;
    PassLoop whole = loop();
    for (std::uint64_t pass = 1; pass <= all_passes; ++pass) whole.take(pass);
    PassLoop late = loop();
    late.take(all_passes);
    for (std::size_t i = 0; i < hit_points_.points.size(); ++i)
        EXPECT_EQ(late.integrator(0).gather_state(i)->radius, whole.integrator(0).gather_state(i)->radius) << i;
}

INSTANTIATE_TEST_SUITE_P(OfEveryMethodThatCan, JoinedPasses, ::testing::ValuesIn(joined_methods()),
                         [](const auto& tested) { return tested.param.name; });

// What makes every other method's passes ordered is said.
TEST(OrderedPasses, SayWhy) {
    const MethodSettings knaus_zwicker{.schedule = ScheduleName::KnausZwicker};
    EXPECT_TRUE(needs_of(knaus_zwicker).can_be_joined());
    MethodSettings visible = knaus_zwicker;
    visible.photon_paths = PhotonPathMode::Visible;
    MethodSettings estimated = knaus_zwicker;
    estimated.estimate_error = ErrorEstimation::On;
    for (const MethodSettings& settings :
         {MethodSettings{}, MethodSettings{.integrator = "photonmapper"}, visible, estimated}) {
        EXPECT_FALSE(needs_of(settings).can_be_joined());
        EXPECT_FALSE(needs_of(settings).ordered_since.empty());
    }
}

}  // namespace
}  // namespace photonlab::test
