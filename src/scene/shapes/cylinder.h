// The side of a cylinder, open at its ends, met in double.

#pragma once

#include "scene/shapes/surface.h"

namespace photonlab {

struct Cylinder;

/// Texture coordinates: u is the angle about the axis, from the first axis to the second, once around, and v the share
/// of the way along the axis.
struct CylinderDescription {
    VectorD base;         ///< middle of the circle that it begins at
    double radius = 1.0;  ///< > 0
    double length = 1.0;  ///< > 0, along the third axis
    TextureAxes axes = scene_axes;
    bool flip_normals = false;  ///< true: the normal points to the axis

    void check(const std::string& place) const;
    Cylinder placed(const ToUnitBox& to_unit_box, const ShapeUse& use) const;
    Bounds bounds() const;
};

struct Cylinder {
    static constexpr const char* name = "cylinder";
    using Description = CylinderDescription;

    Vector base;
    float radius;
    float length;
    TextureAxes axes;
    float orientation;  ///< +1: the normal points outwards; -1: to the axis

    static CylinderDescription read(ShapeReader& reader);

    double area() const { return 2.0 * pi * radius * length; }
    Extent extent() const;
    Roots roots(const VectorD& origin, const VectorD& direction) const;
    void complete(Hit& hit, const Ray& ray, float, float) const;
    SurfaceTangents tangents(const Hit& hit) const;
    Imath::V2f texture_coordinate_at(const Vector& position) const;
    std::vector<SurfacePoint> probes() const;
    SurfacePoint sample_area(const Imath::V2f& u, double) const { return point_at(u.x, u.y); }

private:
    SurfacePoint point_at(double turn, double share) const;
};

}  // namespace photonlab
