#include "scene/shapes/meshes/creases.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "core/error.h"
#include "core/machine/available_memory.h"

namespace photonlab {

namespace {

/// Corners are numbered: 3 * triangle + corner. Numbers are floats, as in Mitsuba, where faces at just the largest
/// angle go with each other or not by how the last bit was rounded: at 90 degrees they do.
class CreaseFinder {
public:
    CreaseFinder(const MeshDescription& mesh, const std::vector<std::uint32_t>& groups, double largest_angle)
        : mesh_(mesh),
          groups_(groups),
          least_cosine_(std::cos(static_cast<float>(largest_angle) * static_cast<float>(pi / 180.0))) {
        face_normals_.reserve(mesh.triangles.size());
        for (const auto& triangle : mesh.triangles) {
            const Vector a(mesh.positions[triangle.x]);
            const Vector normal =
                (Vector(mesh.positions[triangle.y]) - a).cross(Vector(mesh.positions[triangle.z]) - a);
            face_normals_.push_back(normal.normalized());  // 0 of a triangle without area
        }
    }

    /// All corners, those of one point next to each other and in their order.
    std::vector<std::size_t> corners_by_point() const {
        std::vector<std::size_t> corners(3 * mesh_.triangles.size());
        std::iota(corners.begin(), corners.end(), std::size_t{0});
        std::stable_sort(corners.begin(), corners.end(),
                         [&](std::size_t a, std::size_t b) { return key_of(a) < key_of(b); });
        return corners;
    }

    bool are_of_one_point(std::size_t corner, std::size_t other) const { return key_of(corner) == key_of(other); }

    bool are_smooth(std::size_t corner, std::size_t other) const {
        const Vector& a = face_normals_[corner / 3];
        const Vector& b = face_normals_[other / 3];
        return a == b || a.dot(b) > least_cosine_;
    }

    std::uint32_t vertex_of(std::size_t corner) const {
        return mesh_.triangles[corner / 3][static_cast<int>(corner % 3)];
    }

private:
    std::tuple<float, float, float, float, float, std::uint32_t> key_of(std::size_t corner) const {
        const std::uint32_t vertex = vertex_of(corner);
        const Vector position(mesh_.positions[vertex]);
        Imath::V2f uv(0.0f);
        if (!mesh_.texture_coordinates.empty()) uv = Imath::V2f(mesh_.texture_coordinates[vertex]);
        if (std::isnan(uv.x) || std::isnan(uv.y)) uv = Imath::V2f(0.0f);  // none
        return {position.x, position.y, position.z, uv.x, uv.y, groups_.empty() ? 0 : groups_[corner / 3]};
    }

    const MeshDescription& mesh_;
    const std::vector<std::uint32_t>& groups_;
    const float least_cosine_;
    std::vector<Vector> face_normals_;
};

constexpr std::uint64_t most_comparisons = 1'000'000'000;  // in all; five seconds

}  // namespace

void split_at_creases(MeshDescription& mesh, double largest_angle, const std::vector<std::uint32_t>& groups,
                      const std::string& place) {
    require_memory_for(place, mesh.triangles.size() * (sizeof(Vector) + 3 * (2 * sizeof(std::size_t) + sizeof(VectorD) +
                                                                             sizeof(Imath::V2d))));
    const CreaseFinder finder(mesh, groups, largest_angle);
    const std::vector<std::size_t> corners = finder.corners_by_point();
    MeshDescription split;
    split.triangles = mesh.triangles;
    std::vector<bool> is_done(corners.size(), false);
    std::uint64_t comparisons = 0;
    for (std::size_t first = 0; first < corners.size(); ++first) {
        if (is_done[first]) continue;
        const auto vertex = static_cast<std::uint32_t>(split.positions.size());
        const std::uint32_t old_vertex = finder.vertex_of(corners[first]);
        split.positions.push_back(VectorD(mesh.positions[old_vertex]));
        if (!mesh.texture_coordinates.empty())
            split.texture_coordinates.push_back(Imath::V2d(mesh.texture_coordinates[old_vertex]));
        for (std::size_t i = first; i < corners.size() && finder.are_of_one_point(corners[first], corners[i]); ++i) {
            if (++comparisons > most_comparisons)
                throw InputError(place, "max_smooth_angle: too many faces meet in one point");
            if (is_done[i] || (i != first && !finder.are_smooth(corners[first], corners[i]))) continue;
            is_done[i] = true;
            split.triangles[corners[i] / 3][static_cast<int>(corners[i] % 3)] = vertex;
        }
    }
    mesh = std::move(split);
}

}  // namespace photonlab
