// What every shape speaks in, and what it answers. A description is in scene units and double precision, as a scene
// file has it; what a ray meets is in the unit box (ToUnitBox).

#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/math.h"

namespace photonlab {

struct ShapeReader;

struct Ray {
    Vector origin;
    Vector direction;  ///< unit
};

/// Where a ray meets a surface.
struct Hit {
    Vector position;
    Vector geometric_normal;  ///< unit, to the shape's outside, whichever side was hit
    Vector shading_normal;    ///< unit, interpolated; on the same side as the geometric normal
    Imath::V2f texture_coordinate = Imath::V2f(0.0f);
    float distance;
    std::uint32_t shape;
    std::uint32_t primitive;  ///< triangle of a mesh, else 0
};

/// A point of a shape's surface.
struct SurfacePoint {
    Vector position;
    Vector normal;  ///< geometric, unit, to the emitting side
};

/// A point of a shape as seen from elsewhere.
struct SeenPoint {
    Vector position;   ///< moved off the surface, towards who sees it
    Vector direction;  ///< unit, to `position`
    double density;    ///< with which it was drawn, per steradian there
};

/// Axis-aligned bounds, scene units.
struct Bounds {
    VectorD lower = VectorD(std::numeric_limits<double>::infinity());
    VectorD upper = VectorD(-std::numeric_limits<double>::infinity());

    void include(const VectorD& point) {
        for (int axis = 0; axis < 3; ++axis) {
            lower[axis] = std::min(lower[axis], point[axis]);
            upper[axis] = std::max(upper[axis], point[axis]);
        }
    }
    bool is_empty() const { return lower.x > upper.x; }
};

/// The same, unit box: its middle and half its widths.
struct Extent {
    Vector centre;
    Vector reach;
};

/// From scene units to the unit box, in double.
struct ToUnitBox {
    VectorD centre;
    double unit_length;  ///< scene units in one unit of the box

    VectorD exact(const VectorD& point) const { return (point - centre) / unit_length; }
    Vector operator()(const VectorD& point) const { return Vector(exact(point)); }
    float length(double scene_units) const { return static_cast<float>(scene_units / unit_length); }
};

/// Axes about which a round shape's texture coordinates run: unit length, at right angles; left-handed where mirrored.
using TextureAxes = std::array<VectorD, 3>;
inline const TextureAxes scene_axes{VectorD(1, 0, 0), VectorD(0, 1, 0), VectorD(0, 0, 1)};

/// How a shape is used, which decides what is kept of it.
struct ShapeUse {
    bool emits = false;
    bool has_texture = false;  ///< in its material, or in its light
};

/// Distances, in units of the direction's length, at which a line meets a surface; nearest first.
struct Roots {
    int count = 0;
    double t[2] = {0.0, 0.0};
};

/// How the position on a surface changes with its texture coordinates: unit box, not of unit length.
struct SurfaceTangents {
    VectorD by_u;
    VectorD by_v;
};

/// A kind of shape that is met as it is, and not as triangles. read() gives the description of a <shape>, in the world;
/// check(place) throws InputError for what cannot be rendered, and placed() takes it to the unit box. complete() fills
/// a hit of the ray from its distance, and tangents() are there; probes() are points all over it, away from where
/// others may rest on it. texture_coordinate_at() is that of a point on it, or off it along its normal. What every ray
/// and every photon asks, roots(), complete() and sample_area(), is inline: calls cost more than they do.
///
/// A kind that knows where it is whole has distance_to(position), and whole_within(position, distance): the normal at a
/// point on it around which its area within any distance up to that one is a flat disc's, all of it seen from there,
/// its normals within 60 degrees; empty elsewhere.
///
/// A kind that can be sampled as seen from a point has sample_seen() and seen_density() as well, which are empty where
/// the area must do.
template <typename Kind>
concept AnalyticKind = requires(const Kind& shape, const typename Kind::Description& description, ShapeReader& reader,
                                const std::string& place, const ToUnitBox& to_unit_box, const ShapeUse& use,
                                const Imath::V2f& u, const VectorD& v, Hit& hit, const Ray& ray) {
    { Kind::name } -> std::convertible_to<const char*>;
    { Kind::read(reader) } -> std::same_as<typename Kind::Description>;
    { description.check(place) } -> std::same_as<void>;
    { description.bounds() } -> std::same_as<Bounds>;
    { description.placed(to_unit_box, use) } -> std::same_as<Kind>;
    { shape.area() } -> std::same_as<double>;
    { shape.sample_area(u, 0.5) } -> std::same_as<SurfacePoint>;
    { shape.roots(v, v) } -> std::same_as<Roots>;
    { shape.extent() } -> std::same_as<Extent>;
    { shape.complete(hit, ray, 0.0f, 0.0f) } -> std::same_as<void>;
    { shape.tangents(hit) } -> std::same_as<SurfaceTangents>;
    { shape.texture_coordinate_at(ray.origin) } -> std::same_as<Imath::V2f>;
    { shape.probes() } -> std::same_as<std::vector<SurfacePoint>>;
};

template <AnalyticKind... Kinds>
using AnalyticOf = std::variant<Kinds...>;

/// Throws InputError unless the centre is finite and the radius above 0.
void require_round(const VectorD& centre, double radius, const std::string& place);

/// The angle from (1, 0) to (x, y), as a share of the circle, in [0, 1].
double turn_to(double x, double y);

}  // namespace photonlab
