#include "transport/camera/camera_pass.h"

#include <fmt/format.h>

#include <cmath>

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/error.h"
#include "core/parallel.h"
#include "core/sobol.h"
#include "scene/emitter.h"
#include "transport/direct_light.h"
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
    std::uint32_t spread = 0;        ///< glossy surfaces that it went on from
    float density = 0.0f;            ///< per steradian, of the ray; 0: not drawn at a glossy surface
    Vector drawn_at = Vector(0.0f);  ///< where it was drawn
};

constexpr std::uint32_t roulette_after = 3;  // glossy surfaces: most paths end at others before

/// Of light at the end of the branch's ray.
SeenLayer layer_of(const Branch& branch) {
    if (branch.spread == 0) return SeenLayer::Emission;
    return branch.spread == 1 && branch.density > 0.0f ? SeenLayer::Direct : SeenLayer::Gathered;
}

/// Where a camera path begins.
struct CameraSample {
    double x, y;  ///< pixels, from the upper left corner of the image
    Imath::V2f on_lens = Imath::V2f(0.0f);
};

/// In cell `cell` of the grid x grid cells of a pixel, at `within` it, each coordinate from 0 to 1.
CameraSample in_cell(const Camera& camera, std::uint32_t pixel, int grid, int cell,
                     const Imath::V2d& within = Imath::V2d(0.5)) {
    const int x = static_cast<int>(pixel) % camera.width;
    const int y = static_cast<int>(pixel) / camera.width;
    return {x + (cell % grid + within.x) / grid, y + (cell / grid + within.y) / grid};
}

/// The same samples in every pass: the grid of each pixel, with a lens point for each cell. Those are the points of the
/// additive recurrence of the plastic number, moved by random numbers of the pixel, so that neighbours differ.
/// [Roberts 2018, "The unreasonable effectiveness of quasirandom sequences"]
class GridSamples {
public:
    GridSamples(const Camera& camera, int samples_per_pixel) : camera_(camera), grid_(grid_size(samples_per_pixel)) {}

    double share() const { return 1.0 / (grid_ * grid_); }

    /// Calls `take(sample, nullptr)`: these paths draw no numbers.
    template <typename Take>
    void of_pixel(std::uint32_t pixel, const Take& take) const {
        Imath::V2f moved(0.0f);
        if (camera_.has_lens()) moved = RandomStream(0, RandomPurpose::CameraPositions, 0, pixel).next_2d();
        for (int cell = 0; cell < grid_ * grid_; ++cell) {
            CameraSample sample = in_cell(camera_, pixel, grid_, cell);
            sample.on_lens = lens(moved, cell);
            take(sample, static_cast<RandomStream*>(nullptr));
        }
    }

private:
    static Imath::V2f lens(const Imath::V2f& moved, int cell) {
        const auto fraction = [](double value) { return static_cast<float>(value - std::floor(value)); };
        return {fraction(static_cast<double>(moved.x) + 0.7548776662466927 * cell),
                fraction(static_cast<double>(moved.y) + 0.5698402909980532 * cell)};
    }

    const Camera& camera_;
    const int grid_;  // columns, and rows, of samples in a pixel
};

/// Samples of one pass (trace_new_hit_points()).
class NewSamples {
public:
    NewSamples(const Camera& camera, int samples_per_pixel, const NewPoints& points, const PassOfStream& pass)
        : camera_(camera),
          positions_(points.positions),
          positions_grid_(grid_size(samples_per_pixel)),
          paths_grid_(points.all_cells ? positions_grid_ : 1),
          pass_(pass) {}

    double share() const { return positions_ == Positions::Grid ? 1.0 : 1.0 / (paths_grid_ * paths_grid_); }

