// Scenes written directly, without a file: what the tests of this room share.

#pragma once

#include <optional>
#include <utility>
#include <variant>
#include <vector>

#include "core/random.h"
#include "scene/scene.h"
#include "tests/support/test_stream.h"

namespace photonlab {

/// A parallelogram of two triangles; its normal is half_x cross half_y.
inline MeshDescription square(const VectorD& centre, const VectorD& half_x, const VectorD& half_y) {
    MeshDescription mesh;
    mesh.positions = {centre - half_x - half_y, centre + half_x - half_y, centre + half_x + half_y,
                      centre - half_x + half_y};
    mesh.triangles.emplace_back(0, 1, 2);
    mesh.triangles.emplace_back(0, 2, 3);
    return mesh;
}

/// A cube of one mesh, its normals outwards.
inline MeshDescription cube(const VectorD& centre, double half_width) {
    MeshDescription mesh;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            VectorD out(0.0), x(0.0), y(0.0);
            out[axis] = side * half_width;
            x[(axis + 1) % 3] = side * half_width;
            y[(axis + 2) % 3] = half_width;
            const auto first = static_cast<std::uint32_t>(mesh.positions.size());
            const MeshDescription face = square(centre + out, x, y);
            mesh.positions.insert(mesh.positions.end(), face.positions.begin(), face.positions.end());
            mesh.triangles.emplace_back(first, first + 1, first + 2);
            mesh.triangles.emplace_back(first, first + 2, first + 3);
        }
    return mesh;
}

inline ShapeDescription shape(Geometry geometry, std::optional<ColorD> radiance = std::nullopt) {
    return {.geometry = std::move(geometry), .material = 0, .radiance = radiance, .place = "test:1"};
}

inline SceneDescription describe(std::vector<ShapeDescription> shapes, std::vector<PointLightDescription> lights = {}) {
    SceneDescription description;
    description.materials = {{.id = "grey", .bsdf = Diffuse{Color(0.5f)}, .two_sided = true}};
    description.shapes = std::move(shapes);
    description.lights.assign(lights.begin(), lights.end());
    return description;
}

/// A floor of 8 x 8 that makes the unit box known: scene units are divided by 8.
inline ShapeDescription floor_of_eight() {
    return shape(square({0, 0, 0}, {4, 0, 0}, {0, 4, 0}));
}

inline Vector to_box(const Scene& scene, const VectorD& point) {
    return Vector((point - scene.centre) / scene.unit_length);
}

inline RandomStream stream_of_scenes(std::uint64_t index = 0) {
    return test_stream(index, 11);
}

}  // namespace photonlab
