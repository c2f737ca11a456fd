#include "transport/photons.h"

#include <utility>

#include "core/parallel.h"
#include "core/random.h"
#include "transport/light_path.h"

namespace photonlab {

namespace {

constexpr std::size_t block_size = 256;        // paths that a thread traces at a time
constexpr std::size_t blocks_per_round = 128;  // then joined: still in the cache, and their memory is reused

/// Traces one path, of index `path`.
void trace_path(const Scene& scene, const PhotonSettings& settings, const EmissionMap* learnt, std::size_t path,
                RandomStream random, PhotonPass& result) {
    if (!learnt) return follow_light(scene, settings, draw_emission(scene, random), random, result);
    const LearntEmission drawn = draw_emission(scene, *learnt, random);
    result.cell.push_back(drawn.cell);
    if (drawn.emission.weight == Color(0.0f)) return;
    follow_light(scene, settings, drawn.emission, random, result);
    result.notes.path.resize(result.photons.size(), static_cast<std::uint32_t>(path));
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
    const auto append = [](auto& to, auto& from) {
        to.insert(to.end(), from.begin(), from.end());
        from.clear();
    };
    append(pass.photons, block.photons);
    append(pass.notes.path, block.notes.path);
    append(pass.cell, block.cell);
    pass.paths_cut += std::exchange(block.paths_cut, 0);
    pass.power_cut += std::exchange(block.power_cut, 0.0);
    pass.nonfinite += std::exchange(block.nonfinite, 0);
}

}  // namespace

PhotonPass trace_photons(const Scene& scene, const PhotonSettings& settings, std::uint64_t pass, int threads,
                         const EmissionMap* learnt) {
    PhotonPass result;
    result.paths_emitted = result.paths_traced = settings.paths;
    if (scene.emitters.empty()) return result;

    const std::size_t blocks = block_count(settings.paths, block_size);
    std::vector<PhotonPass> round(std::min(blocks, blocks_per_round));
    for (std::size_t first = 0; first < blocks; first += round.size()) {
        const std::size_t in_round = std::min(round.size(), blocks - first);
        parallel_for(in_round, threads, [&](std::size_t slot) {
            const BlockRange range = block_range(first + slot, settings.paths, block_size);
            RandomStreams streams(settings.seed, settings.purpose, pass);
            for (std::size_t index = range.begin; index < range.end; ++index)
                trace_path(scene, settings, learnt, index, streams[index], round[slot]);
        });
        if (first == 0) result.photons.reserve(expected_photons(round, blocks));
        for (std::size_t slot = 0; slot < in_round; ++slot) move_to_end(result, round[slot]);
    }
    return result;
}

}  // namespace photonlab
