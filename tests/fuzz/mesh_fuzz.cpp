// Meshes: OBJ, PLY and serialized.

#include "scene/loader.h"
#include "scene/shapes/obj.h"
#include "scene/shapes/ply.h"
#include "scene/shapes/serialized.h"
#include "tests/fuzz/fuzz.h"

using namespace photonlab;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::Folder folder;
    const auto file = folder.write("mesh.obj", fuzz::text_of(data, size));
    for (const bool face_normals : {false, true}) fuzz::read_or_refuse([&] { load_obj_mesh(file, face_normals); });
    fuzz::read_or_refuse([&] { read_ply_mesh(file); });
    for (const long index : {0L, 1L}) fuzz::read_or_refuse([&] { read_serialized_mesh(file, index); });
    return 0;
}
