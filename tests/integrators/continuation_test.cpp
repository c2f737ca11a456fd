// An integrator made anew that reads another's state goes on as that one does, to the bit, and says the same of itself.

#include <gtest/gtest.h>

#include <cctype>
#include <sstream>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/support/radius_rules.h"

namespace photonlab::test {
namespace {

std::vector<NamedMethod> continued_methods() {
    std::vector<NamedMethod> methods = methods_by_every_radius_rule({});
    for (const NamedMethod& method : methods_of_own_photons({})) methods.push_back(method);
    const MethodSettings seen{.kernel = Kernel::Cone, .area = AreaMode::Seen, .area_lines = 4};
    const MethodSettings linear{.integrator = "sppm", .area = AreaMode::Linear, .area_lines = 4};
    const MethodSettings nearest{.integrator = "photonmapper", .mode = GatherMode::Nearest, .k = 20};
    const MethodSettings relaxed{
        .integrator = "photonmapper", .mode = GatherMode::Relaxed, .relaxation_steps = 2, .area = AreaMode::Disc};
    MethodSettings seen_nearest = nearest;
    seen_nearest.area = AreaMode::Seen;
    seen_nearest.area_lines = 4;
    for (const NamedMethod& method :
         std::vector<NamedMethod>{{"ppm alpha", {.schedule = ScheduleName::KnausZwicker, .alpha = 0.5}},
                                  {"ppm direct photons", {.direct = DirectMode::Photons}},
                                  {"ppm seen", seen},
                                  {"sppm linear", linear},
                                  {"photonmapper seen", seen_nearest},
                                  {"photonmapper radius", {.integrator = "photonmapper", .mode = GatherMode::Radius}},
                                  {"photonmapper nearest", nearest},
                                  {"photonmapper relaxed", relaxed},
                                  {"path", {.integrator = "path"}}})
        methods.push_back(method);
    return methods;
}

class Continuation : public ::testing::TestWithParam<NamedMethod> {
protected:
    Continuation() : scene_(build_scene(room(16, 12))), hit_points_(trace_hit_points(scene_, 1, 1)) {}

    MethodSettings method() const {
        MethodSettings settings = GetParam().settings;
        settings.photons_per_pass = 500;
        return settings;
    }
    PhotonPass photons(std::uint64_t pass) const {
        return method().integrator == "path" ? PhotonPass{}
                                             : trace_photons(scene_, photon_settings(method(), 5), pass, 1);
    }
    void take(PassLoop& loop, std::uint64_t pass) const {
        if (needs_of(method()).has_own_photons)
            loop.take(pass);
        else
            loop.take(pass, photons(pass));
    }
    PassLoop fresh() const { return loop_of(method(), scene_, hit_points_, {.seed = 5}); }

    Scene scene_;
    HitPoints hit_points_;
};

template <typename Exchange>
std::string saved(const Exchange& exchange) {
    std::ostringstream stream;
    StateArchive archive(stream);
    exchange(archive);
    return stream.str();
}

std::string saved(PassLoop& loop) {
    return saved([&](StateArchive& archive) { loop.exchange(0, archive); });
}

/// The method's own state, in which there are no times.
std::string saved_of_method(PassLoop& loop) {
    return saved([&](StateArchive& archive) { loop.integrator(0).exchange(archive); });
}

void restore(PassLoop& loop, const std::string& bytes) {
    std::istringstream stream(bytes);
    StateArchive archive(stream, bytes.size());
    loop.exchange(0, archive);
    EXPECT_EQ(archive.bytes_left(), 0u);
}

TEST_P(Continuation, GivesTheSameBits) {
    constexpr std::uint64_t passes = 20;  // chains keep their states from pass 17 on
    for (const std::uint64_t interrupted : {0, 1, 5, 18}) {
        PassLoop whole = fresh();
        std::string state = saved(whole);
        for (std::uint64_t pass = 1; pass <= passes; ++pass) {
            take(whole, pass);
            if (pass == 2) whole.image();
            if (pass == interrupted) state = saved(whole);
        }
        const Image expected = whole.image();

        PassLoop continued = fresh();
        restore(continued, state);
        for (std::uint64_t pass = 1; pass <= passes; ++pass) take(continued, pass);
        const Image image = continued.image();
        ASSERT_EQ(image.layers.size(), expected.layers.size());
        for (std::size_t layer = 0; layer < image.layers.size(); ++layer)
            EXPECT_TRUE(image.layers[layer].pixels == expected.layers[layer].pixels) << image.layers[layer].name;

        const RunState a = continued.state_now(0);
        const RunState b = whole.state_now(0);
        EXPECT_EQ(a.pass, passes);
        EXPECT_EQ(a.photons_stored, b.photons_stored);
        EXPECT_EQ(a.report.photons_gathered, b.report.photons_gathered);
        EXPECT_EQ(a.map_bytes, b.map_bytes);
        EXPECT_EQ(a.nonfinite_in_maps, b.nonfinite_in_maps);
        EXPECT_EQ(a.report.radius_mean, b.report.radius_mean);
        EXPECT_EQ(saved_of_method(continued), saved_of_method(whole));
    }
}

TEST_P(Continuation, RefusesTheStateOfOtherHitPoints) {
    const HitPoints fewer = trace_hit_points(build_scene(room(8, 6)), 1, 1);
    PassLoop other = loop_of(method(), scene_, fewer, {.seed = 5});
    const std::string state = saved(other);
    PassLoop loop = fresh();
    EXPECT_THROW(restore(loop, state), InputError);
}

INSTANTIATE_TEST_SUITE_P(OfEveryMethod, Continuation, ::testing::ValuesIn(continued_methods()), [](const auto& tested) {
    std::string name;
    for (const char c : tested.param.name) name += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    return name;
});

}  // namespace
}  // namespace photonlab::test
