#include "transport/light/photons.h"

#include "core/parallel.h"
#include "core/random.h"
#include "core/sobol.h"
#include "transport/light/light_path.h"

namespace photonlab {

namespace {

constexpr std::size_t block_size = 256;        // paths that a thread traces at a time
constexpr std::size_t blocks_per_round = 128;  // then joined: still in the cache, and their memory is reused

/// What an emission draws from a point of a sequence: place and direction from its first four numbers, the choices of a
/// light and of a part of it, which may have very many, from the others, whose last digits are the path's own.
class NumbersOfPoint {
public:
    NumbersOfPoint(const SobolSequence::Point& point, RandomStream& random) : point_(point), random_(random) {}

    double next_double() { return static_cast<double>(point_[choice_++]) + 0x1p-24 * random_.next_double(); }
    Imath::V2f next_2d() {
        const Imath::V2f numbers(point_[used_], point_[used_ + 1]);
        used_ += 2;
        return numbers;
    }

private:
    const SobolSequence::Point point_;
    RandomStream& random_;
    std::size_t used_ = 0;
    std::size_t choice_ = 4;
};

/// The sequences that the paths of a pass draw from. A sequence has 2^32 points; after these comes another one.
class LightSequence {
public:
    LightSequence(const PhotonSettings& settings, std::uint64_t pass, std::uint64_t first_path)
        : settings_(settings),
          first_(settings.emission == EmissionNumbers::SobolOfAllPasses ? (pass - 1) * settings.paths : pass << 32),
          number_((first_ + first_path) >> 32),
          sequence_(settings.seed, settings.purpose, number_) {}

    SobolSequence::Point operator[](std::uint64_t path) {
        const std::uint64_t index = first_ + path;
        if (index >> 32 != number_) {
            number_ = index >> 32;
            sequence_ = SobolSequence(settings_.seed, settings_.purpose, number_);
        }
        return sequence_[static_cast<std::uint32_t>(index)];
    }

private:
    const PhotonSettings& settings_;
    const std::uint64_t first_;  // index of the pass's first path
    std::uint64_t number_;
    SobolSequence sequence_;
};

/// Traces one path, of index `path`, whose emission draws from `numbers`.
template <typename Numbers>
void trace_path(const Scene& scene, const PhotonSettings& settings, const EmissionMap* learnt, std::size_t path,
                Numbers& numbers, RandomStream& random, PhotonPass& result) {
    if (!learnt) return follow_light(scene, settings, draw_emission(scene, numbers), random, result);
    const LearntEmission drawn = draw_emission(scene, *learnt, numbers);
    result.cell.push_back(drawn.cell);
    if (drawn.emission.weight == Color(0.0f)) return;
    follow_light(scene, settings, drawn.emission, random, result);
    result.notes.path.resize(result.photons.size(), static_cast<std::uint32_t>(path));
}

void trace_block(const Scene& scene, const PhotonSettings& settings, const EmissionMap* learnt, std::uint64_t pass,
                 BlockRange range, PhotonPass& result) {
    RandomStreams streams(settings.seed, settings.purpose, pass);
    if (settings.emission == EmissionNumbers::Independent) {
        for (std::size_t path = range.begin; path < range.end; ++path) {
            RandomStream random = streams[path];
            trace_path(scene, settings, learnt, path, random, random, result);
        }
        return;
    }
    LightSequence sequence(settings, pass, range.begin);
    for (std::size_t path = range.begin; path < range.end; ++path) {
        RandomStream random = streams[path];
        NumbersOfPoint numbers(sequence[path], random);
        trace_path(scene, settings, learnt, path, numbers, random, result);
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
    append(pass, block);
    block.photons.clear();
    block.notes.path.clear();
    block.cell.clear();
    block.paths_cut = block.nonfinite = 0;
    block.power_cut = 0.0;
}

}  // namespace

void append(PhotonPass& all, const PhotonPass& part) {
    const auto append_to = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
    append_to(all.photons, part.photons);
    append_to(all.notes.path, part.notes.path);
    append_to(all.notes.multiplicity, part.notes.multiplicity);
    append_to(all.cell, part.cell);
    all.paths_cut += part.paths_cut;
    all.power_cut += part.power_cut;
    all.nonfinite += part.nonfinite;
}

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
            trace_block(scene, settings, learnt, pass, range, round[slot]);
        });
        if (first == 0) result.photons.reserve(expected_photons(round, blocks));
        for (std::size_t slot = 0; slot < in_round; ++slot) move_to_end(result, round[slot]);
    }
    return result;
}

}  // namespace photonlab
