// Mitsuba's own meshes: several in a file, each compressed.

#pragma once

#include <string>
#include <string_view>

#include "scene/shapes/meshes/mesh_reader.h"

namespace photonlab {

/// Which mesh of a file.
struct MeshInFile {
    std::string file;   ///< for messages
    long index = 0;     ///< counted from 0
    std::string place;  ///< "file:line" of what asks for that one
};

/// One mesh of the file that has these bytes, of versions 3 and 4. Throws InputError.
MeshDescription parse_serialized_mesh(std::string_view bytes, const MeshInFile& which);

struct Serialized {
    static constexpr const char* name = "serialized";

    static MeshDescription read(ShapeReader& reader);
};

}  // namespace photonlab
