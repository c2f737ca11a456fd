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
    std::uint64_t nonfinite = 0;
};

/// Square root of a perfect square; InputError for anything else.
int grid_size(int samples_per_pixel) {
    const int size = static_cast<int>(std::lround(std::sqrt(std::max(0, samples_per_pixel))));
    if (samples_per_pixel < 1 || size * size != samples_per_pixel)
        throw InputError("samples_per_pixel: expected a perfect square (1, 4, 9, 16, ...), got " +
                         std::to_string(samples_per_pixel));
    return size;
}

}  // namespace

HitPoints trace_hit_points(const Scene& scene, int samples_per_pixel, int threads) {
    constexpr std::size_t material_limit = std::size_t{1} << 16;  // HitPoint::material
    if (scene.materials.size() > material_limit)
        throw InputError("expected at most " + std::to_string(material_limit) + " materials in a scene, got " +
                         std::to_string(scene.materials.size()));
    const Camera& camera = scene.camera;
    const int grid = grid_size(samples_per_pixel);
    const float share = 1.0f / static_cast<float>(samples_per_pixel);
    const int tiles_across = (camera.width + tile_size - 1) / tile_size;
    const int tiles_down = (camera.height + tile_size - 1) / tile_size;

    HitPoints result;
    result.width = camera.width;
    result.height = camera.height;
    result.samples_per_pixel = samples_per_pixel;
    result.emission.assign(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height),
                           ColorD(0.0));

    const auto trace_sample = [&](int pixel_x, int pixel_y, double x, double y, Tile& tile) {
        const Ray ray{camera.position, camera.direction(x, y)};
        const std::optional<Hit> hit = intersect(scene, ray);
        if (!hit) return;
        const std::uint32_t pixel = static_cast<std::uint32_t>(pixel_y) * static_cast<std::uint32_t>(camera.width) +
                                    static_cast<std::uint32_t>(pixel_x);
        const Vector outgoing = -ray.direction;
        result.emission[pixel] += emitted_radiance(scene, *hit, outgoing) * static_cast<double>(share);
        const std::optional<Surface> surface = orient(scene, *hit, outgoing);
        if (!surface) return;
        const float footprint = hit->distance * static_cast<float>(camera.pixel_angle);
        if (!is_finite(surface->position) || !std::isfinite(footprint)) {
            ++tile.nonfinite;
            return;
        }
        const auto material = static_cast<std::uint16_t>(surface->material - scene.materials.data());
        tile.points.push_back({.position = surface->position,
                               .normal = surface->frame.normal,
                               .geometric_normal = surface->geometric_normal,
                               .outgoing = outgoing,
                               .weight = Color(share),
                               .pixel = pixel,
                               .material = material,
                               .camera_edges = 1});
        tile.footprints.push_back(footprint);
    };

    std::vector<Tile> tiles(static_cast<std::size_t>(tiles_across) * static_cast<std::size_t>(tiles_down));
    parallel_for(tiles.size(), threads, [&](std::size_t index) {
        const int left = static_cast<int>(index) % tiles_across * tile_size;
        const int top = static_cast<int>(index) / tiles_across * tile_size;
        for (int y = top; y < std::min(top + tile_size, camera.height); ++y)
            for (int x = left; x < std::min(left + tile_size, camera.width); ++x)
                for (int sample = 0; sample < samples_per_pixel; ++sample)
                    trace_sample(x, y, x + (sample % grid + 0.5) / grid, y + (sample / grid + 0.5) / grid,
                                 tiles[index]);
    });

    for (const Tile& tile : tiles) {
        result.points.insert(result.points.end(), tile.points.begin(), tile.points.end());
        result.footprints.insert(result.footprints.end(), tile.footprints.begin(), tile.footprints.end());
        result.nonfinite += tile.nonfinite;
    }
    return result;
}

Surface surface_at(const Scene& scene, const HitPoint& point) {
    return {.material = &scene.materials[point.material],
            .frame = make_frame(point.normal),
            .geometric_normal = point.geometric_normal,
            .position = point.position};
}

}  // namespace photonlab
