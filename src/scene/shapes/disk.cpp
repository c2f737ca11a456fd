#include "scene/shapes/disk.h"

#include <cmath>

#include "core/error.h"
#include "scene/mitsuba/transform.h"
#include "scene/shapes/shape_reader.h"

namespace photonlab {

void DiskDescription::check(const std::string& place) const {
    require_round(centre, radius, place);
    if (!is_finite(normal) || normal.length2() == 0.0)
        throw InputError(place, "expected a disk's normal of unit length");
}

Bounds DiskDescription::bounds() const {
    VectorD reach;
    for (int axis = 0; axis < 3; ++axis)
        reach[axis] = radius * std::sqrt(std::max(0.0, 1.0 - normal[axis] * normal[axis]));
    return {centre - reach, centre + reach};
}

DiskDescription Disk::read(ShapeReader& reader) {
    return {.centre = transform_point(reader.to_world, VectorD(0.0)),
            .normal = transform_normal(reader.to_world, {0.0, 0.0, reader.flip_normals ? -1.0 : 1.0}),
            .radius = uniform_scale(reader.to_world, 2, reader.element.place),
            .texture_axes = reader.texture_axes()};
}

Disk DiskDescription::placed(const ToUnitBox& to_unit_box, const ShapeUse& use) const {
    return {.frame = make_frame(Vector(normal)),
            .centre = to_unit_box(centre),
            .radius = to_unit_box.length(radius),
            .texture_axes = use.has_texture ? std::optional(texture_axes) : std::nullopt};
}

Extent Disk::extent() const {
    Vector reach;
    for (int axis = 0; axis < 3; ++axis) {
        const float n = frame.normal[axis];
        reach[axis] = radius * std::sqrt(std::max(0.0f, 1.0f - n * n));
    }
    return {centre, reach};
}

SurfaceTangents Disk::tangents(const Hit& hit) const {
    const TextureAxes& axes = texture_axes.value_or(scene_axes);
    const VectorD from_centre = VectorD(hit.position) - VectorD(centre);
    const double x = from_centre.dot(axes[0]);
    const double y = from_centre.dot(axes[1]);
    const double distance = std::hypot(x, y);
    const VectorD outward = distance > 0.0 ? axes[0] * (x / distance) + axes[1] * (y / distance) : axes[0];
    return {outward * static_cast<double>(radius), (axes[1] * x - axes[0] * y) * (2.0 * pi)};
}

Imath::V2f Disk::texture_coordinate_at(const Vector& position) const {
    return texture_coordinate_of(VectorD(position) - VectorD(centre), texture_axes.value_or(scene_axes));
}

std::vector<SurfacePoint> Disk::probes() const {
    std::vector<SurfacePoint> points;
    // Not the centre, where balls rest.
    for (const auto& [x, y] : {std::pair(0.1f, 0.2f), std::pair(0.7f, 0.1f), std::pair(-0.7f, 0.2f),
                               std::pair(0.2f, 0.7f), std::pair(-0.1f, -0.7f)})
        points.push_back({centre + (frame.tangent * (x * radius) + frame.bitangent * (y * radius)), frame.normal});
    return points;
}

double Disk::distance_to(const Vector& position) const {
    const VectorD offset = VectorD(position) - VectorD(centre);
    const double height = offset.dot(VectorD(frame.normal));
    const double beyond_rim = std::max(0.0, std::sqrt(std::max(0.0, offset.length2() - height * height)) - radius);
    return std::hypot(height, beyond_rim);
}

std::optional<Vector> Disk::whole_within(const Vector& position, double distance) const {
    const VectorD offset = VectorD(position) - VectorD(centre);
    if (std::abs(offset.dot(VectorD(frame.normal))) > 1e-6 || offset.length() + distance > radius) return std::nullopt;
    return frame.normal;
}

}  // namespace photonlab
