// The cube [-1, 1]^3, facing outwards.

#pragma once

#include "scene/shapes/meshes/rectangle.h"

namespace photonlab {

/// A face of the cube, and along which axes its texture coordinates grow: axis 0, 1 or 2 is x, y or z.
struct CubeFace {
    int axis;
    double side;
    int u_axis;
    double u_sign;
    int v_axis;
    double v_sign;
};

// As Mitsuba lays the texture out.
inline constexpr CubeFace cube_faces[] = {{0, -1, 1, 1, 2, 1},  {0, 1, 1, 1, 2, -1},  {1, -1, 2, 1, 0, 1},
                                          {1, 1, 0, -1, 2, -1}, {2, -1, 1, -1, 0, 1}, {2, 1, 1, 1, 0, 1}};

/// Corners are apart on each face, so that texture coordinates run over each.
inline MeshDescription unit_cube() {
    MeshDescription mesh;
    const MeshDescription square = unit_square();
    for (const CubeFace& face : cube_faces) {
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const VectorD& corner : square.positions) {
            VectorD position;
            position[face.axis] = face.side;
            position[(face.axis + 1) % 3] = face.side * corner.x;
            position[(face.axis + 2) % 3] = corner.y;
            mesh.positions.push_back(position);
            mesh.texture_coordinates.emplace_back(0.5 + 0.5 * face.u_sign * position[face.u_axis],
                                                  0.5 + 0.5 * face.v_sign * position[face.v_axis]);
        }
        for (const auto& triangle : square.triangles)
            mesh.triangles.push_back({first + triangle.x, first + triangle.y, first + triangle.z});
    }
    return mesh;
}

struct Cube {
    static constexpr const char* name = "cube";

    static MeshDescription read(ShapeReader& reader) {
        reader.properties.boolean("face_normals");  // it is flat either way
        return place_flat(unit_cube(), reader);
    }
};

}  // namespace photonlab
