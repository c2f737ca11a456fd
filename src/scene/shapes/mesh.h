// Triangles over shared vertices: what most shapes of scene files are read as, and what Embree meets itself.

#pragma once

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

    std::vector<Vector> positions;
    std::vector<Vector> normals;                  ///< shading normals, one a vertex, or empty
    std::vector<Imath::V2f> texture_coordinates;  ///< one a vertex; empty: barycentric
    std::vector<Imath::Vec3<std::uint32_t>> triangles;
    std::vector<Vector> geometric_normals;  ///< unit, one a triangle; 0 for a triangle without area
    double surface_area = 0.0;              ///< where it emits, a triangle that is there twice counts once
    std::vector<double> triangle_cdf;       ///< where it emits: running share of the area, last is 1

    double area() const { return surface_area; }
    void complete(Hit& hit, const Ray& ray, float u, float v) const;
    SurfaceTangents tangents(const Hit& hit) const;
    SurfacePoint sample_area(const Imath::V2f& u, double u_triangle) const;
};

}  // namespace photonlab
