// What a scene file says, before anything is computed from it: shapes, materials, lights and the camera in scene
// units and double precision. The loader makes one from Mitsuba XML, a test writes one directly, and build_scene()
// (scene.h) turns either into a Scene.

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/math.h"
#include "scene/materials/material.h"

namespace photonlab {

/// Triangles over shared vertices, counter-clockwise seen from outside.
struct MeshDescription {
    std::vector<VectorD> positions;
    std::vector<VectorD> normals;                 ///< one a vertex, unit length; empty: flat shading
    std::vector<Imath::V2d> texture_coordinates;  ///< one a vertex; empty: barycentric, those of the second and third
    std::vector<Imath::Vec3<std::uint32_t>> triangles;
};

/// Axes about which a round shape's texture coordinates run: unit length, at right angles; left-handed where mirrored.
using TextureAxes = std::array<VectorD, 3>;
inline const TextureAxes scene_axes{VectorD(1, 0, 0), VectorD(0, 1, 0), VectorD(0, 0, 1)};

/// Texture coordinates: u is the angle about the third axis, from the first axis to the second, and v that from the
/// third axis; 1 is once around, and at the opposite pole.
struct SphereDescription {
    VectorD centre;
    double radius = 1.0;        ///< > 0
    bool flip_normals = false;  ///< true: the normal points to the centre
    TextureAxes texture_axes = scene_axes;
};

/// Texture coordinates: u is the distance from the centre in radii, v the angle from the first axis to the second; 1 is
/// once around. The first two axes are in the disk's plane.
struct DiskDescription {
    VectorD centre;
    VectorD normal;       ///< unit length
    double radius = 1.0;  ///< > 0
    TextureAxes texture_axes = scene_axes;
};

using Geometry = std::variant<MeshDescription, SphereDescription, DiskDescription>;

struct ShapeDescription {
    Geometry geometry;
    std::size_t material = 0;        ///< index into SceneDescription::materials
    std::optional<ColorD> radiance;  ///< of an area light: W/(m^2 sr), emitted to the side of the normal
    std::string place;               ///< "file:line" for messages
};

struct PointLightDescription {
    VectorD position;
    ColorD intensity;  ///< W/sr
    std::string place;
};

inline constexpr int largest_image_side = 65536;  ///< pixels, of an image that is rendered

/// A pinhole camera. Camera space is Mitsuba's: z forward, y up, x to the left of the image.
struct CameraDescription {
    Matrix to_world;      ///< camera space to world, no shear; Imath's row-vector convention
    double fov_x = 45.0;  ///< full horizontal field of view, degrees, in (0, 180)
    int width = 768;      ///< pixels; changing the resolution keeps fov_x as given here
    int height = 576;
    std::string place;  ///< "file:line" for messages, or ""
};

struct SceneDescription {
    std::vector<Material> materials;
    std::vector<ShapeDescription> shapes;
    std::vector<PointLightDescription> point_lights;
    CameraDescription camera;
    int max_depth = -1;              ///< the scene file's own integrator setting; -1 is unlimited
    std::string name;                ///< of the scene's folder, or of the file if that is not scene.xml
    std::string hash;                ///< hexadecimal, of every byte that was read: XML, includes, meshes
    std::vector<std::string> notes;  ///< what was read past, one sentence each
};

}  // namespace photonlab