    /// Calls `take(sample, &stream)` with the stream that the rest of the path draws from.
    template <typename Take>
    void of_pixel(std::uint32_t pixel, const Take& take) const {
        RandomStream random(pass_.seed, pass_.purpose, pass_.pass, pixel);
        const auto take_with_lens = [&](CameraSample sample) {
            if (camera_.has_lens()) sample.on_lens = random.next_2d();
            take(sample, &random);
        };
        if (positions_ == Positions::Grid)
            return take_with_lens(in_cell(camera_, pixel, positions_grid_, cell_of(pixel)));
        const int cells = paths_grid_ * paths_grid_;
        for (int cell = 0; cell < cells; ++cell) {
            if (positions_ == Positions::Box) {
                take_with_lens(in_cell(camera_, pixel, paths_grid_, cell, Imath::V2d(random.next_2d())));
            } else {
                take(of_sequence(pixel, (pass_.pass - 1) * static_cast<std::uint64_t>(cells) + cell), &random);
            }
        }
    }

private:
    /// Point number `index` of the pixel's sequence; over 2^32 of them it begins again.
    CameraSample of_sequence(std::uint32_t pixel, std::uint64_t index) const {
        const SobolSequence sequence(pass_.seed, pass_.purpose, pixel);
        const SobolSequence::Point point = sequence[static_cast<std::uint32_t>(index)];
        CameraSample sample = in_cell(camera_, pixel, 1, 0, {point[0], point[1]});
        sample.on_lens = {point[2], point[3]};
        return sample;
    }

    /// The position whose turn it is: in each cycle of as many passes as there are positions every one comes once, in
    /// the order (first + stride * place) modulo their number, with a random first and a random stride without a
    /// common divisor.
    int cell_of(std::uint32_t pixel) const {
        const auto count = static_cast<std::uint64_t>(positions_grid_ * positions_grid_);
        const std::uint64_t cycle = (pass_.pass - 1) / count;
        RandomStream random(pass_.seed, pass_.purpose, cycle, std::uint64_t{1} << 40 | pixel);
        const std::uint64_t first = random.next_bits() % count;
        std::uint64_t stride = 1;
        do stride = 1 + random.next_bits() % count;
        while (std::gcd(stride, count) != 1);
        return static_cast<int>((first + stride * ((pass_.pass - 1) % count)) % count);
    }

    const Camera& camera_;
    const Positions positions_;
    const int positions_grid_;  // columns, and rows, of the sample positions of a pixel
    const int paths_grid_;      // and of the cells in each of which a path begins
    const PassOfStream pass_;
};

/// Follows the samples of a tile into the scene.
template <typename Samples>
class TileTracer {
public:
    TileTracer(const Scene& scene, const Camera& camera, const Samples& samples, const NewPoints& kind,
               double branch_cutoff)
        : scene_(scene),
          camera_(camera),
          samples_(samples),
          branches_(kind.branches),
          gather_roughness_(static_cast<float>(kind.gather_roughness)),
          share_(static_cast<float>(samples.share())),
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
            samples_.of_pixel(pixel, [&](const CameraSample& sample, RandomStream* random) {
                trace_sample(sample, pixel, random, tile);
            });
        }
    }

