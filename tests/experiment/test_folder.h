// A folder that is there for one test, and what tests of this room put into it.

#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>

#include "core/error.h"
#include "core/files.h"
#include "experiment/reference_store.h"
#include "scene/loader.h"
#include "scene/scene.h"

namespace photonlab {

class TestFolder {
public:
    TestFolder() {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        path_ = std::filesystem::temp_directory_path() / (std::string("photonlab-") + test->test_suite_name() + "-" +
                                                          test->name() + "-" + std::to_string(::getpid()));
        std::filesystem::create_directories(path_);
    }
    ~TestFolder() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    TestFolder(const TestFolder&) = delete;
    TestFolder& operator=(const TestFolder&) = delete;

    std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
    const std::filesystem::path& path() const { return path_; }

    std::filesystem::path write(const std::string& name, const std::string& text) const {
        make_folder((path_ / name).parent_path());
        std::ofstream(path_ / name, std::ios::binary) << text;  // nobody waits for the disk
        return path_ / name;
    }

private:
    std::filesystem::path path_;
};

/// Two facing walls, one of them with a light in front: direct and indirect light, rendered in milliseconds.
inline const std::string two_walls_scene = R"(<scene version="3.0.0">
    <integrator type="path"><integer name="max_depth" value="5"/></integrator>
    <sensor type="perspective">
        <float name="fov" value="40"/>
        <transform name="to_world"><lookat origin="0, 1, 6" target="0, 1, 0" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="12"/><integer name="height" value="8"/></film>
    </sensor>
    <bsdf type="twosided" id="grey"><bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.5, 0.4"/></bsdf></bsdf>
    <shape type="rectangle">
        <transform name="to_world"><rotate x="1" angle="-90"/><scale value="2"/></transform>
        <ref id="grey"/>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><scale value="2"/><translate x="0" y="1" z="-2"/></transform>
        <ref id="grey"/>
    </shape>
    <shape type="rectangle">
        <transform name="to_world"><scale value="0.5"/><rotate x="1" angle="90"/><translate x="0" y="3" z="0"/></transform>
        <emitter type="area"><rgb name="radiance" value="8, 8, 6"/></emitter>
    </shape>
</scene>
)";

/// Writes `two_walls_scene` to walls/scene.xml and its reference of so many samples to reference/.
inline void write_two_walls(const TestFolder& folder, std::uint64_t samples) {
    const Scene scene = build_scene(load_scene_file(folder.write("walls/scene.xml", two_walls_scene)));
    ReferenceSettings settings;
    settings.scene_file = folder / "walls/scene.xml";
    settings.samples = samples;
    settings.max_depth = scene.max_depth;
    add_reference_samples(scene, settings, folder / "reference");
}

/// The rest of an experiment on what write_two_walls() wrote: every method, probes and sums over seeds.
inline const std::string every_method_on_two_walls = R"(
seeds = 2
threads = 1
record = "powers-of-two"
decomposition = true
photons_per_pass = 300
[[scenes]]
path = "walls/scene.xml"
reference = "reference"
probes = { middle = [6, 4] }
[[method]]
integrator = "ppm"
schedule = ["hachisuka", "knaus-zwicker"]
[[method]]
name = "nearest"
integrator = "photonmapper"
mode = "nearest"
k = 20
[[method]]
name = "fixed"
integrator = "photonmapper"
[[method]]
integrator = "path"
)";

/// What the InputError of `body` says; empty when there is none.
template <typename Body>
std::string message_of(const Body& body) {
    try {
        body();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

}  // namespace photonlab
