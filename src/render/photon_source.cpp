#include "render/photon_source.h"

#include <algorithm>

namespace photonlab {

namespace {

VisiblePathSettings chains_of(const MethodSettings& method, const Needs& needs) {
    // Discs of a pass are within those of the pass before, and follow from nothing that chains did. Areas are measured
    // anew as radii shrink: a photon that was out of reach may come into it by a hair.
    const bool are_nested = is_blind(method.schedule) && !needs.new_points && method.area == AreaMode::Disc;
    // Passes that begin at the last one's states are not independent, as an estimated error takes them to be.
    const bool may_depend = method.estimate_error == ErrorEstimation::Off;
    return {.step_rule = method.step_rule, .keeps_states = are_nested && may_depend};
}

}  // namespace

PhotonSource::PhotonSource(const Scene& scene, const PhotonSettings& settings, int threads,
                           const MethodSettings& method, const Needs& needs)
    : PhotonSource(scene, settings, threads) {
    if (!needs.has_own_photons) return;
    if (traces_visible_paths(method)) {
        chains_.emplace(chains_of(method, needs));
    } else {
        map_.emplace(scene);
        learn_passes_ = static_cast<std::uint64_t>(method.learn_passes);
    }
}

PhotonPass PhotonSource::trace(std::uint64_t pass, const std::function<AcceptingDiscs()>& where_accepted) {
    if (!chains_) return trace_photons(scene_, settings_, pass, threads_, map_ ? &*map_ : nullptr);
    // The camera's side of a path has an edge, and a photon one, or two where it has to have been reflected.
    const bool may_store = settings_.max_depth < 0 || settings_.max_depth > (settings_.store_direct ? 1 : 2);
    const AcceptingDiscs discs = may_store ? where_accepted() : AcceptingDiscs();
    if (discs.empty()) {
        PhotonPass dark;
        dark.paths_emitted = settings_.paths;
        return dark;
    }
    return chains_->trace(
        scene_, settings_, pass, [&](const Photon& photon) { return discs.accept(photon); }, threads_);
}

double PhotonSource::learn(std::uint64_t pass, const PhotonMap& photons, std::span<const std::uint32_t> accepted,
                           std::span<const std::uint32_t> cells) {
    std::vector<std::uint64_t> of_paths(cells.size(), 0);
    for (std::size_t i = 0; i < accepted.size(); ++i) of_paths[photons.notes().path[i]] += accepted[i];
    if (pass <= learn_passes_) map_->learn({cells, of_paths});
    const auto seen = std::count_if(of_paths.begin(), of_paths.end(), [](std::uint64_t count) { return count > 0; });
    return static_cast<double>(seen) / static_cast<double>(cells.size());
}

void PhotonSource::freeze(const EmissionMap& learnt) {
    map_ = learnt;
    learn_passes_ = 0;
}

void PhotonSource::exchange(StateArchive& archive) {
    if (map_) {
        map_->exchange(archive);
        archive.exchange(learn_passes_);
    }
    if (chains_) chains_->exchange(archive);
}

}  // namespace photonlab
