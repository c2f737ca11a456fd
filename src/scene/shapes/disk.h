// A flat disk.

#pragma once

#include "scene/shapes/surface.h"

namespace photonlab {

struct Disk;

/// Texture coordinates: u is the distance from the centre in radii, v the angle from the first axis to the second; 1 is
/// once around. The first two axes are in the disk's plane.
struct DiskDescription {
    VectorD centre;
    VectorD normal;       ///< unit length
    double radius = 1.0;  ///< > 0
    TextureAxes texture_axes = scene_axes;

    void check(const std::string& place) const;
    Disk placed(const ToUnitBox& to_unit_box, const ShapeUse& use) const;
    Bounds bounds() const;
};

struct Disk {
    static constexpr const char* name = "disk";
    using Description = DiskDescription;

    Frame frame;  ///< its normal is the disk's
    Vector centre;
    float radius;
    std::optional<TextureAxes> texture_axes;  ///< where its material has a texture

    static DiskDescription read(ShapeReader& reader);

    double area() const { return pi * radius * radius; }
    Extent extent() const;
    Roots roots(const VectorD& origin, const VectorD& direction) const;
    void complete(Hit& hit, const Ray& ray, float, float) const;
    SurfaceTangents tangents(const Hit& hit) const;
    std::vector<SurfacePoint> probes() const;
    double distance_to(const Vector& position) const;
    std::optional<Vector> whole_within(const Vector& position, double distance) const;
    SurfacePoint sample_area(const Imath::V2f& u, double) const;
};

}  // namespace photonlab
