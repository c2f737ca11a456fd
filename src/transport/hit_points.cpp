#include "transport/hit_points.h"

#include "core/error.h"
#include "core/parallel.h"
#include "scene/emitter.h"

namespace photonlab {

namespace {

constexpr int tile_size = 16;  // pixels; hit points of a tile stay together in the list

struct Tile {
    std::vector<HitPoint> points;
    std::vector<float> footprints;
    std::vector<SeenEmission> emission;
    double weight_cut = 0.0;
    std::uint64_t nonfinite = 0;
};

constexpr std::uint32_t edge_cap = 10'000;  // as for photons: ends what mirrors hold captive

/// A camera path on its way.
struct Branch {
    Ray ray;
    Color throughput;  ///< without the sample's share of the pixel
    float distance;    ///< unfolded, from the camera
    std::uint32_t edges;
};

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

}  // namespace

HitPoints trace_hit_points(const Scene& scene, int samples_per_pixel, int threads, double branch_cutoff) {
    constexpr std::size_t material_limit = std::size_t{1} << 16;  // HitPoint::material
    if (scene.materials.size() > material_limit)
        throw InputError("expected at most " + std::to_string(material_limit) + " materials in a scene, got " +
                         std::to_string(scene.materials.size()));
    const Camera& camera = scene.camera;
    const int grid = grid_size(samples_per_pixel);
    const float smallest_weight = static_cast<float>(branch_cutoff);
    const float share = 1.0f / static_cast<float>(samples_per_pixel);
    const int tiles_across = (camera.width + tile_size - 1) / tile_size;
    const int tiles_down = (camera.height + tile_size - 1) / tile_size;

    HitPoints result;
    result.width = camera.width;
    result.height = camera.height;
    result.samples_per_pixel = samples_per_pixel;

    const auto trace_branch = [&](const Branch& branch, std::uint32_t pixel, std::vector<Branch>& next, Tile& tile) {
        const std::optional<Hit> hit = intersect(scene, branch.ray);
        if (!hit) return;
        const Vector outgoing = -branch.ray.direction;
        const ColorD emitted = emitted_radiance(scene, *hit, outgoing);
        if (!is_black(emitted))
            tile.emission.push_back({pixel, branch.edges, emitted * ColorD(branch.throughput * share)});
        const std::optional<Surface> surface = orient(scene, *hit, outgoing);
        if (!surface) return;
        const float distance = branch.distance + hit->distance;
        const float footprint = distance * static_cast<float>(camera.pixel_angle);
        if (!is_finite(surface->position) || !std::isfinite(footprint) || !is_finite(branch.throughput)) {
            ++tile.nonfinite;
            return;
        }
        if (!is_specular(surface->bsdf)) {
            tile.points.push_back({.position = surface->position,
                                   .normal = surface->frame.normal,
                                   .geometric_normal = surface->geometric_normal,
                                   .outgoing = outgoing,
                                   .weight = branch.throughput * share,
                                   .pixel = pixel,
                                   .material = static_cast<std::uint16_t>(surface->material),
                                   .camera_edges = static_cast<std::uint16_t>(branch.edges),
                                   .texture_coordinate = surface->texture_coordinate});
            tile.footprints.push_back(footprint);
            return;
        }
        const SpecularBranches onward =
            specular_branches(surface->bsdf, surface->frame.to_local(outgoing), Carried::Radiance);
        for (const SpecularBranch& way : onward) {
            const Vector direction = surface->frame.to_world(way.incoming);
            if (!sides_agree(*surface, direction)) continue;  // absorbed, as for every path here
            const Color throughput = branch.throughput * way.weight;
            if (max_channel(throughput) < smallest_weight || branch.edges == edge_cap)
                tile.weight_cut += mean_channel(ColorD(throughput)) * static_cast<double>(share);
            else
                next.push_back(
                    {{offset_from_surface(surface->position, surface->geometric_normal, direction), direction},
                     throughput,
                     distance,
                     branch.edges + 1});
        }
    };

    const auto trace_sample = [&](int pixel_x, int pixel_y, double x, double y, Tile& tile) {
        const std::uint32_t pixel = static_cast<std::uint32_t>(pixel_y) * static_cast<std::uint32_t>(camera.width) +
                                    static_cast<std::uint32_t>(pixel_x);
        std::vector<Branch> pending{{{camera.position, camera.direction(x, y)}, Color(1.0f), 0.0f, 1}};
        while (!pending.empty()) {
            const Branch branch = pending.back();
            pending.pop_back();
            trace_branch(branch, pixel, pending, tile);
        }
    };

    std::vector<Tile> tiles(static_cast<std::size_t>(tiles_across) * static_cast<std::size_t>(tiles_down));
    parallel_for(tiles.size(), threads, [&](std::size_t index) {
        const int left = static_cast<int>(index) % tiles_across * tile_size;
        const int top = static_cast<int>(index) / tiles_across * tile_size;
        for (int place = 0; place < tile_size * tile_size; ++place) {
            const int x = left + every_second_bit(place);
            const int y = top + every_second_bit(place >> 1);
            if (x >= camera.width || y >= camera.height) continue;
            for (int sample = 0; sample < samples_per_pixel; ++sample)
                trace_sample(x, y, x + (sample % grid + 0.5) / grid, y + (sample / grid + 0.5) / grid, tiles[index]);
        }
    });

    for (const Tile& tile : tiles) {
        result.points.insert(result.points.end(), tile.points.begin(), tile.points.end());
        result.footprints.insert(result.footprints.end(), tile.footprints.begin(), tile.footprints.end());
        result.emission.insert(result.emission.end(), tile.emission.begin(), tile.emission.end());
        result.weight_cut += tile.weight_cut;
        result.nonfinite += tile.nonfinite;
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

Surface surface_at(const Scene& scene, const HitPoint& point) {
    return {.bsdf = bsdf_at(scene.materials[point.material], point.texture_coordinate, false),
            .material = point.material,
            .texture_coordinate = point.texture_coordinate,
            .frame = make_frame(point.normal),
            .geometric_normal = point.geometric_normal,
            .position = point.position};
}

}  // namespace photonlab
