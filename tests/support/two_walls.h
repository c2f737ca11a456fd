// A small scene with its reference, and an experiment of every method on it, all in milliseconds.

#pragma once

#include <string>

#include "reference/reference_store.h"
#include "scene/loader.h"
#include "scene/scene.h"
#include "tests/support/test_folder.h"

namespace photonlab {

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
name = "learning"
integrator = "ppm"
emission = "adaptive"
[[method]]
name = "seen"
integrator = "sppm"
photon_paths = "visible"
[[method]]
integrator = "path"
)";

}  // namespace photonlab
