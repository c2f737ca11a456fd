// Shapes as the scene has them: triangles, or one of the kinds that are met as they are, which src/scene/CMakeLists.txt
// lists. To add one of those: a file with a struct that answers what AnalyticKind in surface.h asks, its name in the
// list, and a test. What is read as triangles: shape_reader.h.

#pragma once

#include <string_view>
#include <utility>

#include "scene/shapes/analytic_list.h"
#include "scene/shapes/mesh.h"

namespace photonlab {

template <typename... Kinds>
std::variant<MeshDescription, typename Kinds::Description...> described(const std::variant<Kinds...>&);
template <typename... Kinds>
std::variant<TriangleMesh, Kinds...> placed(const std::variant<Kinds...>&);

/// A shape in scene units, as it is described, and in the unit box.
using Geometry = decltype(described(std::declval<Analytic>()));
using PlacedGeometry = decltype(placed(std::declval<Analytic>()));

inline constexpr std::uint32_t no_emitter = ~0u;

struct Shape {
    PlacedGeometry geometry;
    std::uint32_t material;
    std::uint32_t emitter = no_emitter;  ///< index into Scene::emitters
    double area;                         ///< surface area
};

/// Throws InputError for what cannot be rendered.
void require_valid(const Geometry& geometry, const std::string& place);

Bounds bounds_of(const Geometry& geometry);

/// To the unit box, as a shape without a material.
Shape place_shape(const Geometry& geometry, const ToUnitBox& to_unit_box, const ShapeUse& use);

/// What it is: "mesh", "sphere", ...
const char* shape_kind(const Shape& shape);

/// The kinds that are met as they are, in the list's order.
std::vector<std::string_view> analytic_shape_kinds();

/// Fills a hit of the ray on it, of which distance and primitive are known; u and v are those of a triangle.
inline void complete(Hit& hit, const Shape& shape, const Ray& ray, float u, float v) {
    std::visit([&](const auto& geometry) { geometry.complete(hit, ray, u, v); }, shape.geometry);
}

/// At a hit that is complete.
SurfaceTangents tangents_at(const Shape& shape, const Hit& hit);

/// A point uniform in area.
inline SurfacePoint sample_area(const Shape& shape, const Imath::V2f& u, double u_triangle) {
    return std::visit([&](const auto& kind) { return kind.sample_area(u, u_triangle); }, shape.geometry);
}

/// A point as seen from `receiver`; empty when the point drawn does not face it.
std::optional<SeenPoint> sample_seen(const Shape& shape, const Vector& receiver, const Imath::V2f& u,
                                     double u_triangle);

/// Texture coordinate of the point at `position` that sample_area() or sample_seen() draws with the same numbers.
Imath::V2f texture_coordinate_of_drawn(const Shape& shape, const Vector& position, const Imath::V2f& u,
                                       double u_triangle);

/// Density per steradian with which sample_seen() draws, from `receiver`, the point of the shape at `hit` that was
/// found in `direction` (unit).
double seen_density(const Shape& shape, const Vector& receiver, const Vector& direction, const Hit& hit);

}  // namespace photonlab
