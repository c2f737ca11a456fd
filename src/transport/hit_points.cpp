#include "transport/hit_points.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include "core/error.h"
#include "core/morton.h"
#include "core/parallel.h"
#include "scene/emitter.h"

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

constexpr std::uint32_t edge_cap = 10'000;  // as for photons: ends what mirrors hold captive

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

std::vector<std::uint8_t> search_order(const HitPointList& points) {
    static_assert(hit_points_per_block - 1 <= std::numeric_limits<std::uint8_t>::max());
    std::vector<std::uint8_t> order;
    order.reserve(points.size());
    std::vector<std::pair<std::uint32_t, std::uint8_t>> places;
    for (std::size_t block = 0; block < block_count(points.size(), hit_points_per_block); ++block) {
        const BlockRange range = block_range(block, points.size(), hit_points_per_block);
        Box box;
        for (std::size_t i = range.begin; i < range.end; ++i) box.include(points[i].position);
        const MortonCurve curve(box);
        places.clear();
        for (std::size_t i = range.begin; i < range.end; ++i)
            places.emplace_back(curve.place_of(points[i].position), static_cast<std::uint8_t>(i - range.begin));
        std::sort(places.begin(), places.end());
        for (const auto& [place, index] : places) order.push_back(index);
    }
    return order;
}

}  // namespace

HitPointList::Kept HitPointList::kept_for(const Scene& scene) {
    Kept kept{false, false};
    for (const Shape& shape : scene.shapes) {
        const Material& material = scene.materials[shape.material];
        if (!std::holds_alternative<Diffuse>(material.bsdf) && !is_specular(material.bsdf)) kept.outgoing = true;
        if (material.texture) kept.texture_coordinates = true;
    }
    return kept;
}

void HitPointList::push_back(const HitPoint& point, bool is_diffuse) {
    constexpr std::size_t searched = 32;  // surfaces that meet in a tile are few
    const Facing facing{point.normal, point.geometric_normal, point.material};
    std::size_t index = facings_.size();
    for (std::size_t back = 1; back <= std::min(searched, facings_.size()) && index == facings_.size(); ++back)
        if (facings_[facings_.size() - back] == facing) index = facings_.size() - back;
    if (index == facings_.size()) facings_.push_back(facing);

    const bool is_plain = is_diffuse && point.camera_edges == 1 && point.weight == Color(share_);
    const auto facing_index = static_cast<std::uint32_t>(index);
    const auto view_index = static_cast<std::uint32_t>(views_.size());
    records_.push_back(
        {.position = point.position, .pixel = point.pixel, .seen = is_plain ? facing_index : view_index | of_view});
    if (!is_plain) views_.push_back({point.weight, facing_index, point.camera_edges});
    if (!is_plain && keeps_.outgoing) outgoing_.push_back(is_diffuse ? point.normal : point.outgoing);
    if (keeps_.texture_coordinates) texture_coordinates_.push_back(point.texture_coordinate);
}

void HitPointList::append(const HitPointList& other) {
    const auto first_facing = static_cast<std::uint32_t>(facings_.size());
    const auto first_view = static_cast<std::uint32_t>(views_.size());
    if (std::max(facings_.size() + other.facings_.size(), views_.size() + other.views_.size()) >= of_view)
        throw InputError("expected fewer than 2^31 hit points in an image");
    for (Record record : other.records_) {
        record.seen += (record.seen & of_view) == 0 ? first_facing : first_view;
        records_.push_back(record);
    }
    facings_.insert(facings_.end(), other.facings_.begin(), other.facings_.end());
    for (View view : other.views_) {
        view.facing += first_facing;
        views_.push_back(view);
    }
    outgoing_.insert(outgoing_.end(), other.outgoing_.begin(), other.outgoing_.end());
    texture_coordinates_.insert(texture_coordinates_.end(), other.texture_coordinates_.begin(),
                                other.texture_coordinates_.end());
}

void HitPointList::clear() {
    records_.clear();
    facings_.clear();
    views_.clear();
    outgoing_.clear();
    texture_coordinates_.clear();
}

HitPoint HitPointList::at(std::size_t index) const {
    if (index >= size()) throw std::out_of_range("HitPointList::at");
    return (*this)[index];
}

std::uint64_t HitPointList::bytes() const {
    return records_.size() * sizeof(Record) + facings_.size() * sizeof(Facing) + views_.size() * sizeof(View) +
           outgoing_.size() * sizeof(Vector) + texture_coordinates_.size() * sizeof(Imath::V2f);
}

HitPoints trace_hit_points(const Scene& scene, int samples_per_pixel, int threads, double branch_cutoff) {
    return trace_hit_points(scene, scene.camera, samples_per_pixel, threads, branch_cutoff);
}

HitPoints trace_hit_points(const Scene& scene, const Camera& camera, int samples_per_pixel, int threads,
                           double branch_cutoff) {
    constexpr std::size_t material_limit = std::size_t{1} << 16;  // HitPoint::material
    if (scene.materials.size() > material_limit)
        throw InputError("expected at most " + std::to_string(material_limit) + " materials in a scene, got " +
                         std::to_string(scene.materials.size()));
    const int grid = grid_size(samples_per_pixel);
    const float smallest_weight = static_cast<float>(branch_cutoff);
    const float share = 1.0f / static_cast<float>(samples_per_pixel);
    const int tiles_across = (camera.width + tile_size - 1) / tile_size;
    const HitPointList::Kept kept = HitPointList::kept_for(scene);
    const int tiles_down = (camera.height + tile_size - 1) / tile_size;

    HitPoints result;
    result.width = camera.width;
    result.height = camera.height;
    result.samples_per_pixel = samples_per_pixel;
    result.points = HitPointList(share, kept);
    // Untouched memory costs nothing, and growing costs a copy.
    const std::size_t samples = pixel_count(result) * static_cast<std::size_t>(samples_per_pixel);
    result.points.reserve(samples);
    result.footprints.reserve(samples);

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
                                   .texture_coordinate = surface->texture_coordinate},
                                  std::holds_alternative<Diffuse>(surface->bsdf));
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

    const auto trace_tile = [&](std::size_t index, Tile& tile) {
        const int left = static_cast<int>(index) % tiles_across * tile_size;
        const int top = static_cast<int>(index) / tiles_across * tile_size;
        for (int place = 0; place < tile_size * tile_size; ++place) {
            const int x = left + every_second_bit(place);
            const int y = top + every_second_bit(place >> 1);
            if (x >= camera.width || y >= camera.height) continue;
            for (int sample = 0; sample < samples_per_pixel; ++sample) {
                const int column = sample % grid;
                const int row = sample / grid;
                trace_sample(x, y, x + (column + 0.5) / grid, y + (row + 0.5) / grid, tile);
            }
        }
    };

    const std::size_t tiles = static_cast<std::size_t>(tiles_across) * static_cast<std::size_t>(tiles_down);
    std::vector<Tile> round(std::min(tiles, tiles_per_round));
    for (Tile& tile : round) tile.points = HitPointList(share, kept);
    for (std::size_t first = 0; first < tiles; first += round.size()) {
        const std::size_t in_round = std::min(round.size(), tiles - first);
        parallel_for(in_round, threads, [&](std::size_t slot) { trace_tile(first + slot, round[slot]); });
        for (std::size_t slot = 0; slot < in_round; ++slot) move_to_end(result, round[slot]);
    }
    result.search_order = search_order(result.points);
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
