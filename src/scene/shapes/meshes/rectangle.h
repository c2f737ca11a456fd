// The square [-1, 1]^2 at z = 0, facing +z.

#pragma once

#include "scene/shapes/shape_reader.h"

namespace photonlab {

inline MeshDescription unit_square() {
    MeshDescription mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles.emplace_back(0, 1, 2);
    mesh.triangles.emplace_back(0, 2, 3);
    return mesh;
}

struct Rectangle {
    static constexpr const char* name = "rectangle";

    static MeshDescription read(ShapeReader& reader) {
        reader.properties.boolean("face_normals");  // it is flat either way
        return place_flat(unit_square(), reader);
    }
};

}  // namespace photonlab
