// A sphere, met in double: a float32 quadratic loses one that is seen from far away.

#pragma once

#include "core/sampling.h"
#include "scene/shapes/surface.h"

namespace photonlab {

struct Sphere;

/// Texture coordinates: u is the angle about the third axis, from the first axis to the second, and v that from the
/// third axis; 1 is once around, and at the opposite pole.
struct SphereDescription {
    VectorD centre;
    double radius = 1.0;        ///< > 0
    bool flip_normals = false;  ///< true: the normal points to the centre
    TextureAxes texture_axes = scene_axes;

    void check(const std::string& place) const { require_round(centre, radius, place); }
    Sphere placed(const ToUnitBox& to_unit_box, const ShapeUse& use) const;
    Bounds bounds() const { return {centre - VectorD(radius), centre + VectorD(radius)}; }
};

struct Sphere {
    static constexpr const char* name = "sphere";
    using Description = SphereDescription;

    Vector centre;
    float radius;
    float orientation;                        ///< +1: the normal points outwards; -1: to the centre
    std::optional<TextureAxes> texture_axes;  ///< where its material or its light has a texture

    static SphereDescription read(ShapeReader& reader);

    double area() const { return 4.0 * pi * radius * radius; }
    Extent extent() const { return {centre, Vector(radius)}; }
    Roots roots(const VectorD& origin, const VectorD& direction) const;
    void complete(Hit& hit, const Ray& ray, float, float) const;
    SurfaceTangents tangents(const Hit& hit) const;
    Imath::V2f texture_coordinate_at(const Vector& position) const;
    std::vector<SurfacePoint> probes() const;
    double distance_to(const Vector& position) const;
    std::optional<Vector> whole_within(const Vector& position, double distance) const;

    SurfacePoint sample_area(const Imath::V2f& u, double) const;
    /// By the solid angle of the visible cap, whose density is constant; empty from inside, from on it, and where it
    /// faces inwards. [Shirley, Wang & Zimmerman 1996, "Monte Carlo Techniques for Direct Lighting Calculations"]
    std::optional<SeenPoint> sample_seen(const Vector& receiver, const Imath::V2f& u) const;
    std::optional<double> seen_density(const Vector& receiver) const;

private:
    static Imath::V2f texture_coordinate_along(const VectorD& outward, const TextureAxes& texture_axes);
};

/// The quadratic in the form that does not cancel: the root of larger magnitude by addition, the other by division.
inline Roots Sphere::roots(const VectorD& origin, const VectorD& direction) const {
    const VectorD offset = origin - VectorD(centre);
    const double a = direction.length2();
    const double half_b = offset.dot(direction);
    // The discriminant from the closest point's distance, which stays accurate for far origins.
    const VectorD closest = offset - direction * (half_b / a);
    const double discriminant = a * (static_cast<double>(radius) * radius - closest.length2());
    if (!(discriminant >= 0.0)) return {};
    const double c = (offset.length() - radius) * (offset.length() + radius);
    const double q = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
    double near = q / a;
    double far = q != 0.0 ? c / q : near;
    if (near > far) std::swap(near, far);
    return {2, {near, far}};
}

inline void Sphere::complete(Hit& hit, const Ray& ray, float, float) const {
    const VectorD middle(centre);
    const VectorD outward = (VectorD(ray.origin) + VectorD(ray.direction) * hit.distance - middle).normalized();
    hit.position = Vector(middle + outward * radius);
    hit.geometric_normal = Vector(outward) * orientation;
    hit.shading_normal = hit.geometric_normal;
    if (texture_axes) hit.texture_coordinate = texture_coordinate_along(outward, *texture_axes);
}

inline Imath::V2f Sphere::texture_coordinate_along(const VectorD& outward, const TextureAxes& texture_axes) {
    const auto& [x, y, z] = texture_axes;
    const double from_pole = std::acos(std::clamp(outward.dot(z), -1.0, 1.0)) / pi;
    return Imath::V2f(Imath::V2d(turn_to(outward.dot(x), outward.dot(y)), from_pole));
}

inline SurfacePoint Sphere::sample_area(const Imath::V2f& u, double) const {
    const Vector outward = sample_unit_sphere(u);
    return {centre + outward * radius, outward * orientation};
}

}  // namespace photonlab
