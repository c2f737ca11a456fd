#include "scene/shapes/cylinder.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"
#include "scene/mitsuba/transform.h"
#include "scene/shapes/shape_reader.h"

namespace photonlab {

void CylinderDescription::check(const std::string& place) const {
    require_round(base, radius, place);
    if (!std::isfinite(length) || !(length > 0.0))
        throw InputError(place, fmt::format("expected a cylinder longer than 0, got {}", length));
}

namespace {

/// How far a circle across `axis` reaches along the scene's axes, in its radii.
VectorD reach_across(const VectorD& axis) {
    VectorD reach;
    for (int i = 0; i < 3; ++i) reach[i] = std::sqrt(std::max(0.0, 1.0 - axis[i] * axis[i]));
    return reach;
}

/// Two directions across the unit `axis`: Mitsuba's coordinate_system(), each family's own.
std::pair<VectorD, VectorD> across(const VectorD& axis, MitsubaFamily family) {
    if (family == MitsubaFamily::Version06) {
        const VectorD second =
            (std::abs(axis.x) > std::abs(axis.y) ? VectorD(axis.z, 0.0, -axis.x) : VectorD(0.0, axis.z, -axis.y))
                .normalized();
        return {second.cross(axis), second};
    }
    const Frame frame = make_frame(Vector(axis));
    const VectorD first = (VectorD(frame.tangent) - axis * axis.dot(VectorD(frame.tangent))).normalized();
    return {first, axis.cross(first)};
}

}  // namespace

Bounds CylinderDescription::bounds() const {
    const VectorD reach = reach_across(axes[2]) * radius;
    Bounds bounds;
    for (const VectorD& middle : {base, base + axes[2] * length}) {
        bounds.include(middle - reach);
        bounds.include(middle + reach);
    }
    return bounds;
}

CylinderDescription Cylinder::read(ShapeReader& reader) {
    Properties& properties = reader.properties;
    const VectorD from = properties.vector("p0").value_or(VectorD(0.0));
    const VectorD to = properties.vector("p1").value_or(VectorD(0.0, 0.0, 1.0));
    const double radius = properties.number("radius").value_or(1.0);
    if (!(radius > 0.0))
        throw InputError(properties.place_of("radius"),
                         fmt::format("radius: expected a number above 0, got {}", radius));
    if (from == to) throw InputError(properties.place_of("p1"), "p1: expected another point than p0");
    const VectorD axis = (to - from).normalized();
    const auto [first, second] = across(axis, reader.element.family());
    const auto taken = [&](const VectorD& direction) { return transform_direction(reader.to_world, direction); };
    const VectorD x = taken(first), y = taken(second), z = taken(axis);
    constexpr double rounding = 1e-3;  // matrices in files are often written with few digits
    const double size = x.length();
    if (std::abs(y.length() - size) > rounding * size || std::abs(x.dot(y)) > rounding * size * size ||
        std::abs(x.dot(z)) > rounding * size * z.length() || std::abs(y.dot(z)) > rounding * size * z.length())
        throw InputError(reader.properties.place_of("to_world"),
                         "cylinder: expected a transform that keeps it round and its ends across its axis");
    // Both families take the normal from the two tangents, which a mirroring turns inwards; 3 turns it back.
    const bool is_turned_inwards = handedness(reader.to_world) < 0.0 && reader.is_version_06();
    return {.base = transform_point(reader.to_world, from),
            .radius = radius * size,
            .length = (to - from).length() * z.length(),
            .axes = {x.normalized(), y.normalized(), z.normalized()},
            .flip_normals = reader.flip_normals != is_turned_inwards};
}

Cylinder CylinderDescription::placed(const ToUnitBox& to_unit_box, const ShapeUse&) const {
    return {.base = to_unit_box(base),
            .radius = to_unit_box.length(radius),
            .length = to_unit_box.length(length),
            .axes = axes,
            .orientation = flip_normals ? -1.0f : 1.0f};
}

Extent Cylinder::extent() const {
    const VectorD half = axes[2] * (0.5 * length);
    VectorD reach = reach_across(axes[2]) * static_cast<double>(radius);
    for (int i = 0; i < 3; ++i) reach[i] += std::abs(half[i]);
    return {Vector(VectorD(base) + half), Vector(reach)};
}

/// Across the axis it is a circle; what is met beyond its ends does not count.
Roots Cylinder::roots(const VectorD& origin, const VectorD& direction) const {
    const VectorD& axis = axes[2];
    const VectorD offset = origin - VectorD(base);
    const VectorD flat_offset = offset - axis * offset.dot(axis);
    const VectorD flat = direction - axis * direction.dot(axis);
    const double a = flat.length2();
    if (a == 0.0) return {};
    const double half_b = flat_offset.dot(flat);
    const VectorD closest = flat_offset - flat * (half_b / a);
    const double discriminant = a * (static_cast<double>(radius) * radius - closest.length2());
    if (!(discriminant >= 0.0)) return {};
    const double c = (flat_offset.length() - radius) * (flat_offset.length() + radius);
    const double q = -(half_b + std::copysign(std::sqrt(discriminant), half_b));
    double both[2] = {q / a, q != 0.0 ? c / q : q / a};
    if (both[0] > both[1]) std::swap(both[0], both[1]);
    Roots roots;
    for (const double t : both) {
        const double along = (offset + direction * t).dot(axis);
        if (along >= 0.0 && along <= length) roots.t[roots.count++] = t;
    }
    return roots;
}

void Cylinder::complete(Hit& hit, const Ray& ray, float, float) const {
    const VectorD middle(base);
    const VectorD offset = VectorD(ray.origin) + VectorD(ray.direction) * hit.distance - middle;
    const double along = offset.dot(axes[2]);
    const VectorD outward = (offset - axes[2] * along).normalized();
    hit.position = Vector(middle + axes[2] * along + outward * radius);
    hit.geometric_normal = Vector(outward) * orientation;
    hit.shading_normal = hit.geometric_normal;
    hit.texture_coordinate =
        Imath::V2f(Imath::V2d(turn_to(outward.dot(axes[0]), outward.dot(axes[1])), along / length));
}

Imath::V2f Cylinder::texture_coordinate_at(const Vector& position) const {
    const VectorD offset = VectorD(position) - VectorD(base);
    return Imath::V2f(Imath::V2d(turn_to(offset.dot(axes[0]), offset.dot(axes[1])), offset.dot(axes[2]) / length));
}

SurfaceTangents Cylinder::tangents(const Hit& hit) const {
    const VectorD offset = VectorD(hit.position) - VectorD(base);
    return {(axes[1] * offset.dot(axes[0]) - axes[0] * offset.dot(axes[1])) * (2.0 * pi),
            axes[2] * static_cast<double>(length)};
}

SurfacePoint Cylinder::point_at(double turn, double share) const {
    const double angle = 2.0 * pi * turn;
    const VectorD outward = axes[0] * std::cos(angle) + axes[1] * std::sin(angle);
    return {Vector(VectorD(base) + outward * radius + axes[2] * (share * length)), Vector(outward) * orientation};
}

std::vector<SurfacePoint> Cylinder::probes() const {
    std::vector<SurfacePoint> points;
    for (const double turn : {0.05, 0.3, 0.55, 0.8})
        for (const double share : {0.2, 0.7}) points.push_back(point_at(turn, share));
    return points;
}

}  // namespace photonlab
