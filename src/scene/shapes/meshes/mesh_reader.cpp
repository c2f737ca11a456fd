#include "scene/shapes/meshes/mesh_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/machine/available_memory.h"
#include "scene/shapes/meshes/creases.h"

namespace photonlab {

void fill_in_normals(MeshDescription& mesh) {
    mesh.normals.resize(mesh.positions.size(), VectorD(0.0));
    if (std::find(mesh.normals.begin(), mesh.normals.end(), VectorD(0.0)) == mesh.normals.end()) return;
    std::vector<VectorD> computed(mesh.positions.size(), VectorD(0.0));
    for (const auto& triangle : mesh.triangles) {
        const VectorD& a = mesh.positions[triangle.x];
        const VectorD& b = mesh.positions[triangle.y];
        const VectorD& c = mesh.positions[triangle.z];
        const std::array<VectorD, 3> to_next{(b - a).normalized(), (c - b).normalized(), (a - c).normalized()};
        for (std::size_t i = 0; i < 3; ++i) {
            const VectorD to_last = -to_next[(i + 2) % 3];
            const VectorD cross = to_next[i].cross(to_last);
            computed[triangle[static_cast<int>(i)]] +=
                cross.normalized() * std::atan2(cross.length(), to_next[i].dot(to_last));
        }
    }
    for (std::size_t i = 0; i < computed.size(); ++i)
        if (mesh.normals[i] == VectorD(0.0)) mesh.normals[i] = computed[i].normalized();
}

namespace {

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

/// For triangles that turn() turned or Mitsuba did. It exchanges other corners, 3 the first and last, and 0.6 the first
/// and second: where a mirroring is to keep the outside, and for flip_normals where it does not turn vertex normals
/// instead.
CornerOrder corner_order(const ShapeReader& reader, const MeshPlacing& placing, bool is_turned) {
    if (!reader.is_version_06()) return is_turned ? CornerOrder{1, 2, 0} : CornerOrder{0, 1, 2};
    const bool is_mirrored = placing.keeps_outside && handedness(reader.to_world) < 0.0;
    const bool is_exchanged = is_mirrored != (placing.face_normals && reader.flip_normals);
    if (!is_turned) return is_exchanged ? CornerOrder{1, 0, 2} : CornerOrder{0, 1, 2};
    return is_exchanged ? CornerOrder{2, 0, 1} : CornerOrder{0, 2, 1};
}

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

/// Asks for what is made up of a mesh, which can be several times what its file holds.
void require_memory_for_placing(const MeshDescription& mesh, const ShapeReader& reader, const MeshPlacing& placing) {
    std::uint64_t bytes = 0;
    if (!placing.face_normals) bytes += mesh.positions.size() * sizeof(VectorD) * (mesh.normals.empty() ? 2 : 1);
    if (reader.has_texture && mesh.texture_coordinates.empty())
        bytes += mesh.positions.size() * sizeof(Imath::V2d) +
                 3 * mesh.triangles.size() * (2 * sizeof(VectorD) + sizeof(Imath::V2d));
    require_memory_for(reader.element.place, bytes);
}

}  // namespace

std::optional<double> read_max_smooth_angle(ShapeReader& reader, bool face_normals) {
    if (!reader.is_version_06()) return std::nullopt;
    const std::optional<double> angle = reader.properties.number("max_smooth_angle");
    if (angle && face_normals)
        throw InputError(
            reader.properties.place_of("max_smooth_angle"),
            fmt::format("{}: expected max_smooth_angle or face_normals", reader.element.attribute("type")));
    return angle;
}

MeshDescription place_mesh(MeshDescription mesh, const ShapeReader& reader, const MeshPlacing& placing) {
    require_memory_for_placing(mesh, reader, placing);
    const Matrix& to_world = reader.to_world;
    for (VectorD& position : mesh.positions) position = transform_point(to_world, position);
    const Matrix normals_to_world = matrix_of_normals(to_world);
    for (VectorD& normal : mesh.normals)
        if (normal != VectorD(0.0))
            normal = transform_direction(normals_to_world, reader.flip_normals ? -normal : normal).normalized();
    const bool is_kept = placing.keeps_outside || !reader.is_version_06();
    const bool is_turned = is_kept ? reader.turns_triangles() : reader.flip_normals;
    if (is_turned) std::for_each(mesh.triangles.begin(), mesh.triangles.end(), turn);
    if (placing.max_smooth_angle)
        split_at_creases(mesh, *placing.max_smooth_angle, placing.groups, reader.element.place);
    if (!placing.face_normals) fill_in_normals(mesh);
    if (reader.has_texture) add_barycentric_coordinates(mesh, corner_order(reader, placing, is_turned));
    for (Imath::V2d& uv : mesh.texture_coordinates)
        if (std::isnan(uv.x)) uv = Imath::V2d(0.0);  // no triangle's, or seen by no texture
    if (!mesh.normals.empty()) turn_to_normals(mesh);
    return mesh;
}

}  // namespace photonlab
