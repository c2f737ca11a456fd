#include "scene/shapes/sphere.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/sampling.h"
#include "scene/mitsuba/transform.h"
#include "scene/shapes/shape_reader.h"

namespace photonlab {

/// 0.6 takes the scale out of to_world before it looks at the centre; 3 turns the normals when to_world mirrors.
SphereDescription Sphere::read(ShapeReader& reader) {
    Properties& properties = reader.properties;
    const VectorD centre = properties.vector("center").value_or(VectorD(0.0));
    const double radius = properties.number("radius").value_or(1.0);
    if (!(radius > 0.0))
        throw InputError(properties.place_of("radius"),
                         fmt::format("radius: expected a number above 0, got {}", radius));
    const double scale = uniform_scale(reader.to_world, 3, reader.element.place);
    const bool is_mirrored = handedness(reader.to_world) < 0.0;
    return {.centre = transform_point(reader.to_world, reader.is_version_06() ? centre / scale : centre),
            .radius = radius * scale,
            .flip_normals = reader.flip_normals != (is_mirrored && !reader.is_version_06()),
            .texture_axes = reader.texture_axes()};
}

Sphere SphereDescription::placed(const ToUnitBox& to_unit_box, const ShapeUse& use) const {
    return {.centre = to_unit_box(centre),
            .radius = to_unit_box.length(radius),
            .orientation = flip_normals ? -1.0f : 1.0f,
            .texture_axes = use.has_texture ? std::optional(texture_axes) : std::nullopt};
}

SurfaceTangents Sphere::tangents(const Hit& hit) const {
    const auto& [x, y, z] = texture_axes.value_or(scene_axes);
    const VectorD from_centre = VectorD(hit.position) - VectorD(centre);
    const double along_x = from_centre.dot(x);
    const double along_y = from_centre.dot(y);
    const double from_axis = std::hypot(along_x, along_y);
    const VectorD outward =
        from_axis > 0.0 ? x * (along_x / from_axis) + y * (along_y / from_axis) : x;  // at a pole, any direction
    return {(y * along_x - x * along_y) * (2.0 * pi), (outward * from_centre.dot(z) - z * from_axis) * pi};
}

Imath::V2f Sphere::texture_coordinate_at(const Vector& position) const {
    return texture_coordinate_along((VectorD(position) - VectorD(centre)).normalized(),
                                    texture_axes.value_or(scene_axes));
}

std::vector<SurfacePoint> Sphere::probes() const {
    std::vector<SurfacePoint> points;
    // Not along the axes, where spheres rest on floors: a single point of contact does no harm.
    for (const float x : {-1.0f, 1.0f})
        for (const float y : {-1.0f, 1.0f})
            for (const float z : {-1.0f, 1.0f}) {
                const Vector outward = Vector(x, 0.9f * y, 0.8f * z).normalized();
                points.push_back({centre + outward * radius, outward});
            }
    return points;
}

double Sphere::distance_to(const Vector& position) const {
    return std::abs((VectorD(position) - VectorD(centre)).length() - radius);
}

/// Photons on a sphere lie within the chord r on exactly pi r^2 of it; normals turn by 60 degrees over a chord as long
/// as the radius, and a little is left for how photons keep them. [docs/theory.md, section 4]
std::optional<Vector> Sphere::whole_within(const Vector& position, double distance) const {
    const VectorD outward = VectorD(position) - VectorD(centre);
    const double from_centre = outward.length();
    if (distance > 0.95 * radius || std::abs(from_centre - radius) > 1e-6) return std::nullopt;
    return Vector(outward / from_centre) * orientation;
}

// ---------------------------------------------------------------------------------------------------------------------

namespace {

/// The cone under which an outward emitting sphere is seen; empty from inside it or from on it.
struct Cone {
    VectorD axis;     // unit
    double distance;  // to the centre
    double one_minus_cos_max;
    double density;  // per steradian
};

std::optional<Cone> visible_cone(const Sphere& sphere, const Vector& receiver) {
    const VectorD to_centre = VectorD(sphere.centre) - VectorD(receiver);
    const double distance = to_centre.length();
    const double radius = sphere.radius;
    if (sphere.orientation < 0.0f || !(distance > radius)) return std::nullopt;
    const double sin_squared = (radius / distance) * (radius / distance);
    const double cos_max = std::sqrt((distance - radius) * (distance + radius)) / distance;
    const double one_minus_cos_max = sin_squared / (1.0 + cos_max);  // does not cancel for a small or far sphere
    return Cone{to_centre / distance, distance, one_minus_cos_max, 1.0 / (2.0 * pi * one_minus_cos_max)};
}

}  // namespace

std::optional<SeenPoint> Sphere::sample_seen(const Vector& receiver, const Imath::V2f& u) const {
    const std::optional<Cone> seen = visible_cone(*this, receiver);
    if (!seen) return std::nullopt;
    const Cone& cone = *seen;
    const Vector local = sample_cone(u, static_cast<float>(cone.one_minus_cos_max));
    const Frame frame = make_frame(Vector(cone.axis));
    const Vector direction = frame.to_world(local);
    // Nearest intersection with the sphere: the direction was drawn inside the cone, so rounding aside there is one.
    // Relative to the centre and in the cone's frame, because a small sphere is lost in the rounding of receiver + t
    // direction.
    const double sine_squared = static_cast<double>(local.x) * local.x + static_cast<double>(local.y) * local.y;
    const double along = cone.distance * std::sqrt(std::max(0.0, 1.0 - sine_squared));
    const double half_chord =
        std::sqrt(std::max(0.0, static_cast<double>(radius) * radius - cone.distance * cone.distance * sine_squared));
    const double x = local.x * (along - half_chord) / radius;
    const double y = local.y * (along - half_chord) / radius;
    const double towards_receiver = std::sqrt(std::max(0.0, 1.0 - x * x - y * y));
    const Vector normal = frame.to_world(Vector(VectorD(x, y, -towards_receiver).normalized())).normalized();
    const Vector position(VectorD(centre) + VectorD(normal) * radius);
    return SeenPoint{
        .position = offset_from_surface(position, normal, normal), .direction = direction, .density = cone.density};
}

std::optional<double> Sphere::seen_density(const Vector& receiver) const {
    const std::optional<Cone> cone = visible_cone(*this, receiver);
    return cone ? std::optional(cone->density) : std::nullopt;
}

}  // namespace photonlab