private:
    /// `random` is there where branches are chosen.
    void trace_sample(const CameraSample& sample, std::uint32_t pixel, RandomStream* random, Tile& tile) const {
        std::vector<Branch> pending{{camera_.ray(sample.x, sample.y, sample.on_lens), Color(1.0f), 0.0f, 1}};
        while (!pending.empty()) {
            const Branch branch = pending.back();
            pending.pop_back();
            trace_branch(branch, pixel, random, pending, tile);
        }
    }

    /// To the next surface: leaves a hit point there, or adds what goes on from it to `pending`.
    void trace_branch(const Branch& branch, std::uint32_t pixel, RandomStream* random, std::vector<Branch>& pending,
                      Tile& tile) const {
        const std::optional<Hit> hit = intersect(scene_, branch.ray);
        const Vector outgoing = -branch.ray.direction;
        const ColorD emitted = met_radiance(scene_, hit, branch.ray.direction);
        if (!is_black(emitted)) see(branch, hit, emitted, pixel, tile);
        if (!hit) return;
        const std::optional<Surface> surface = orient(scene_, *hit, outgoing);
        if (!surface) return;
        const float distance = branch.distance + hit->distance;
        const float footprint = distance * static_cast<float>(camera_.pixel_angle);
        if (!is_finite(surface->position) || !std::isfinite(footprint) || !is_finite(branch.throughput)) {
            ++tile.nonfinite;
            return;
        }
        if (is_specular(surface->bsdf)) branch_on(branch, *surface, distance, random, pending, tile);
        if (!is_scattering(surface->bsdf)) return;
        if (random && roughness(surface->bsdf).value_or(gather_roughness_) < gather_roughness_)
            return go_on(branch, *surface, distance, pixel, *random, pending, tile);
        tile.points.push_back(
            {.position = surface->position,
             .normal = surface->frame.normal,
             .geometric_normal = surface->geometric_normal,
             .outgoing = outgoing,
             .weight = branch.throughput * share_,
             .pixel = pixel,
             .material = static_cast<std::uint16_t>(surface->material),
             .camera_edges = static_cast<std::uint16_t>(branch.edges),
             .texture_coordinate = surface->texture_coordinate,
             .turn = scene_.materials[surface->material].is_anisotropic ? turn_of(surface->frame) : 0.0f,
             .from_back = surface->from_back,
             .is_after_glossy = branch.spread > 0},
            uniform_value(surface->bsdf).has_value());
        tile.footprints.push_back(footprint);
    }

    /// Keeps light that the branch's ray met.
    void see(const Branch& branch, const std::optional<Hit>& hit, const ColorD& emitted, std::uint32_t pixel,
             Tile& tile) const {
        const double weight = weight_of_ray(scene_, branch.drawn_at, branch.ray.direction, hit, branch.density);
        tile.emission.push_back(
            {pixel, branch.edges, emitted * ColorD(branch.throughput * share_) * weight, layer_of(branch)});
    }

    /// What lights bring to a glossy surface by a connection, and the branch that goes on from it.
    void go_on(const Branch& branch, const Surface& surface, float distance, std::uint32_t pixel, RandomStream& random,
               std::vector<Branch>& pending, Tile& tile) const {
        const Vector outgoing = -branch.ray.direction;
        if (const auto light = connect_to_light(scene_, surface, outgoing, random)) {
            const double weight = weight_of_connection(*light);
            tile.emission.push_back({pixel, branch.edges + 1,
                                     light->contribution * ColorD(branch.throughput * share_) * weight,
                                     branch.spread == 0 ? SeenLayer::Direct : SeenLayer::Gathered});
        }
        const auto bounce = sample(surface.bsdf, surface.frame.to_local(outgoing), Carried::Radiance, random.next_2d());
        const float survival_draw = random.next();
        if (!bounce) return;
        const Vector direction = surface.frame.to_world(bounce->incoming);
        if (!sides_agree(surface, direction)) return;
        Color throughput = branch.throughput * bounce->weight;
        if (branch.spread >= roulette_after) {
            const float survival = std::min(max_channel(bounce->weight), highest_survival);
            if (survival_draw >= survival) return;
            throughput /= survival;
        }
        const Vector origin = offset_from_surface(surface.position, surface.geometric_normal, direction);
        extend({{origin, direction},
                throughput,
                distance,
                branch.edges + 1,
                branch.spread + 1,
                bounce->density,
                surface.position},
               pending, tile);
    }

    /// Adds the branch to `pending`, but where it carries too little or is too long.
    void extend(const Branch& branch, std::vector<Branch>& pending, Tile& tile) const {
        if (max_channel(branch.throughput) < smallest_weight_ || branch.edges > largest_path_edges)
            tile.weight_cut += mean_channel(ColorD(branch.throughput)) * static_cast<double>(share_);
        else
            pending.push_back(branch);
    }

    /// Adds what a mirror or glass makes of the branch to `pending`, but for what carries too little. `distance` is
    /// that of the surface.
    void branch_on(const Branch& branch, const Surface& surface, float distance, RandomStream* random,
                   std::vector<Branch>& pending, Tile& tile) const {
        const Vector outgoing = surface.frame.to_local(-branch.ray.direction);
        SpecularBranches onward = specular_branches(surface.bsdf, outgoing, Carried::Radiance);
        if (random && branches_ == Branches::One && onward.count > 1) onward = one_of(onward, random->next());
        for (const SpecularBranch& way : onward) {
            const Vector direction = surface.frame.to_world(way.incoming);
            if (!sides_agree(surface, direction)) continue;  // absorbed, as for every path here
            const Vector origin = offset_from_surface(surface.position, surface.geometric_normal, direction);
            extend({{origin, direction}, branch.throughput * way.weight, distance, branch.edges + 1, branch.spread},
                   pending, tile);
        }
    }

    /// One of the ways, with the probability of its weight, by which it is divided.
    static SpecularBranches one_of(const SpecularBranches& ways, float draw) {
        double all = 0.0;
        for (const SpecularBranch& way : ways) all += mean_channel(ColorD(way.weight));
        if (!(all > 0.0)) return {};
        double below = static_cast<double>(draw) * all;
        const SpecularBranch* chosen = ways.begin();
        for (; chosen + 1 != ways.end(); ++chosen) {
            const double weight = mean_channel(ColorD(chosen->weight));
            if (below < weight) break;
            below -= weight;
        }
        const double probability = mean_channel(ColorD(chosen->weight)) / all;
        SpecularBranches one = ways;
        one.count = 0;
        if (probability > 0.0) one.add(chosen->incoming, chosen->weight * static_cast<float>(1.0 / probability));
        return one;
    }

    const Scene& scene_;
    const Camera& camera_;
    const Samples& samples_;
    const Branches branches_;
    const float gather_roughness_;
    const float share_;  // of a sample in its pixel
    const float smallest_weight_;
    const int tiles_across_;
    const int tiles_down_;
};

