// Light leaves a shape uniform in area and by the cosine, so a photon's weight is the same wherever it starts. For
// direct light a sphere is sampled by the solid angle of its visible cap, whose density is constant; other shapes
// uniform in area, which becomes a density of directions by squared distance / (cosine * area).
//
// [Shirley, Wang & Zimmerman 1996, "Monte Carlo Techniques for Direct Lighting Calculations": the cone of a sphere]

#include "scene/emitter.h"

#include "core/sampling.h"

namespace photonlab {

namespace {

/// A point of a shape's surface.
struct SurfacePoint {
    Vector position;
    Vector normal;  // geometric, unit, to the emitting side
};

SurfacePoint sample_area(const TriangleMesh& mesh, const Shape& shape, const Imath::V2f& u, double u_triangle) {
    const auto& cdf = shape.triangle_cdf;
    const auto found = std::upper_bound(cdf.begin(), cdf.end() - 1, u_triangle);
    const auto index = static_cast<std::size_t>(found - cdf.begin());
    const auto& triangle = mesh.triangles[index];
    const Vector& a = mesh.positions[triangle.x];
    const Vector& b = mesh.positions[triangle.y];
    const Vector& c = mesh.positions[triangle.z];
    const Imath::V2f weights = sample_triangle(u);
    return {a * (1.0f - weights.x - weights.y) + b * weights.x + c * weights.y, mesh.geometric_normals[index]};
}

SurfacePoint sample_area(const Sphere& sphere, const Shape&, const Imath::V2f& u, double) {
    const Vector outward = sample_unit_sphere(u);
    return {sphere.centre + outward * sphere.radius, outward * sphere.orientation};
}

SurfacePoint sample_area(const Disk& disk, const Shape&, const Imath::V2f& u, double) {
    const Imath::V2f point = sample_unit_disc(u) * disk.radius;
    return {disk.centre + disk.frame.tangent * point.x + disk.frame.bitangent * point.y, disk.frame.normal};
}

SurfacePoint sample_area(const Shape& shape, const Imath::V2f& u, double u_triangle) {
    return std::visit([&](const auto& geometry) { return sample_area(geometry, shape, u, u_triangle); },
                      shape.geometry);
}

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

DirectSample sample_cone_of(const Sphere& sphere, const Cone& cone, const ColorD& radiance, const Imath::V2f& u) {
    const Vector local = sample_cone(u, static_cast<float>(cone.one_minus_cos_max));
    const Frame frame = make_frame(Vector(cone.axis));
    const Vector direction = frame.to_world(local);
    // Nearest intersection with the sphere: the direction was drawn inside the cone, so rounding aside there is one.
    // Relative to the centre and in the cone's frame, because a small sphere is lost in the rounding of receiver + t
    // direction.
    const double radius = sphere.radius;
    const double sine_squared = static_cast<double>(local.x) * local.x + static_cast<double>(local.y) * local.y;
    const double along = cone.distance * std::sqrt(std::max(0.0, 1.0 - sine_squared));
    const double half_chord = std::sqrt(std::max(0.0, radius * radius - cone.distance * cone.distance * sine_squared));
    const double x = local.x * (along - half_chord) / radius;
    const double y = local.y * (along - half_chord) / radius;
    const double towards_receiver = std::sqrt(std::max(0.0, 1.0 - x * x - y * y));
    const Vector normal = frame.to_world(Vector(VectorD(x, y, -towards_receiver).normalized())).normalized();
    const Vector position(VectorD(sphere.centre) + VectorD(normal) * radius);
    return {.position = offset_from_surface(position, normal, normal),
            .direction = direction,
            .radiance = radiance,
            .density = cone.density,
            .is_delta = false};
}

}  // namespace

std::uint32_t choose_emitter(const Scene& scene, double u) {
    const auto found =
        std::upper_bound(scene.emitters.begin(), scene.emitters.end() - 1, u,
                         [](double value, const Emitter& emitter) { return value < emitter.choice_cdf; });
    return static_cast<std::uint32_t>(found - scene.emitters.begin());
}

EmissionSample sample_emission(const Scene& scene, std::uint32_t emitter_index, const Imath::V2f& u_position,
                               double u_triangle, const Imath::V2f& u_direction) {
    const Emitter& emitter = scene.emitters[emitter_index];
    // The densities of position and direction cancel against cosine and area.
    const Color& weight = emitter.photon_power;
    if (const auto* light = std::get_if<PointLight>(&emitter.kind))
        return {{light->position, sample_unit_sphere(u_direction)}, weight};

    const Shape& shape = scene.shapes[std::get<AreaLight>(emitter.kind).shape];
    const SurfacePoint point = sample_area(shape, u_position, u_triangle);
    const Vector direction = make_frame(point.normal).to_world(sample_cosine_hemisphere(u_direction));
    return {{offset_from_surface(point.position, point.normal, direction), direction}, weight};
}

std::optional<DirectSample> sample_direct(const Scene& scene, std::uint32_t emitter_index, const Vector& receiver,
                                          const Imath::V2f& u, double u_triangle) {
    const Emitter& emitter = scene.emitters[emitter_index];
    if (const auto* light = std::get_if<PointLight>(&emitter.kind)) {
        const VectorD to_light = VectorD(light->position) - VectorD(receiver);
        const double squared_distance = to_light.length2();
        if (!(squared_distance > 0.0)) return std::nullopt;
        return DirectSample{.position = light->position,
                            .direction = Vector(to_light / std::sqrt(squared_distance)),
                            .radiance = light->intensity / squared_distance,
                            .density = 1.0,
                            .is_delta = true};
    }

    const AreaLight& light = std::get<AreaLight>(emitter.kind);
    const Shape& shape = scene.shapes[light.shape];
    if (const auto* sphere = std::get_if<Sphere>(&shape.geometry))
        if (const auto cone = visible_cone(*sphere, receiver)) return sample_cone_of(*sphere, *cone, light.radiance, u);

    const SurfacePoint point = sample_area(shape, u, u_triangle);
    const VectorD to_light = VectorD(point.position) - VectorD(receiver);
    const double squared_distance = to_light.length2();
    if (!(squared_distance > 0.0)) return std::nullopt;
    const Vector direction(to_light / std::sqrt(squared_distance));
    const double cosine = -static_cast<double>(point.normal.dot(direction));
    if (!(cosine > 0.0)) return std::nullopt;
    return DirectSample{.position = offset_from_surface(point.position, point.normal, -direction),
                        .direction = direction,
                        .radiance = light.radiance,
                        .density = squared_distance / (cosine * shape.area),
                        .is_delta = false};
}

double direct_density(const Scene& scene, const Vector& receiver, const Vector& direction, const Hit& hit) {
    const Shape& shape = scene.shapes[hit.shape];
    const double cosine = -static_cast<double>(hit.geometric_normal.dot(direction));
    if (shape.emitter == no_emitter || !(cosine > 0.0)) return 0.0;
    if (const auto* sphere = std::get_if<Sphere>(&shape.geometry))
        if (const auto cone = visible_cone(*sphere, receiver)) return cone->density;
    return (VectorD(hit.position) - VectorD(receiver)).length2() / (cosine * shape.area);
}

ColorD emitted_radiance(const Scene& scene, const Hit& hit, const Vector& outgoing) {
    const std::uint32_t emitter = scene.shapes[hit.shape].emitter;
    if (emitter == no_emitter || !(hit.geometric_normal.dot(outgoing) > 0.0f)) return ColorD(0.0);
    return std::get<AreaLight>(scene.emitters[emitter].kind).radiance;
}

}  // namespace photonlab
