#include "scene/narrow_gaps.h"

#include <utility>

namespace photonlab {

namespace {

constexpr std::size_t most_triangles = 200'000;  // of all shapes; of larger scenes every n-th is looked at

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
        const std::optional<Hit> hit = intersect(scene, {probe.position + away * height, -away});
        if (!hit || hit->distance > 1.02f * height) continue;  // lost at an edge
        const bool is_itself = hit->shape == probe.shape && hit->primitive == probe.primitive;
        if (!is_itself || hit->distance < 0.9f * height) return NarrowGap{probe.shape, hit->shape, probe.position};
    }
    return std::nullopt;
}

template <typename Use>
void for_each_probe(const TriangleMesh& mesh, std::uint32_t shape, std::size_t stride, const Use& use) {
    for (std::size_t i = 0; i < mesh.triangles.size(); i += stride) {
        const VectorD a(mesh.positions[mesh.triangles[i].x]);
        const VectorD b(mesh.positions[mesh.triangles[i].y]);
        const VectorD c(mesh.positions[mesh.triangles[i].z]);
        const double longest = std::max({(b - a).length(), (c - b).length(), (a - c).length()});
        const double width = longest > 0.0 ? (b - a).cross(c - a).length() / longest : 0.0;
        if (!(width > narrowest_gap)) continue;
        const VectorD middle = (a + b + c) / 3.0;
        for (const VectorD& point : {middle, middle * 0.3 + a * 0.7, middle * 0.3 + b * 0.7, middle * 0.3 + c * 0.7})
            use({shape, static_cast<std::uint32_t>(i), Vector(point), mesh.geometric_normals[i]});
    }
}

template <typename Use>
void for_each_probe(const Sphere& sphere, std::uint32_t shape, std::size_t, const Use& use) {
    // Not along the axes, where spheres rest on floors: a single point of contact does no harm.
    for (const float x : {-1.0f, 1.0f})
        for (const float y : {-1.0f, 1.0f})
            for (const float z : {-1.0f, 1.0f}) {
                const Vector outward = Vector(x, 0.9f * y, 0.8f * z).normalized();
                use({shape, 0, sphere.centre + outward * sphere.radius, outward});
            }
}

template <typename Use>
void for_each_probe(const Disk& disk, std::uint32_t shape, std::size_t, const Use& use) {
    // Not the centre, where balls rest.
    for (const auto& [x, y] : {std::pair(0.1f, 0.2f), std::pair(0.7f, 0.1f), std::pair(-0.7f, 0.2f),
                               std::pair(0.2f, 0.7f), std::pair(-0.1f, -0.7f)}) {
        const Vector offset = disk.frame.tangent * (x * disk.radius) + disk.frame.bitangent * (y * disk.radius);
        use({shape, 0, disk.centre + offset, disk.frame.normal});
    }
}

}  // namespace

NarrowGaps find_narrow_gaps(const Scene& scene) {
    std::size_t triangles = 0;
    for (const Shape& shape : scene.shapes)
        if (const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry)) triangles += mesh->triangles.size();
    const std::size_t stride = 1 + triangles / most_triangles;

    NarrowGaps result;
    for (std::uint32_t i = 0; i < scene.shapes.size(); ++i)
        std::visit(
            [&](const auto& geometry) {
                for_each_probe(geometry, i, stride, [&](const Probe& probe) {
                    ++result.tried;
                    const std::optional<NarrowGap> gap = gap_at(scene, probe);
                    if (!gap) return;
                    ++result.found;
                    if (!result.first) result.first = gap;
                });
            },
            scene.shapes[i].geometry);
    return result;
}

}  // namespace photonlab
