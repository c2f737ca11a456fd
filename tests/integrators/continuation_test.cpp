// An integrator made anew that reads another's state goes on as that one does, to the bit, and says the same of itself.

#include <gtest/gtest.h>

#include <sstream>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"

namespace photonlab::test {
namespace {

std::vector<MethodSettings> methods() {
    return {{.schedule = ScheduleName::Hachisuka},
            {.schedule = ScheduleName::KnausZwicker, .alpha = 0.5},
            {.direct = DirectMode::Photons},
            {.integrator = "photonmapper", .mode = GatherMode::Radius},
            {.integrator = "photonmapper", .mode = GatherMode::Nearest, .k = 20},
            {.integrator = "path"}};
}

class Continuation : public ::testing::TestWithParam<MethodSettings> {
protected:
    Continuation() : scene_(build_scene(room(16, 12))), hit_points_(trace_hit_points(scene_, 1, 1)) {}

    MethodSettings method() const {
        MethodSettings settings = GetParam();
        settings.photons_per_pass = 500;
        return settings;
    }
    PhotonPass photons(std::uint64_t pass) const {
        return method().integrator == "path" ? PhotonPass{}
                                             : trace_photons(scene_, photon_settings(method(), 5), pass, 1);
    }
    MethodWithPhotons fresh() const { return MethodWithPhotons(method(), {scene_, hit_points_, 5, 1}); }

    Scene scene_;
    HitPoints hit_points_;
};

std::string saved(Integrator& integrator) {
    std::ostringstream stream;
    StateArchive archive(stream);
    integrator.exchange(archive);
    return stream.str();
}

void restore(Integrator& integrator, const std::string& bytes) {
    std::istringstream stream(bytes);
    StateArchive archive(stream, bytes.size());
    integrator.exchange(archive);
    EXPECT_EQ(archive.bytes_left(), 0u);
}

TEST_P(Continuation, GivesTheSameBits) {
    constexpr std::uint64_t passes = 8;
    for (const std::uint64_t interrupted : {0, 1, 5}) {
        MethodWithPhotons whole = fresh();
        std::string state = saved(*whole.integrator);
        for (std::uint64_t pass = 1; pass <= passes; ++pass) {
            whole.run_pass(pass, photons(pass));
            if (pass == 2) whole.estimate();
            if (pass == interrupted) state = saved(*whole.integrator);
        }
        const Image expected = whole.estimate();

        MethodWithPhotons continued = fresh();
        restore(*continued.integrator, state);
        for (std::uint64_t pass = 1; pass <= interrupted; ++pass) {  // photons are traced again
            continued.photons.begin_pass(photons(pass));
            continued.photons.add_pass();
        }
        for (std::uint64_t pass = interrupted + 1; pass <= passes; ++pass) continued.run_pass(pass, photons(pass));
        const Image image = continued.estimate();
        ASSERT_EQ(image.layers.size(), expected.layers.size());
        for (std::size_t layer = 0; layer < image.layers.size(); ++layer)
            EXPECT_TRUE(image.layers[layer].pixels == expected.layers[layer].pixels) << image.layers[layer].name;

        const IntegratorReport a = continued.integrator->report();
        const IntegratorReport b = whole.integrator->report();
        EXPECT_EQ(a.photons_gathered, b.photons_gathered);
        EXPECT_EQ(a.map_bytes, b.map_bytes);
        EXPECT_EQ(a.nonfinite, b.nonfinite);
        EXPECT_EQ(a.radius_mean, b.radius_mean);
        EXPECT_EQ(saved(*continued.integrator), saved(*whole.integrator));
    }
}

TEST_P(Continuation, RefusesTheStateOfOtherHitPoints) {
    const HitPoints fewer = trace_hit_points(build_scene(room(8, 6)), 1, 1);
    const auto other = make_integrator(method(), {scene_, fewer, 5, 1});
    const std::string state = saved(*other);
    EXPECT_THROW(restore(*fresh().integrator, state), InputError);
}

INSTANTIATE_TEST_SUITE_P(OfEveryMethod, Continuation, ::testing::ValuesIn(methods()), [](const auto& tested) {
    const MethodSettings& method = tested.param;
    std::string name = method.integrator;
    if (name == "ppm") name += method.schedule == ScheduleName::Hachisuka ? "Hachisuka" : "KnausZwicker";
    if (name == "photonmapper") name += method.mode == GatherMode::Radius ? "Radius" : "Nearest";
    return name + (method.direct == DirectMode::Photons ? "DirectPhotons" : "");
});

}  // namespace
}  // namespace photonlab::test
