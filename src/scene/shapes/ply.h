// Stanford's PLY meshes: as text, and binary in both byte orders.

#pragma once

#include <filesystem>

#include "scene/shapes/mesh_reader.h"

namespace photonlab {

/// Reads the file: polygons cut into fans around their first corner, normals (nx, ny, nz) and texture coordinates (u,
/// v; s, t; or texture_u, texture_v) where every vertex has them. Throws InputError.
MeshDescription read_ply_mesh(const std::filesystem::path& file);

struct Ply {
    static constexpr const char* name = "ply";

    static MeshDescription read(ShapeReader& reader);
};

}  // namespace photonlab
