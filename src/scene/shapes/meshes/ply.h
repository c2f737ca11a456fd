// Stanford's PLY meshes: as text, and binary in both byte orders.

#pragma once

#include <string>
#include <string_view>

#include "scene/shapes/meshes/mesh_reader.h"

namespace photonlab {

/// The mesh of the file that has these bytes: polygons cut into fans around their first corner (in 0.6 the second
/// triangle of four corners begins with the last), normals (nx, ny, nz) and texture coordinates (u, v; s, t; or
/// texture_u, texture_v) where every vertex has them. `file` is its name in messages. Throws InputError.
MeshDescription parse_ply_mesh(std::string_view bytes, const std::string& file, MitsubaFamily family);

struct Ply {
    static constexpr const char* name = "ply";

    static MeshDescription read(ShapeReader& reader);
};

}  // namespace photonlab
