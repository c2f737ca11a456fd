#include "scene/shapes/mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <tuple>

#include "core/error.h"

namespace photonlab {

void MeshDescription::check(const std::string& place) const {
    for (std::size_t i = 0; i < positions.size(); ++i)
        if (!is_finite(positions[i])) throw InputError(place, fmt::format("vertex {} is not finite", i + 1));
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const auto& triangle = triangles[i];
        if (std::max({triangle.x, triangle.y, triangle.z}) >= positions.size())
            throw InputError(place, fmt::format("triangle {}: expected vertices below {}, got {} {} {}", i + 1,
                                                positions.size(), triangle.x, triangle.y, triangle.z));
    }
    if (!normals.empty() && normals.size() != positions.size())
        throw InputError(
            place, fmt::format("expected a normal for each of {} vertices, got {}", positions.size(), normals.size()));
    if (!texture_coordinates.empty() && texture_coordinates.size() != positions.size())
        throw InputError(place, fmt::format("expected texture coordinates for each of {} vertices, got {}",
                                            positions.size(), texture_coordinates.size()));
    for (std::size_t i = 0; i < normals.size(); ++i)
        if (!is_finite(normals[i])) throw InputError(place, fmt::format("normal {} is not finite", i + 1));
    for (std::size_t i = 0; i < texture_coordinates.size(); ++i)
        if (!std::isfinite(texture_coordinates[i].x) || !std::isfinite(texture_coordinates[i].y))
            throw InputError(place, fmt::format("texture coordinates {} are not finite", i + 1));
}

Bounds MeshDescription::bounds() const {
    Bounds bounds;
    for (const auto& triangle : triangles)
        for (const std::uint32_t corner : {triangle.x, triangle.y, triangle.z}) bounds.include(positions[corner]);
    return bounds;
}

// ---------------------------------------------------------------------------------------------------------------------

namespace {

/// Nine numbers that tell two triangles apart, whichever corner they begin with.
std::array<double, 9> identity_of(std::array<VectorD, 3> triangle) {
    const auto is_before = [](const VectorD& a, const VectorD& b) {
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    };
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end(), is_before), triangle.end());
    std::array<double, 9> numbers{};
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = triangle[i / 3][static_cast<int>(i % 3)];
    return numbers;
}

}  // namespace

TriangleMesh MeshDescription::placed(const ToUnitBox& to_unit_box, const ShapeUse& use) const {
    TriangleMesh mesh;
    mesh.triangles = triangles;
    std::vector<VectorD> exact;  // not rounded to float, which turns the plane of a sliver
    exact.reserve(positions.size());
    for (const VectorD& position : positions) exact.push_back(to_unit_box.exact(position));
    mesh.positions.reserve(exact.size() + 1);
    mesh.positions.assign(exact.begin(), exact.end());
    mesh.normals.assign(normals.begin(), normals.end());
    mesh.texture_coordinates.reserve(texture_coordinates.size());
    for (const Imath::V2d& uv : texture_coordinates)
        mesh.texture_coordinates.emplace_back(static_cast<float>(uv.x), static_cast<float>(uv.y));
    std::set<std::array<double, 9>> shining;  // a triangle that is there twice shines once
    mesh.geometric_normals.reserve(triangles.size());
    for (const auto& corners : triangles) {
        const std::array<VectorD, 3> triangle{exact[corners.x], exact[corners.y], exact[corners.z]};
        const VectorD normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
        mesh.geometric_normals.emplace_back(normal.normalized());
        if (!use.emits || shining.insert(identity_of(triangle)).second) mesh.surface_area += 0.5 * normal.length();
        if (use.emits) mesh.triangle_cdf.push_back(mesh.surface_area);
    }
    if (mesh.surface_area > 0.0)
        for (double& share : mesh.triangle_cdf) share /= mesh.surface_area;
    return mesh;
}

std::array<Imath::V2f, 3> TriangleMesh::texture_coordinates_of(std::size_t triangle) const {
    if (texture_coordinates.empty()) return {Imath::V2f(0.0f, 0.0f), Imath::V2f(1.0f, 0.0f), Imath::V2f(0.0f, 1.0f)};
    const auto& corners = triangles[triangle];
    return {texture_coordinates[corners.x], texture_coordinates[corners.y], texture_coordinates[corners.z]};
}

Imath::V2f TriangleMesh::texture_coordinate_on(std::size_t triangle, const Imath::V2f& u) const {
    const auto [a, b, c] = texture_coordinates_of(triangle);
    const Imath::V2f weights = sample_triangle(u);
    return a * (1.0f - weights.x - weights.y) + b * weights.x + c * weights.y;
}

/// Texture coordinates are linear over a triangle, so its edges give the two; where they do not tell u from v, any two
/// in its plane.
SurfaceTangents TriangleMesh::tangents(const Hit& hit) const {
    const auto& triangle = triangles[hit.primitive];
    const VectorD first = VectorD(positions[triangle.y]) - VectorD(positions[triangle.x]);
    const VectorD second = VectorD(positions[triangle.z]) - VectorD(positions[triangle.x]);
    if (texture_coordinates.empty()) return {first, second};
    const Imath::V2d a(texture_coordinates[triangle.x]);
    const Imath::V2d uv_first = Imath::V2d(texture_coordinates[triangle.y]) - a;
    const Imath::V2d uv_second = Imath::V2d(texture_coordinates[triangle.z]) - a;
    const double area = uv_first.x * uv_second.y - uv_first.y * uv_second.x;
    if (area == 0.0) {
        const Frame frame = make_frame(hit.geometric_normal);
        return {VectorD(frame.tangent), VectorD(frame.bitangent)};
    }
    return {(first * uv_second.y - second * uv_first.y) / area, (second * uv_first.x - first * uv_second.x) / area};
}

}  // namespace photonlab
