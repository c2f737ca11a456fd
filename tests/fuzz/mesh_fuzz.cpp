// Meshes: OBJ, PLY and serialized.

#include "scene/loader.h"
#include "scene/shapes/obj.h"
#include "scene/shapes/ply.h"
#include "scene/shapes/serialized.h"
#include "tests/fuzz/fuzz.h"

using namespace photonlab;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::Folder folder;
    const std::string bytes(fuzz::text_of(data, size));
    const auto file = folder.write("mesh.obj", bytes);
    for (const bool face_normals : {false, true}) fuzz::read_or_refuse([&] { load_obj_mesh(file, face_normals); });
    for (const auto family : {MitsubaFamily::Version06, MitsubaFamily::Version3})
        fuzz::read_or_refuse([&] { parse_ply_mesh(bytes, "mesh.ply", family); });
    for (const long index : {0L, 1L})
        fuzz::read_or_refuse([&] { parse_serialized_mesh(bytes, {"mesh.serialized", index, "scene.xml:1"}); });
    return 0;
}
