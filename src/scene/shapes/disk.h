// A flat disk.

#pragma once

#include "core/sampling.h"
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
    std::optional<TextureAxes> texture_axes;  ///< where its material or its light has a texture

    static DiskDescription read(ShapeReader& reader);

    double area() const { return pi * radius * radius; }
    Extent extent() const;
    Roots roots(const VectorD& origin, const VectorD& direction) const;
    void complete(Hit& hit, const Ray& ray, float, float) const;
    SurfaceTangents tangents(const Hit& hit) const;
    Imath::V2f texture_coordinate_at(const Vector& position) const;
    std::vector<SurfacePoint> probes() const;
    double distance_to(const Vector& position) const;
    std::optional<Vector> whole_within(const Vector& position, double distance) const;
    SurfacePoint sample_area(const Imath::V2f& u, double) const;

private:
    Imath::V2f texture_coordinate_of(const VectorD& from_centre, const TextureAxes& axes) const;
};

inline Roots Disk::roots(const VectorD& origin, const VectorD& direction) const {
    const VectorD normal(frame.normal);
    const double slope = direction.dot(normal);
    if (slope == 0.0) return {};
    const double t = (VectorD(centre) - origin).dot(normal) / slope;
    const VectorD offset = origin + direction * t - VectorD(centre);
    return offset.length2() <= static_cast<double>(radius) * radius ? Roots{1, {t, 0.0}} : Roots{};
}

inline void Disk::complete(Hit& hit, const Ray& ray, float, float) const {
    const VectorD normal(frame.normal);
    const VectorD middle(centre);
    const VectorD position = VectorD(ray.origin) + VectorD(ray.direction) * hit.distance;
    hit.position = Vector(position - normal * (position - middle).dot(normal));
    hit.geometric_normal = frame.normal;
    hit.shading_normal = frame.normal;
    if (texture_axes) hit.texture_coordinate = texture_coordinate_of(position - middle, *texture_axes);
}

inline Imath::V2f Disk::texture_coordinate_of(const VectorD& from_centre, const TextureAxes& axes) const {
    const double x = from_centre.dot(axes[0]) / radius;
    const double y = from_centre.dot(axes[1]) / radius;
    return Imath::V2f(Imath::V2d(std::hypot(x, y), turn_to(x, y)));
}

inline SurfacePoint Disk::sample_area(const Imath::V2f& u, double) const {
    const Imath::V2f point = sample_unit_disc(u) * radius;
    return {centre + frame.tangent * point.x + frame.bitangent * point.y, frame.normal};
}

}  // namespace photonlab
