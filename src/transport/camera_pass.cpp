#include "transport/camera_pass.h"

#include <fmt/format.h>

#include <cmath>

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "scene/emitter.h"
#include "transport/path_length.h"

namespace photonlab {

namespace {

constexpr int tile_size = 16;  // pixels; hit points of a tile stay together in the list

constexpr std::size_t tiles_per_round = 16;  // traced, then joined: their memory is reused

struct Tile {
    HitPointList points;
    std::vector<float> footprints;
    std::vector<SeenEmission> emission;
    double weight_cut = 0.0;
    std::uint64_t nonfinite = 0;
};

/// Empties the tile but keeps its memory.
void move_to_end(HitPoints& result, Tile& tile) {
    result.points.append(tile.points);
    result.footprints.insert(result.footprints.end(), tile.footprints.begin(), tile.footprints.end());
    result.emission.insert(result.emission.end(), tile.emission.begin(), tile.emission.end());
    tile.points.clear();
    tile.footprints.clear();
    tile.emission.clear();
    result.weight_cut += std::exchange(tile.weight_cut, 0.0);
    result.nonfinite += std::exchange(tile.nonfinite, 0);
}

/// Bits 0, 2, 4 and 6 of a Morton number, side by side: its column in a tile; of half of it: its row.
int every_second_bit(int morton) {
    return (morton & 1) | (morton >> 1 & 2) | (morton >> 2 & 4) | (morton >> 3 & 8);
}

/// Square root of a perfect square; InputError for anything else.
int grid_size(int samples_per_pixel) {
    const int size = static_cast<int>(std::lround(std::sqrt(std::max(0, samples_per_pixel))));
    if (samples_per_pixel < 1 || size * size != samples_per_pixel)
        throw InputError("samples_per_pixel: expected a perfect square (1, 4, 9, 16, ...), got " +
                         std::to_string(samples_per_pixel));
    return size;
}

/// What a camera path carries on its way.
struct Branch {
    Ray ray;
    Color throughput;  ///< without the sample's share of the pixel
    float distance;    ///< unfolded, from the camera
    std::uint32_t edges;
};

/// Follows the sample positions of a tile into the scene.
class TileTracer {
public:
    TileTracer(const Scene& scene, const Camera& camera, int samples_per_pixel, double branch_cutoff)
        : scene_(scene),
          camera_(camera),
          grid_(grid_size(samples_per_pixel)),
          share_(1.0f / static_cast<float>(samples_per_pixel)),
          smallest_weight_(static_cast<float>(branch_cutoff)),
          tiles_across_((camera.width + tile_size - 1) / tile_size),
          tiles_down_((camera.height + tile_size - 1) / tile_size) {}

    std::size_t tiles() const {
        return static_cast<std::size_t>(tiles_across_) * static_cast<std::size_t>(tiles_down_);
    }
    HitPointList empty_list() const { return HitPointList(share_, HitPointList::kept_for(scene_)); }

    void trace_tile(std::size_t index, Tile& tile) const {
        const int left = static_cast<int>(index) % tiles_across_ * tile_size;
        const int top = static_cast<int>(index) / tiles_across_ * tile_size;
        for (int place = 0; place < tile_size * tile_size; ++place) {
            const int x = left + every_second_bit(place);
            const int y = top + every_second_bit(place >> 1);
            if (x >= camera_.width || y >= camera_.height) continue;
            const auto pixel = static_cast<std::uint32_t>(y) * static_cast<std::uint32_t>(camera_.width) +
                               static_cast<std::uint32_t>(x);
            for (int row = 0; row < grid_; ++row)
                for (int column = 0; column < grid_; ++column)
                    trace_sample(pixel, x + (column + 0.5) / grid_, y + (row + 0.5) / grid_, tile);
        }
    }

private:
    /// `x` and `y` in pixels, from the upper left corner of the image.
    void trace_sample(std::uint32_t pixel, double x, double y, Tile& tile) const {
        std::vector<Branch> pending{{{camera_.position, camera_.direction(x, y)}, Color(1.0f), 0.0f, 1}};
        while (!pending.empty()) {
            const Branch branch = pending.back();
            pending.pop_back();
            trace_branch(branch, pixel, pending, tile);
        }
    }

