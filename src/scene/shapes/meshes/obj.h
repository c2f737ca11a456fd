// Wavefront OBJ meshes: as their file has them, and placed in a scene.

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "scene/shapes/meshes/mesh_reader.h"

namespace photonlab {

struct ObjOptions {
    bool face_normals = false;    ///< leave the file's normals out
    bool flip_v = false;          ///< turn texture coordinates over: v is 1 - v
    bool separate_groups = true;  ///< 0.6 only: groups and materials share no vertices
    bool keeps_groups = false;    ///< which those are of, triangle by triangle
    MitsubaFamily family = MitsubaFamily::Version3;
};

struct ObjMesh {
    /// All objects as one, polygons cut into fans around their first corner. Vertices with different normals or texture
    /// coordinates are kept apart. A corner without a normal, or with one of length 0, has its triangle's, and one
    /// without texture coordinates has (0, 0), wherever others have some: in the whole file, or in 0.6 in its group.
    /// Where none has any, normals are 0 and texture coordinates not a number; where that is the whole file, empty.
    MeshDescription mesh;
    std::vector<std::uint32_t> groups;  ///< of its triangles, where they are kept
    std::string material_library;       ///< what the last mtllib names, or ""
};

/// The mesh of the file that has this text. Throws InputError with file and line.
ObjMesh parse_obj_mesh(std::string_view text, const std::filesystem::path& file, const ObjOptions& options);

struct Obj {
    static constexpr const char* name = "obj";

    static MeshDescription read(ShapeReader& reader);
};

/// Reads an OBJ mesh: all its objects as one, polygons cut into fans around their first corner as in Mitsuba, vertices
/// with different normals or texture coordinates kept apart. With `face_normals` there are no vertex normals; otherwise
/// they are the file's, or computed as Mitsuba does when any corner has none. Texture coordinates are the file's, v up,
/// and left out when any corner has none.
MeshDescription load_obj_mesh(const std::filesystem::path& file, bool face_normals);

}  // namespace photonlab
