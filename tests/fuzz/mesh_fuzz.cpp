// OBJ meshes.

#include "scene/loader.h"
#include "scene/shapes/obj.h"
#include "tests/fuzz/fuzz.h"

using namespace photonlab;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::Folder folder;
    const auto file = folder.write("mesh.obj", fuzz::text_of(data, size));
    for (const bool face_normals : {false, true}) fuzz::read_or_refuse([&] { load_obj_mesh(file, face_normals); });
    return 0;
}
