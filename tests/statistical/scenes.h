// Scenes whose light is known in closed form, written directly as descriptions, and the pieces they are made of.
//
// Lengths are in scene units and no scene is one unit large, so that a forgotten conversion to the unit box shows. A
// camera of 1 x 1 pixels has one hit point: exactly where its view axis meets the surface.

#pragma once

#include "scene/description.h"
#include "scene/scene.h"

namespace photonlab::test {

inline Material diffuse(const Color& reflectance, bool two_sided = false) {
    return {.id = "diffuse", .bsdf = Diffuse{reflectance}, .two_sided = two_sided};
}

/// A parallelogram from `corner`; its normal is along_first x along_second.
inline MeshDescription parallelogram(const VectorD& corner, const VectorD& along_first, const VectorD& along_second) {
    return {.positions = {corner, corner + along_first, corner + along_first + along_second, corner + along_second},
            .normals = {},
            .texture_coordinates = {},
            .triangles = {{0, 1, 2}, {0, 2, 3}}};
}

inline ShapeDescription shape(MeshDescription mesh, std::size_t material,
                              std::optional<ColorD> radiance = std::nullopt) {
    return {std::move(mesh), material, radiance, "test"};
}

inline ShapeDescription sphere(const VectorD& centre, double radius, bool flip_normals, std::size_t material,
                               std::optional<ColorD> radiance = std::nullopt) {
    return {SphereDescription{centre, radius, flip_normals}, material, radiance, "test"};
}

inline ShapeDescription disk(const VectorD& centre, const VectorD& normal, double radius, std::size_t material,
                             std::optional<ColorD> radiance = std::nullopt) {
    return {DiskDescription{centre, normal.normalized(), radius}, material, radiance, "test"};
}

inline PointLightDescription point_light(const VectorD& position, const ColorD& intensity) {
    return {position, intensity, "test"};
}

inline CameraDescription look_at(const VectorD& from, const VectorD& target, int width = 1, int height = 1,
                                 double fov_x = 10.0) {
    const VectorD forward = (target - from).normalized();
    const VectorD helper = std::abs(forward.y) < 0.9 ? VectorD(0, 1, 0) : VectorD(1, 0, 0);
    const VectorD left = helper.cross(forward).normalized();
    const VectorD up = forward.cross(left);
    CameraDescription camera;
    camera.to_world = Matrix(left.x, left.y, left.z, 0, up.x, up.y, up.z, 0, forward.x, forward.y, forward.z, 0, from.x,
                             from.y, from.z, 1);
    camera.fov_x = fov_x;
    camera.width = width;
    camera.height = height;
    return camera;
}

/// A one-sided floor around the origin, facing +y, seen at the origin. Lights are the caller's to add.
inline SceneDescription floor_seen_at_origin(const Color& reflectance, double radius = 30.0) {
    SceneDescription scene;
    scene.materials = {diffuse(reflectance), diffuse(Color(0.0f))};
    scene.shapes = {disk(VectorD(0.0), VectorD(0, 1, 0), radius, 0)};
    scene.camera = look_at(VectorD(4.0, 2.5, 1.0), VectorD(0.0));
    return scene;
}

inline constexpr double sphere_radius = 3.0;

/// The inside of a sphere around the origin, seen all over by 8 x 8 pixels or at one point.
inline SceneDescription hollow_sphere(const Color& reflectance, std::optional<ColorD> radiance = std::nullopt,
                                      int resolution = 8) {
    SceneDescription scene;
    scene.materials = {diffuse(reflectance)};
    scene.shapes = {sphere(VectorD(0.0), sphere_radius, true, 0, radiance)};
    scene.camera = look_at(VectorD(0.3, -0.4, -1.0), VectorD(0.5, 0.7, 2.0), resolution, resolution, 110.0);
    return scene;
}

/// The inside of a cube of edge 2 around the origin. The camera sees the inner part of one wall.
inline SceneDescription hollow_cube(const Color& reflectance, std::optional<ColorD> radiance) {
    SceneDescription scene;
    scene.materials = {diffuse(reflectance)};
    const VectorD axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            const VectorD& normal = axes[axis];
            const VectorD& first = axes[(axis + 1) % 3];
            const VectorD& second = axes[(axis + 2) % 3];
            const VectorD corner = normal * side - first - second;
            // first x second = normal: as it is for the wall at -1, which faces +, turned over for the one at +1.
            scene.shapes.push_back(shape(side < 0.0 ? parallelogram(corner, first * 2.0, second * 2.0)
                                                    : parallelogram(corner, second * 2.0, first * 2.0),
                                         0, radiance));
        }
    scene.camera = look_at(VectorD(-0.2, 0.1, -0.6), VectorD(0.05, 0.05, 1.0), 6, 6, 40.0);
    return scene;
}

/// A room open to the front after the Cornell box: edge 2, a lamp below the ceiling, a block on the floor.
inline SceneDescription room(int width = 48, int height = 48) {
    SceneDescription scene;
    scene.materials = {diffuse(Color(0.73f, 0.71f, 0.68f)), diffuse(Color(0.63f, 0.07f, 0.05f)),
                       diffuse(Color(0.14f, 0.45f, 0.09f)), diffuse(Color(0.3f, 0.5f, 0.7f)), diffuse(Color(0.0f))};
    const VectorD x(2, 0, 0);
    const VectorD y(0, 2, 0);
    const VectorD z(0, 0, 2);
    const VectorD corner(-1.0);
    scene.shapes = {shape(parallelogram(corner, z, x), 0),       // floor
                    shape(parallelogram(corner + y, x, z), 0),   // ceiling
                    shape(parallelogram(corner + z, y, x), 0),   // back wall
                    shape(parallelogram(corner, y, z), 1),       // wall at -x
                    shape(parallelogram(corner + x, z, y), 2)};  // wall at +x
    scene.shapes.push_back(shape(parallelogram(VectorD(-0.4, 0.95, -0.3), VectorD(0.8, 0, 0), VectorD(0, 0, 0.6)), 4,
                                 ColorD(8.0, 6.0, 3.0)));
    // A block of 0.6 x 0.7 x 0.6 in front of the wall at +x: its top and the sides that can be seen or lit.
    const VectorD block(0.1, -1.0, -0.2);
    const VectorD wide(0.6, 0, 0);
    const VectorD high(0, 0.7, 0);
    const VectorD deep(0, 0, 0.6);
    scene.shapes.push_back(shape(parallelogram(block + high, deep, wide), 3));
    scene.shapes.push_back(shape(parallelogram(block, high, wide), 3));
    scene.shapes.push_back(shape(parallelogram(block + deep, wide, high), 3));
    scene.shapes.push_back(shape(parallelogram(block, deep, high), 3));
    scene.shapes.push_back(shape(parallelogram(block + wide, high, deep), 3));
    scene.camera = look_at(VectorD(0.0, 0.1, -4.2), VectorD(0.0, 0.0, 0.0), width, height, 36.0);
    return scene;
}

}  // namespace photonlab::test
