// Meshes: OBJ, PLY and serialized, and creases in them.

#include "scene/loader.h"
#include "scene/shapes/meshes/creases.h"
#include "scene/shapes/meshes/obj.h"
#include "scene/shapes/meshes/ply.h"
#include "scene/shapes/meshes/serialized.h"
#include "tests/fuzz/fuzz.h"

using namespace photonlab;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const fuzz::Folder folder;
    const std::string bytes(fuzz::text_of(data, size));
    const auto file = folder.write("mesh.obj", bytes);
    for (const bool face_normals : {false, true}) fuzz::read_or_refuse([&] { load_obj_mesh(file, face_normals); });
    fuzz::read_or_refuse([&] {
        ObjMesh obj = parse_obj_mesh(bytes, "mesh.obj", {.keeps_groups = true, .family = MitsubaFamily::Version06});
        split_at_creases(obj.mesh, 30.0, obj.groups, "mesh.obj");
        fill_in_normals(obj.mesh);
    });
    for (const auto family : {MitsubaFamily::Version06, MitsubaFamily::Version3})
        fuzz::read_or_refuse([&] { parse_ply_mesh(bytes, "mesh.ply", family); });
    for (const long index : {0L, 1L})
        fuzz::read_or_refuse([&] { parse_serialized_mesh(bytes, {"mesh.serialized", index, "scene.xml:1"}); });
    return 0;
}