    /// To the next surface: leaves a hit point there, or adds what goes on from it to `pending`.
    void trace_branch(const Branch& branch, std::uint32_t pixel, std::vector<Branch>& pending, Tile& tile) const {
        const std::optional<Hit> hit = intersect(scene_, branch.ray);
        if (!hit) return;
        const Vector outgoing = -branch.ray.direction;
        const ColorD emitted = emitted_radiance(scene_, *hit, outgoing);
        if (!is_black(emitted))
            tile.emission.push_back({pixel, branch.edges, emitted * ColorD(branch.throughput * share_)});
        const std::optional<Surface> surface = orient(scene_, *hit, outgoing);
        if (!surface) return;
        const float distance = branch.distance + hit->distance;
        const float footprint = distance * static_cast<float>(camera_.pixel_angle);
        if (!is_finite(surface->position) || !std::isfinite(footprint) || !is_finite(branch.throughput)) {
            ++tile.nonfinite;
            return;
        }
        if (is_specular(surface->bsdf)) branch_on(branch, *surface, distance, pending, tile);
        if (!is_scattering(surface->bsdf)) return;
        tile.points.push_back({.position = surface->position,
                               .normal = surface->frame.normal,
                               .geometric_normal = surface->geometric_normal,
                               .outgoing = outgoing,
                               .weight = branch.throughput * share_,
                               .pixel = pixel,
                               .material = static_cast<std::uint16_t>(surface->material),
                               .camera_edges = static_cast<std::uint16_t>(branch.edges),
                               .texture_coordinate = surface->texture_coordinate},
                              uniform_value(surface->bsdf).has_value());
        tile.footprints.push_back(footprint);
    }

    /// Adds what a mirror or glass makes of the branch to `pending`, but for what carries too little. `distance` is
    /// that of the surface.
    void branch_on(const Branch& branch, const Surface& surface, float distance, std::vector<Branch>& pending,
                   Tile& tile) const {
        const Vector outgoing = surface.frame.to_local(-branch.ray.direction);
        const SpecularBranches onward = specular_branches(surface.bsdf, outgoing, Carried::Radiance);
        for (const SpecularBranch& way : onward) {
            const Vector direction = surface.frame.to_world(way.incoming);
            if (!sides_agree(surface, direction)) continue;  // absorbed, as for every path here
            const Color throughput = branch.throughput * way.weight;
            if (max_channel(throughput) < smallest_weight_ || branch.edges == largest_path_edges) {
                tile.weight_cut += mean_channel(ColorD(throughput)) * static_cast<double>(share_);
                continue;
            }
            const Vector origin = offset_from_surface(surface.position, surface.geometric_normal, direction);
            pending.push_back({{origin, direction}, throughput, distance, branch.edges + 1});
        }
    }

    const Scene& scene_;
    const Camera& camera_;
    const int grid_;     // columns, and rows, of samples in a pixel
    const float share_;  // of a sample in its pixel
    const float smallest_weight_;
    const int tiles_across_;
    const int tiles_down_;
};

}  // namespace

HitPoints trace_hit_points(const Scene& scene, int samples_per_pixel, int threads, double branch_cutoff) {
    return trace_hit_points(scene, scene.camera, samples_per_pixel, threads, branch_cutoff);
}

HitPoints trace_hit_points(const Scene& scene, const Camera& camera, int samples_per_pixel, int threads,
                           double branch_cutoff) {
    constexpr std::size_t material_limit = std::size_t{1} << 16;  // HitPoint::material
    if (scene.materials.size() > material_limit)
        throw InputError("expected at most " + std::to_string(material_limit) + " materials in a scene, got " +
                         std::to_string(scene.materials.size()));
    const TileTracer tracer(scene, camera, samples_per_pixel, branch_cutoff);

    HitPoints result;
    result.width = camera.width;
    result.height = camera.height;
    result.samples_per_pixel = samples_per_pixel;
    result.points = tracer.empty_list();
    // Untouched memory costs nothing, and growing costs a copy.
    const std::size_t samples = pixel_count(result) * static_cast<std::size_t>(samples_per_pixel);
    result.points.reserve(samples);
    result.footprints.reserve(samples);

    std::vector<Tile> round(std::min(tracer.tiles(), tiles_per_round));
    for (Tile& tile : round) tile.points = tracer.empty_list();
    for (std::size_t first = 0; first < tracer.tiles(); first += round.size()) {
        const std::size_t in_round = std::min(round.size(), tracer.tiles() - first);
        parallel_for(in_round, threads, [&](std::size_t slot) { tracer.trace_tile(first + slot, round[slot]); });
        for (std::size_t slot = 0; slot < in_round; ++slot) move_to_end(result, round[slot]);
    }
    result.weight_cut /= static_cast<double>(pixel_count(result));
    return result;
}

std::vector<ColorD> emission_image(const HitPoints& hit_points, int max_depth) {
    std::vector<ColorD> image(pixel_count(hit_points), ColorD(0.0));
    for (const SeenEmission& seen : hit_points.emission)
        if (depth_allows(max_depth, seen.edges)) image[seen.pixel] += seen.radiance;
    return image;
}

void require_perfect_square(std::int64_t samples_per_pixel) {
    const auto side = std::llround(std::sqrt(static_cast<double>(samples_per_pixel)));
    if (samples_per_pixel < 1 || side > 1024 || side * side != samples_per_pixel)
        throw InputError(
            fmt::format("samples_per_pixel: expected a perfect square from 1 to 1048576, got {}", samples_per_pixel));
}

}  // namespace photonlab
