// Scene files, with a mesh and a part beside them to name.

#include "scene/loader.h"
#include "scene/scene.h"
#include "tests/fuzz/fuzz.h"

using namespace photonlab;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::Folder folder;
    static const auto beside = {
        folder.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
        folder.write("part.xml", "<scene version='3.0.0'><bsdf type='diffuse' id='part'/></scene>")};
    static_cast<void>(beside);
    const auto file = folder.write("scene.xml", fuzz::text_of(data, size));
    fuzz::read_or_refuse([&] { build_scene(load_scene_file(file)); });
    return 0;
}
