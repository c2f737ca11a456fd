#include "scene/shapes/shape_reader.h"

#include <algorithm>

#include "scene/shapes/mesh_list.h"

namespace photonlab {

ShapeReader::ShapeReader(const XmlElement& plugin, const SceneSource& scene)
    : Plugin(plugin, scene),
      to_world(properties.transform("to_world").value_or(Matrix())),
      flip_normals(properties.boolean("flip_normals").value_or(false)) {}

TextureAxes ShapeReader::texture_axes() const {
    return {transform_direction(to_world, {1, 0, 0}).normalized(),
            transform_direction(to_world, {0, 1, 0}).normalized(),
            transform_direction(to_world, {0, 0, 1}).normalized()};
}

void turn(Imath::Vec3<std::uint32_t>& triangle) {
    std::swap(triangle.y, triangle.z);
}

MeshDescription place_flat(MeshDescription mesh, const ShapeReader& reader) {
    for (VectorD& position : mesh.positions) position = transform_point(reader.to_world, position);
    if (reader.turns_triangles()) std::for_each(mesh.triangles.begin(), mesh.triangles.end(), turn);
    return mesh;
}

namespace {

using ShapeKinds = std::vector<NamedKind<ShapeReader, Geometry>>;

template <typename... Analytics, typename... Meshes>
ShapeKinds shape_kinds(const std::variant<Analytics...>*, const std::variant<Meshes...>*) {
    return {{Analytics::name, read_whole<Analytics, ShapeReader, Geometry>}...,
            {Meshes::name, read_whole<Meshes, ShapeReader, Geometry>}...};
}

}  // namespace

Geometry read_geometry(ShapeReader& reader) {
    const ShapeKinds kinds = shape_kinds(static_cast<const Analytic*>(nullptr), static_cast<const Mesh*>(nullptr));
    return find_kind(kinds, reader.element).read(reader);
}

}  // namespace photonlab
