// Mitsuba's own meshes: several in a file, each compressed.

#pragma once

#include <filesystem>

#include "scene/shapes/mesh_reader.h"

namespace photonlab {

struct SerializedMesh {
    MeshDescription mesh;
    bool face_normals = false;  ///< what the file asks for
};

/// Reads one mesh of the file, versions 3 and 4, counted from 0. Throws InputError.
SerializedMesh read_serialized_mesh(const std::filesystem::path& file, long index);

struct Serialized {
    static constexpr const char* name = "serialized";

    static MeshDescription read(ShapeReader& reader);
};

}  // namespace photonlab
