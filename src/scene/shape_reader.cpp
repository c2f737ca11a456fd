#include "scene/shape_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "scene/mitsuba/transform.h"
#include "scene/obj_mesh.h"

namespace photonlab {

namespace {

/// Where a shape stands, and which way it faces.
struct Placement {
    Matrix to_world;
    bool flip_normals;
    MitsubaFamily family;

    /// Whether triangles, taken to the world, must be turned inside out for what was outside to be outside.
    bool turns_triangles() const { return (handedness(to_world) < 0.0) != flip_normals; }
};

void turn(Imath::Vec3<std::uint32_t>& triangle) {
    std::swap(triangle.y, triangle.z);
}

// ---------------------------------------------------------------------------------------------------------------------
// Texture coordinates of triangles that have none

/// Which corners of a triangle have (0, 0), (1, 0) and (0, 1).
using CornerOrder = std::array<int, 3>;

/// Gives the triangles whose corners have none the barycentric coordinates of their second and third corner, as Mitsuba
/// does. Their vertices are then shared no more.
void add_barycentric_coordinates(MeshDescription& mesh, const CornerOrder& order) {
    if (mesh.texture_coordinates.empty())
        mesh.texture_coordinates.resize(mesh.positions.size(), Imath::V2d(std::numeric_limits<double>::quiet_NaN()));
    for (auto& triangle : mesh.triangles) {
        if (!std::isnan(mesh.texture_coordinates[triangle.x].x)) continue;
        for (int i = 0; i < 3; ++i) {
            std::uint32_t& vertex = triangle[order[static_cast<std::size_t>(i)]];
            const auto own = static_cast<std::uint32_t>(mesh.positions.size());
            mesh.positions.push_back(VectorD(mesh.positions[vertex]));
            if (!mesh.normals.empty()) mesh.normals.push_back(VectorD(mesh.normals[vertex]));
            mesh.texture_coordinates.emplace_back(i == 1 ? 1.0 : 0.0, i == 2 ? 1.0 : 0.0);
            vertex = own;
        }
    }
}

/// For triangles that were turned: Mitsuba exchanges other corners than turn() does, 3 the first and last, 0.6 the
/// first and second, and those only where it does not turn vertex normals instead.
CornerOrder corner_order(MitsubaFamily family, bool is_turned, bool face_normals) {
    if (!is_turned) return {0, 1, 2};
    if (family == MitsubaFamily::Version3) return {1, 2, 0};
    return face_normals ? CornerOrder{2, 0, 1} : CornerOrder{0, 2, 1};
}

// ---------------------------------------------------------------------------------------------------------------------

/// [-1, 1]^2 at z = 0, facing +z.
MeshDescription rectangle() {
    MeshDescription mesh;
    mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
    mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    mesh.triangles.emplace_back(0, 1, 2);
    mesh.triangles.emplace_back(0, 2, 3);
    return mesh;
}

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
constexpr CubeFace cube_faces[] = {{0, -1, 1, 1, 2, 1},  {0, 1, 1, 1, 2, -1},  {1, -1, 2, 1, 0, 1},
                                   {1, 1, 0, -1, 2, -1}, {2, -1, 1, -1, 0, 1}, {2, 1, 1, 1, 0, 1}};

/// [-1, 1]^3, facing outwards; corners apart on each face, so that texture coordinates run over each.
MeshDescription cube() {
    MeshDescription mesh;
    const MeshDescription square = rectangle();
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

MeshDescription place_flat(MeshDescription mesh, const Placement& placement) {
    for (VectorD& position : mesh.positions) position = transform_point(placement.to_world, position);
    if (placement.turns_triangles()) std::for_each(mesh.triangles.begin(), mesh.triangles.end(), turn);
    return mesh;
}

// ---------------------------------------------------------------------------------------------------------------------

/// In Mitsuba the normals of vertices, where a mesh has them, say which side of it is which; here that is the order of
/// a triangle's corners.
void turn_to_normals(MeshDescription& mesh) {
    for (auto& triangle : mesh.triangles) {
        const VectorD& corner = mesh.positions[triangle.x];
        const VectorD side = (mesh.positions[triangle.y] - corner).cross(mesh.positions[triangle.z] - corner);
        const VectorD normal = mesh.normals[triangle.x] + mesh.normals[triangle.y] + mesh.normals[triangle.z];
        if (side.dot(normal) < 0.0) turn(triangle);
    }
}

/// Takes the mesh to the world, where normals that the file does not give are computed. A mirroring turns a mesh
/// without normals inside out in 0.6, and not in 3.
MeshDescription place_obj(MeshDescription mesh, const Placement& placement, bool face_normals, bool has_texture) {
    const Matrix& to_world = placement.to_world;
    for (VectorD& position : mesh.positions) position = transform_point(to_world, position);
    for (VectorD& normal : mesh.normals)
        if (normal != VectorD(0.0)) normal = transform_normal(to_world, placement.flip_normals ? -normal : normal);
    const bool is_turned =
        placement.family == MitsubaFamily::Version3 ? placement.turns_triangles() : placement.flip_normals;
    if (is_turned) std::for_each(mesh.triangles.begin(), mesh.triangles.end(), turn);
    if (!face_normals) fill_in_normals(mesh);
    if (has_texture) add_barycentric_coordinates(mesh, corner_order(placement.family, is_turned, face_normals));
    for (Imath::V2d& uv : mesh.texture_coordinates)
        if (std::isnan(uv.x)) uv = Imath::V2d(0.0);  // no triangle's, or seen by no texture
    if (!mesh.normals.empty()) turn_to_normals(mesh);
    return mesh;
}

/// 0.6 gives an OBJ file's parts the materials of its library, unless the shape has one.
void require_no_library(const XmlElement& element, Properties& properties, const ObjMesh& obj, bool has_bsdf) {
    const bool is_loaded = properties.boolean("load_materials").value_or(true);
    if (has_bsdf || !is_loaded || obj.material_library.empty()) return;
    std::error_code ignored;
    if (std::filesystem::exists(element.file_called(obj.material_library), ignored))
        throw InputError(element.place,
                         fmt::format("obj: its materials are in \"{}\", which is not read here: expected a bsdf, or "
                                     "<boolean name=\"loadMaterials\" value=\"false\"/>",
                                     obj.material_library));
}

MeshDescription read_obj(const XmlElement& element, Properties& properties, const Placement& placement,
                         const ShapeSource& source) {
    const auto filename = properties.text("filename");
    if (!filename) throw InputError(element.place, "obj: expected a <string name=\"filename\">");
    const bool is_version_06 = placement.family == MitsubaFamily::Version06;
    ObjOptions options{.family = placement.family};
    options.face_normals = properties.boolean("face_normals").value_or(false);
    options.flip_v = properties.boolean("flip_tex_coords").value_or(true);
    if (is_version_06) options.separate_groups = !properties.boolean("collapse").value_or(false);
    const std::filesystem::path file = element.file_called(*filename);
    read_part(file, properties.place_of("filename"), source.bytes_read);
    ObjMesh obj = read_obj_mesh(file, options);
    if (is_version_06) require_no_library(element, properties, obj, source.has_bsdf);
    if (obj.mesh.triangles.empty()) source.note(fmt::format("{}: has no faces", file.string()));
    return place_obj(std::move(obj.mesh), placement, options.face_normals, source.has_texture);
}

// ---------------------------------------------------------------------------------------------------------------------

/// The world's directions of the local axes, unit length.
TextureAxes texture_axes(const Matrix& to_world) {
    return {transform_direction(to_world, {1, 0, 0}).normalized(),
            transform_direction(to_world, {0, 1, 0}).normalized(),
            transform_direction(to_world, {0, 0, 1}).normalized()};
}

/// 0.6 takes the scale out of to_world before it looks at the centre; 3 turns the normals when to_world mirrors.
SphereDescription read_sphere(const XmlElement& element, Properties& properties, const Placement& placement) {
    const VectorD centre = properties.vector("center").value_or(VectorD(0.0));
    const double radius = properties.number("radius").value_or(1.0);
    if (!(radius > 0.0))
        throw InputError(properties.place_of("radius"),
                         fmt::format("radius: expected a number above 0, got {}", radius));
    const double scale = uniform_scale(placement.to_world, 3, element.place);
    const bool is_version_06 = placement.family == MitsubaFamily::Version06;
    const bool is_mirrored = handedness(placement.to_world) < 0.0;
    return {.centre = transform_point(placement.to_world, is_version_06 ? centre / scale : centre),
            .radius = radius * scale,
            .flip_normals = placement.flip_normals != (is_mirrored && !is_version_06),
            .texture_axes = texture_axes(placement.to_world)};
}

DiskDescription read_disk(const XmlElement& element, const Placement& placement) {
    return {.centre = transform_point(placement.to_world, VectorD(0.0)),
            .normal = transform_normal(placement.to_world, {0.0, 0.0, placement.flip_normals ? -1.0 : 1.0}),
            .radius = uniform_scale(placement.to_world, 2, element.place),
            .texture_axes = texture_axes(placement.to_world)};
}

}  // namespace

Geometry read_geometry(const XmlElement& element, Properties& properties, const ShapeSource& source) {
    const std::string& type = element.require("type");
    const Placement placement{.to_world = properties.transform("to_world").value_or(Matrix()),
                              .flip_normals = properties.boolean("flip_normals").value_or(false),
                              .family = element.family()};
    if (type == "obj") return read_obj(element, properties, placement, source);
    if (type == "sphere") return read_sphere(element, properties, placement);
    if (type == "disk") return read_disk(element, placement);
    if (type == "rectangle" || type == "cube") {
        properties.boolean("face_normals");  // they are flat either way
        return place_flat(type == "cube" ? cube() : rectangle(), placement);
    }
    throw InputError(element.place,
                     fmt::format("unknown shape \"{}\"; known here: cube, disk, obj, rectangle, sphere", type));
}

}  // namespace photonlab
