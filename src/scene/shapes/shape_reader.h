// <shape> elements of scene files: what a shape's reader is given, and which is called.

#pragma once

#include "scene/mitsuba/plugin.h"
#include "scene/mitsuba/transform.h"
#include "scene/shapes/shape.h"

namespace photonlab {

struct ShapeReader : Plugin {
    ShapeReader(const XmlElement& plugin, const SceneSource& scene);

    Matrix to_world;
    bool flip_normals;
    bool has_bsdf = false;     ///< in its element
    bool has_texture = false;  ///< in its material or its light, which then needs texture coordinates

    /// Whether triangles, taken to the world, must be turned inside out for what was outside to be outside.
    bool turns_triangles() const { return (handedness(to_world) < 0.0) != flip_normals; }

    /// The world's directions of the local axes, unit length.
    TextureAxes texture_axes() const;
};

/// A kind that is read as triangles, in the world. To add one: a file with such a struct, its name in the list in
/// src/scene/CMakeLists.txt, and a test.
template <typename Kind>
concept MeshKind = requires(ShapeReader& reader) {
    { Kind::name } -> std::convertible_to<const char*>;
    { Kind::read(reader) } -> std::same_as<MeshDescription>;
};

template <MeshKind... Kinds>
using MeshOf = std::variant<Kinds...>;

/// The shape's geometry, in the world. Throws InputError.
Geometry read_geometry(ShapeReader& reader);

/// Turns the triangle inside out.
void turn(Imath::Vec3<std::uint32_t>& triangle);

/// Takes a mesh without normals of its own to the world.
MeshDescription place_flat(MeshDescription mesh, const ShapeReader& reader);

}  // namespace photonlab
