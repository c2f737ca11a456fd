#include "scene/narrow_gaps.h"

#include <Imath/ImathBox.h>

#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace photonlab {

namespace {

/// Boxes of primitives that all rays may meet, and about how many a ray meets on its way through the scene besides
/// those around the point that it comes from. Of scenes that would need more every n-th primitive is looked at.
constexpr double most_boxes = 6e7;
constexpr double boxes_of_a_ray = 30.0;
constexpr double rays_of_a_primitive = 8.0;

/// A point of a surface, on which primitive.
struct Probe {
    std::uint32_t shape;
    std::uint32_t primitive;
    Vector position;
    Vector normal;  // unit
};

/// From just within a gap's width on either side, back to the surface: that surface itself must be met, and not
/// earlier.
std::optional<NarrowGap> gap_at(const Scene& scene, const Probe& probe) {
    constexpr float height = 0.99f * narrowest_gap;  // gaps of exactly that width are safe
    for (const float side : {1.0f, -1.0f}) {
        const Vector away = probe.normal * side;
        const std::optional<Hit> hit =
            intersect_between(scene, {probe.position + away * height, -away}, 0.0f, 1.02f * height);
        if (!hit) continue;  // lost at an edge
        const bool is_itself = hit->shape == probe.shape && hit->primitive == probe.primitive;
        if (!is_itself || hit->distance < 0.9f * height) return NarrowGap{probe.shape, hit->shape, probe.position};
    }
    return std::nullopt;
}

std::array<VectorD, 3> corners(const TriangleMesh& mesh, std::size_t triangle) {
    const auto& vertices = mesh.triangles[triangle];
    return {VectorD(mesh.positions[vertices.x]), VectorD(mesh.positions[vertices.y]),
            VectorD(mesh.positions[vertices.z])};
}

template <typename Use>
void for_each_probe(const TriangleMesh& mesh, std::uint32_t shape, std::size_t i, const Use& use) {
    const auto [a, b, c] = corners(mesh, i);
    const double longest = std::max({(b - a).length(), (c - b).length(), (a - c).length()});
    const double width = longest > 0.0 ? (b - a).cross(c - a).length() / longest : 0.0;
    if (!(width > narrowest_gap)) return;
    const VectorD middle = (a + b + c) / 3.0;
    for (const VectorD& point : {middle, middle * 0.3 + a * 0.7, middle * 0.3 + b * 0.7, middle * 0.3 + c * 0.7})
        use({shape, static_cast<std::uint32_t>(i), Vector(point), mesh.geometric_normals[i]});
}

template <AnalyticKind Kind, typename Use>
void for_each_probe(const Kind& kind, std::uint32_t shape, std::size_t, const Use& use) {
    for (const SurfacePoint& point : kind.probes()) use({shape, 0, point.position, point.normal});
}

std::size_t primitive_count(const Shape& shape) {
    const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry);
    return mesh ? mesh->triangles.size() : 1;
}

/// Calls `use(shape's index, primitive)` for every n-th primitive of the scene.
template <typename Use>
void for_each_primitive(const Scene& scene, std::size_t stride, const Use& use) {
    std::size_t next = 0;  // counted from the shape's first
    for (std::uint32_t shape = 0; shape < scene.shapes.size(); ++shape) {
        const std::size_t count = primitive_count(scene.shapes[shape]);
        for (; next < count; next += stride) use(shape, next);
        next -= count;
    }
}

using Box = Imath::Box<Vector>;

Box box_of(const Shape& shape, std::size_t primitive) {
    return std::visit(
        [&]<typename Kind>(const Kind& kind) {
            Box box;
            if constexpr (AnalyticKind<Kind>) {
                const Extent extent = kind.extent();
                box = Box(extent.centre - extent.reach, extent.centre + extent.reach);
            } else {
                for (const VectorD& corner : corners(kind, primitive)) box.extendBy(Vector(corner));
            }
            return box;
        },
        shape.geometry);
}

/// How many primitives' boxes are around a point of a surface, in the mean: an estimate from some of both.
double crowding(const Scene& scene, std::size_t primitives) {
    constexpr std::size_t most_points = 64;
    constexpr std::size_t most_boxes_each = 100'000;
    std::vector<Vector> points;
    for_each_primitive(scene, 1 + primitives / most_points, [&](std::uint32_t shape, std::size_t primitive) {
        const auto add = [&](const Probe& probe) { points.push_back(probe.position); };
        std::visit([&](const auto& geometry) { for_each_probe(geometry, shape, primitive, add); },
                   scene.shapes[shape].geometry);
    });
    if (points.empty()) return 0.0;
    const std::size_t stride = 1 + primitives / most_boxes_each;
    std::size_t boxes = 0;
    for_each_primitive(scene, stride, [&](std::uint32_t shape, std::size_t primitive) {
        const Box box = box_of(scene.shapes[shape], primitive);
        for (const Vector& point : points) boxes += box.intersects(point);
    });
    return static_cast<double>(boxes * stride) / static_cast<double>(points.size());
}

}  // namespace

NarrowGaps find_narrow_gaps(const Scene& scene) {
    std::size_t primitives = 0;
    for (const Shape& shape : scene.shapes) primitives += primitive_count(shape);
    NarrowGaps result;
    if (primitives == 0) return result;
    const double boxes =
        rays_of_a_primitive * static_cast<double>(primitives) * (boxes_of_a_ray + crowding(scene, primitives));
    const auto stride = static_cast<std::size_t>(std::ceil(boxes / most_boxes));
    for_each_primitive(scene, stride, [&](std::uint32_t shape, std::size_t primitive) {
        const auto look = [&](const Probe& probe) {
            ++result.tried;
            const std::optional<NarrowGap> gap = gap_at(scene, probe);
            if (!gap) return;
            ++result.found;
            if (!result.first) result.first = gap;
        };
        std::visit([&](const auto& geometry) { for_each_probe(geometry, shape, primitive, look); },
                   scene.shapes[shape].geometry);
    });
    return result;
}

}  // namespace photonlab