template <typename Samples>
HitPoints trace_samples(const Scene& scene, const Camera& camera, const Samples& samples, const NewPoints& kind,
                        int threads, double branch_cutoff) {
    constexpr std::size_t material_limit = std::size_t{1} << 16;  // HitPoint::material
    if (scene.materials.size() > material_limit)
        throw InputError("expected at most " + std::to_string(material_limit) + " materials in a scene, got " +
                         std::to_string(scene.materials.size()));
    const TileTracer tracer(scene, camera, samples, kind, branch_cutoff);

    HitPoints result;
    result.width = camera.width;
    result.height = camera.height;
    result.points = tracer.empty_list();
    // Untouched memory costs nothing, and growing costs a copy.
    const auto count = static_cast<std::size_t>(static_cast<double>(pixel_count(result)) / samples.share() + 0.5);
    result.points.reserve(count);
    result.footprints.reserve(count);

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

}  // namespace

HitPoints trace_hit_points(const Scene& scene, int samples_per_pixel, int threads, double branch_cutoff) {
    return trace_hit_points(scene, scene.camera, samples_per_pixel, threads, branch_cutoff);
}

HitPoints trace_hit_points(const Scene& scene, const Camera& camera, int samples_per_pixel, int threads,
                           double branch_cutoff) {
    const GridSamples samples(camera, samples_per_pixel);
    HitPoints result = trace_samples(scene, camera, samples, {}, threads, branch_cutoff);
    result.samples_per_pixel = samples_per_pixel;
    return result;
}

HitPoints trace_new_hit_points(const Scene& scene, int samples_per_pixel, const NewPoints& points,
                               const PassOfStream& pass, int threads, double branch_cutoff) {
    return trace_new_hit_points(scene, scene.camera, samples_per_pixel, points, pass, threads, branch_cutoff);
}

HitPoints trace_new_hit_points(const Scene& scene, const Camera& camera, int samples_per_pixel, const NewPoints& points,
                               const PassOfStream& pass, int threads, double branch_cutoff) {
    const NewSamples samples(camera, samples_per_pixel, points, pass);
    HitPoints result = trace_samples(scene, camera, samples, points, threads, branch_cutoff);
    result.samples_per_pixel = samples_per_pixel;
    return result;
}

std::vector<ColorD> seen_image(const HitPoints& hit_points, int max_depth, SeenLayer layer) {
    std::vector<ColorD> image(pixel_count(hit_points), ColorD(0.0));
    for (const SeenEmission& seen : hit_points.emission)
        if (seen.layer == layer && depth_allows(max_depth, seen.edges)) image[seen.pixel] += seen.radiance;
    return image;
}

std::vector<ColorD> emission_image(const HitPoints& hit_points, int max_depth) {
    return seen_image(hit_points, max_depth, SeenLayer::Emission);
}

void require_perfect_square(std::int64_t samples_per_pixel) {
    const auto side = std::llround(std::sqrt(static_cast<double>(samples_per_pixel)));
    if (samples_per_pixel < 1 || side > 1024 || side * side != samples_per_pixel)
        throw InputError(
            fmt::format("samples_per_pixel: expected a perfect square from 1 to 1048576, got {}", samples_per_pixel));
}

}  // namespace photonlab
