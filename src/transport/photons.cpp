#include "transport/photons.h"

#include <utility>

#include "core/parallel.h"
#include "core/random.h"
#include "scene/emitter.h"
#include "transport/path_length.h"

namespace photonlab {

namespace {

constexpr std::size_t block_size = 256;        // paths that a thread traces at a time
constexpr std::size_t blocks_per_round = 128;  // then joined: still in the cache, and their memory is reused

/// Asymmetry of the BSDF's adjoint under shading normals, for a photon that arrives against `arriving` and leaves along
/// `leaving`: |arriving.ns leaving.ng| / |arriving.ng leaving.ns|. 1 on a flat surface. [Veach 1996, section 5.3]
float adjoint_correction(const Surface& surface, const Vector& arriving, const Vector& leaving) {
    const Vector& shading = surface.frame.normal;
    const Vector& geometric = surface.geometric_normal;
    if (shading == geometric) return 1.0f;
    return std::abs(arriving.dot(shading) * leaving.dot(geometric)) /
           std::abs(arriving.dot(geometric) * leaving.dot(shading));
}

/// What arrives at a surface.
struct Arrival {
    const Vector& from;  ///< unit
    const Color& power;
    std::uint32_t edges;
    bool only_specular;
};

/// Leaves a photon on a surface that spreads light.
void store(const std::optional<Surface>& surface, const Arrival& arrival, PhotonPass& result) {
    if (!surface || !is_scattering(surface->bsdf)) return;
    const Vector& normal = surface->frame.normal;
    const Vector& geometric = surface->geometric_normal;
    const Color carried = normal == geometric
                              ? arrival.power
                              : arrival.power * std::abs(arrival.from.dot(normal) / arrival.from.dot(geometric));
    if (is_finite(surface->position) && is_finite(arrival.from) && is_finite(carried))
        result.photons.push_back({.position = surface->position,
                                  .power = carried,
                                  .incoming = PackedDirection(arrival.from),
                                  .normal = CoarseDirection(normal),
                                  .edges = static_cast<std::uint16_t>(arrival.edges & 0x3fffu),
                                  .from_back = surface->from_back,
                                  .caustic = arrival.only_specular && arrival.edges > 1});
    else
        ++result.nonfinite;
}

void trace_path(const Scene& scene, const PhotonSettings& settings, RandomStream random, PhotonPass& result) {
    const std::uint32_t emitter = choose_emitter(scene, random.next_double());
    const Imath::V2f u_position = random.next_2d();
    const double u_triangle = random.next_double();
    const Imath::V2f u_direction = random.next_2d();
    const EmissionSample emission = sample_emission(scene, emitter, u_position, u_triangle, u_direction);

    Ray ray = emission.ray;
    Color power = emission.weight;
    bool only_specular = true;
    // The camera's side of a path has at least one edge, so a photon may have at most max_depth - 1.
    const std::uint32_t edge_limit =
        settings.max_depth < 0 ? largest_path_edges : static_cast<std::uint32_t>(std::max(0, settings.max_depth - 1));
    for (std::uint32_t edges = 1; edges <= edge_limit; ++edges) {
        const std::optional<Hit> hit = intersect(scene, ray);
        if (!hit) return;
        const Vector arriving = -ray.direction;
        const std::optional<Surface> surface = orient(scene, *hit, arriving);
        if (edges > 1 || settings.store_direct) {
            // Where a texture turns the normal, the path may end though a point nearby can gather the photon.
            if (has_turned_normals(scene.materials[scene.shapes[hit->shape].material]))
                store(orient_to_gather(scene, *hit, arriving), {arriving, power, edges, only_specular}, result);
            else
                store(surface, {arriving, power, edges, only_specular}, result);
        }
        if (!surface) return;
        if (edges == edge_limit) break;

        const std::optional<BsdfSample> bounce =
            sample(surface->bsdf, surface->frame.to_local(arriving), Carried::Flux, random.next_2d());
        const float survival_draw = random.next();
        if (!bounce) return;
        only_specular = only_specular && bounce->density == 0.0f;
        const float survival = std::min(max_channel(bounce->weight), highest_survival);
        if (survival_draw >= survival) return;
        const Vector leaving = surface->frame.to_world(bounce->incoming);
        if (!sides_agree(*surface, leaving)) return;
        power *= bounce->weight * (adjoint_correction(*surface, arriving, leaving) / survival);
        ray = {offset_from_surface(surface->position, surface->geometric_normal, leaving), leaving};
    }
    if (settings.max_depth < 0) {
        ++result.paths_cut;
        result.power_cut += mean_channel(ColorD(power));
    }
}

/// Photons of a whole pass of `blocks` blocks, when its first round found these; a little more, since memory that is
/// never touched costs nothing and growing costs a copy.
std::size_t expected_photons(const std::vector<PhotonPass>& first_round, std::size_t blocks) {
    std::size_t found = 0;
    for (const PhotonPass& block : first_round) found += block.photons.size();
    if (first_round.size() == blocks) return found;
    const double share = static_cast<double>(blocks) / static_cast<double>(first_round.size());
    return static_cast<std::size_t>(1.05 * share * static_cast<double>(found));
}

/// Empties the block but keeps its memory.
void move_to_end(PhotonPass& pass, PhotonPass& block) {
    pass.photons.insert(pass.photons.end(), block.photons.begin(), block.photons.end());
    block.photons.clear();
    pass.paths_cut += std::exchange(block.paths_cut, 0);
    pass.power_cut += std::exchange(block.power_cut, 0.0);
    pass.nonfinite += std::exchange(block.nonfinite, 0);
}

}  // namespace

PhotonPass trace_photons(const Scene& scene, const PhotonSettings& settings, std::uint64_t pass, int threads) {
    PhotonPass result;
    result.paths_emitted = settings.paths;
    if (scene.emitters.empty()) return result;

    const std::size_t blocks = block_count(settings.paths, block_size);
    std::vector<PhotonPass> round(std::min(blocks, blocks_per_round));
    for (std::size_t first = 0; first < blocks; first += round.size()) {
        const std::size_t in_round = std::min(round.size(), blocks - first);
        parallel_for(in_round, threads, [&](std::size_t slot) {
            const BlockRange range = block_range(first + slot, settings.paths, block_size);
            RandomStreams streams(settings.seed, settings.purpose, pass);
            for (std::size_t index = range.begin; index < range.end; ++index)
                trace_path(scene, settings, streams[index], round[slot]);
        });
        if (first == 0) result.photons.reserve(expected_photons(round, blocks));
        for (std::size_t slot = 0; slot < in_round; ++slot) move_to_end(result, round[slot]);
    }
    return result;
}

}  // namespace photonlab
