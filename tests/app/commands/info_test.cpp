// `info` prints what the library computes, with the constants that it uses.

#include <fmt/format.h>

#include "integrators/integrator.h"
#include "render/pass_loop.h"
#include "scene/loader.h"
#include "tests/app/program.h"
#include "transport/light/photons.h"

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

std::string with_glass(const std::string& reflectance) {
    return "<scene version='3.0.0'><default name='grey' value='0.1'/><sensor type='perspective'/><emitter "
           "type='point'/><shape type='sphere'><bsdf type='dielectric'/></shape><shape type='rectangle'><bsdf "
           "type='plastic'><rgb name='diffuse_reflectance' value='" +
           reflectance + "'/></bsdf></shape></scene>";
}

TEST_F(Info, SaysWhatMethodsDoWithASurfaceAndALight) {
    std::string said;
    ASSERT_EQ(run_program({"info", folder_.write("glass.xml", with_glass("$grey")).string()}, said), 0) << said;
    for (const std::string line :
         {"1 followed into every single direction; nothing is gathered there\n",
          "1 gathered at, and followed into every single direction\n", "warning     1 lights have no size"})
        EXPECT_NE(said.find(line), std::string::npos) << line << said;
}

TEST_F(Info, TakesValuesForTheNamesOfAScene) {
    const std::string scene = folder_.write("glass.xml", with_glass("$grey")).string();
    std::string said;
    EXPECT_EQ(run_program({"info", scene, "-D", "grey=0.5"}, said), 0) << said;
    EXPECT_NE(said.find("$grey is \"0.5\""), std::string::npos) << said;
    EXPECT_EQ(run_program({"info", scene, "-Dgrey=2"}, said), 2);
    EXPECT_NE(said.find("diffuse_reflectance: expected values in [0, 1]"), std::string::npos) << said;
    EXPECT_EQ(run_program({"info", scene, "-D", "gray=0.5"}, said), 2);
    EXPECT_NE(said.find("no parameter $gray"), std::string::npos) << said;
    EXPECT_EQ(run_program({"info", scene, "-D", "grey"}, said), 2);
    EXPECT_NE(said.find("-D: expected NAME=VALUE, got \"grey\""), std::string::npos) << said;
    EXPECT_EQ(run_program({"info", scene, "-D", "grey=1", "-D", "grey=0"}, said), 2);
    EXPECT_NE(said.find("-D: grey is given twice"), std::string::npos) << said;
}

}  // namespace
}  // namespace photonlab
