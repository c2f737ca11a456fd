// Triangles over shared vertices: what most shapes of scene files are read as, and what Embree meets itself.

#pragma once

#include "core/sampling.h"
#include "scene/shapes/surface.h"

namespace photonlab {

struct TriangleMesh;

/// Triangles over shared vertices, counter-clockwise seen from outside.
struct MeshDescription {
    std::vector<VectorD> positions;
    std::vector<VectorD> normals;                 ///< one a vertex, unit length; empty: flat shading
    std::vector<Imath::V2d> texture_coordinates;  ///< one a vertex; empty: barycentric, those of the second and third
    std::vector<Imath::Vec3<std::uint32_t>> triangles;

    /// Throws InputError for what cannot be rendered.
    void check(const std::string& place) const;
    Bounds bounds() const;
    TriangleMesh placed(const ToUnitBox& to_unit_box, const ShapeUse& use) const;
};

struct TriangleMesh {
    static constexpr const char* name = "mesh";

    std::vector<Vector> positions;                ///< with room for one more: Embree reads 16 bytes of each
    std::vector<Vector> normals;                  ///< shading normals, one a vertex, or empty
    std::vector<Imath::V2f> texture_coordinates;  ///< one a vertex; empty: barycentric
    std::vector<Imath::Vec3<std::uint32_t>> triangles;
    std::vector<Vector> geometric_normals;  ///< unit, one a triangle; 0 for a triangle without area
    double surface_area = 0.0;              ///< where it emits, a triangle that is there twice counts once
    std::vector<double> triangle_cdf;       ///< where it emits: running share of the area, last is 1

    double area() const { return surface_area; }
    void complete(Hit& hit, const Ray& ray, float u, float v) const;
    SurfaceTangents tangents(const Hit& hit) const;
    SurfacePoint sample_area(const Imath::V2f& u, double u_triangle) const {
        return point_on(triangle_at(u_triangle), u);
    }

    std::size_t triangle_at(double u_triangle) const;  ///< by area, where it emits
    /// A point of one triangle, uniform in area, and its texture coordinate.
    SurfacePoint point_on(std::size_t triangle, const Imath::V2f& u) const;
    Imath::V2f texture_coordinate_on(std::size_t triangle, const Imath::V2f& u) const;
    /// Texture coordinates of a triangle's corners.
    std::array<Imath::V2f, 3> texture_coordinates_of(std::size_t triangle) const;
};

/// Completes a hit on a triangle. The position comes from the vertices, which is more accurate than origin + t
/// direction.
inline void TriangleMesh::complete(Hit& hit, const Ray& ray, float u, float v) const {
    const auto& triangle = triangles[hit.primitive];
    const float w = 1.0f - u - v;
    const Vector& a = positions[triangle.x];
    const Vector& b = positions[triangle.y];
    const Vector& c = positions[triangle.z];
    hit.position = a * w + b * u + c * v;
    hit.geometric_normal = geometric_normals[hit.primitive];
    // A triangle without area has no normal of its own; facing the ray is as good as any.
    if (hit.geometric_normal == Vector(0.0f)) hit.geometric_normal = -ray.direction;
    hit.shading_normal = hit.geometric_normal;
    if (!normals.empty()) {
        const VectorD interpolated =
            VectorD(normals[triangle.x]) * w + VectorD(normals[triangle.y]) * u + VectorD(normals[triangle.z]) * v;
        if (interpolated.length2() > 0.0) {
            hit.shading_normal = Vector(interpolated.normalized());
            if (hit.shading_normal.dot(hit.geometric_normal) < 0.0f) hit.shading_normal = -hit.shading_normal;
        }
    }
    if (!texture_coordinates.empty())
        hit.texture_coordinate = texture_coordinates[triangle.x] * w + texture_coordinates[triangle.y] * u +
                                 texture_coordinates[triangle.z] * v;
    else
        hit.texture_coordinate = Imath::V2f(u, v);
}

inline std::size_t TriangleMesh::triangle_at(double u_triangle) const {
    const auto found = std::upper_bound(triangle_cdf.begin(), triangle_cdf.end() - 1, u_triangle);
    return static_cast<std::size_t>(found - triangle_cdf.begin());
}

inline SurfacePoint TriangleMesh::point_on(std::size_t index, const Imath::V2f& u) const {
    const auto& triangle = triangles[index];
    const Vector& a = positions[triangle.x];
    const Vector& b = positions[triangle.y];
    const Vector& c = positions[triangle.z];
    const Imath::V2f weights = sample_triangle(u);
    return {a * (1.0f - weights.x - weights.y) + b * weights.x + c * weights.y, geometric_normals[index]};
}

}  // namespace photonlab
