// A point drawn uniform in area has a density of directions of squared distance / (cosine * area).

#include "scene/shapes/shape.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"

namespace photonlab {

void require_round(const VectorD& centre, double radius, const std::string& place) {
    if (!is_finite(centre) || !std::isfinite(radius) || !(radius > 0.0))
        throw InputError(place, fmt::format("expected a finite centre and a radius above 0, got radius {}", radius));
}

double turn_to(double x, double y) {
    const double angle = std::atan2(y, x) / (2.0 * pi);
    return angle < 0.0 ? angle + 1.0 : angle;
}

void require_valid(const Geometry& geometry, const std::string& place) {
    std::visit([&](const auto& description) { description.check(place); }, geometry);
}

Bounds bounds_of(const Geometry& geometry) {
    return std::visit([](const auto& description) { return description.bounds(); }, geometry);
}

Shape place_shape(const Geometry& geometry, const ToUnitBox& to_unit_box, const ShapeUse& use) {
    Shape shape;
    shape.geometry = std::visit(
        [&](const auto& description) -> PlacedGeometry { return description.placed(to_unit_box, use); }, geometry);
    shape.area = std::visit([](const auto& kind) { return kind.area(); }, shape.geometry);
    return shape;
}

const char* shape_kind(const Shape& shape) {
    return std::visit([]<typename Kind>(const Kind&) { return Kind::name; }, shape.geometry);
}

std::vector<std::string_view> analytic_shape_kinds() {
    return []<typename... Kinds>(const std::variant<Kinds...>*) {
        return std::vector<std::string_view>{Kinds::name...};
    }(static_cast<const Analytic*>(nullptr));
}

SurfaceTangents tangents_at(const Shape& shape, const Hit& hit) {
    return std::visit([&](const auto& geometry) { return geometry.tangents(hit); }, shape.geometry);
}

namespace {

/// Kinds that can be sampled as seen from a point, and not by their area alone.
template <typename Kind>
concept SampledAsSeen = requires(const Kind& shape, const Vector& receiver, const Imath::V2f& u) {
    { shape.sample_seen(receiver, u) } -> std::same_as<std::optional<SeenPoint>>;
    { shape.seen_density(receiver) } -> std::same_as<std::optional<double>>;
};

std::optional<SeenPoint> sample_as_seen(const Shape& shape, const Vector& receiver, const Imath::V2f& u) {
    return std::visit(
        [&]<typename Kind>(const Kind& kind) -> std::optional<SeenPoint> {
            if constexpr (SampledAsSeen<Kind>)
                return kind.sample_seen(receiver, u);
            else
                return std::nullopt;
        },
        shape.geometry);
}

std::optional<double> density_as_seen(const Shape& shape, const Vector& receiver) {
    return std::visit(
        [&]<typename Kind>(const Kind& kind) -> std::optional<double> {
            if constexpr (SampledAsSeen<Kind>)
                return kind.seen_density(receiver);
            else
                return std::nullopt;
        },
        shape.geometry);
}

}  // namespace

std::optional<SeenPoint> sample_seen(const Shape& shape, const Vector& receiver, const Imath::V2f& u,
                                     double u_triangle) {
    if (const auto seen = sample_as_seen(shape, receiver, u)) return seen;
    const SurfacePoint point = sample_area(shape, u, u_triangle);
    const VectorD to_point = VectorD(point.position) - VectorD(receiver);
    const double squared_distance = to_point.length2();
    if (!(squared_distance > 0.0)) return std::nullopt;
    const Vector direction(to_point / std::sqrt(squared_distance));
    const double cosine = -static_cast<double>(point.normal.dot(direction));
    if (!(cosine > 0.0)) return std::nullopt;
    return SeenPoint{.position = offset_from_surface(point.position, point.normal, -direction),
                     .direction = direction,
                     .density = squared_distance / (cosine * shape.area)};
}

Imath::V2f texture_coordinate_of_drawn(const Shape& shape, const Vector& position, const Imath::V2f& u,
                                       double u_triangle) {
    return std::visit(
        [&]<typename Kind>(const Kind& kind) {
            if constexpr (std::is_same_v<Kind, TriangleMesh>)
                return kind.texture_coordinate_on(kind.triangle_at(u_triangle), u);
            else
                return kind.texture_coordinate_at(position);
        },
        shape.geometry);
}

double seen_density(const Shape& shape, const Vector& receiver, const Vector& direction, const Hit& hit) {
    const double cosine = -static_cast<double>(hit.geometric_normal.dot(direction));
    if (!(cosine > 0.0)) return 0.0;
    if (const auto density = density_as_seen(shape, receiver)) return *density;
    return (VectorD(hit.position) - VectorD(receiver)).length2() / (cosine * shape.area);
}

}  // namespace photonlab
