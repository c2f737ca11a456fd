// `info` prints what the library computes, with the constants that it uses.

#include <fmt/format.h>

#include "integrators/integrator.h"
#include "render/pass_loop.h"
#include "scene/loader.h"
#include "tests/app/program.h"
#include "transport/photons.h"

namespace photonlab {
namespace {

class Info : public ProgramTest {
protected:
    std::string info(const std::vector<std::string>& more = {}) const {
        std::vector<std::string> words{"info", (folder_ / "walls/scene.xml").string()};
        words.insert(words.end(), more.begin(), more.end());
        std::string said;
        EXPECT_EQ(run_program(words, said), 0) << said;
        return said;
    }
};

TEST_F(Info, TheAutomaticRadiusIsTheOneThatMethodsBeginWith) {
    for (const Resolution resolution : {Resolution{12, 8}, Resolution{31, 17}, Resolution{1, 1}}) {
        const Scene scene = build_scene(load_scene_file(folder_ / "walls/scene.xml"), resolution);
        const HitPoints hit_points = trace_hit_points(scene, 1, 1);
        const PassLoop loop(scene, hit_points, {RunSettings{}});
        const std::string said = info({"--resolution", fmt::format("{}x{}", resolution.width, resolution.height)});
        const std::string expected = fmt::format("\nauto radius {:.6g} in the mean", *loop.state(0).report.radius_mean);
        EXPECT_NE(said.find(expected), std::string::npos) << expected << said;
    }
}

TEST_F(Info, APhotonHasTheBytesOfItsRecord) {
    EXPECT_NE(info().find(fmt::format("\nphotons     {} bytes each", sizeof(Photon))), std::string::npos);
}

}  // namespace
}  // namespace photonlab
