// Where the photons of a pass come from: plain emission, whose photons any method can share; emission that learns; or
// paths that are seen. The last two belong to one method: what it found in earlier passes, or where it gathers, decides
// which paths are traced.

#pragma once

#include <functional>
#include <optional>
#include <span>

#include "integrators/integrator.h"
#include "transport/light/emission_map.h"
#include "transport/light/photons.h"
#include "transport/light/visible_paths.h"

namespace photonlab {

class PhotonSource {
public:
    /// Of plain emission.
    PhotonSource(const Scene& scene, const PhotonSettings& settings, int threads)
        : scene_(scene), settings_(settings), threads_(threads) {}

    /// Of what a method with Needs::has_own_photons asks for.
    PhotonSource(const Scene& scene, const PhotonSettings& settings, int threads, const MethodSettings& method,
                 const Needs& needs);

    const PhotonSettings& settings() const { return settings_; }

    /// Photons of pass `pass`. `where_accepted()` is asked where only paths that are seen are wanted.
    PhotonPass trace(std::uint64_t pass, const std::function<AcceptingDiscs()>& where_accepted);

    /// True when it wants to be told what becomes of photons.
    bool is_told_of_photons() const { return map_.has_value(); }

    /// What became of those of pass `pass`: how many hit points accepted each photon of the map; `cells` is where each
    /// path began. Returns the share of paths that were seen.
    double learn(std::uint64_t pass, const PhotonMap& photons, std::span<const std::uint32_t> accepted,
                 std::span<const std::uint32_t> cells);

    /// What was learnt so far; empty where emission does not learn.
    const std::optional<EmissionMap>& emission_map() const { return map_; }

    /// Emits by what was learnt elsewhere, and learns no more.
    void freeze(const EmissionMap& learnt);

    std::uint64_t bytes() const { return (map_ ? map_->bytes() : 0) + (chains_ ? chains_->bytes() : 0); }

    /// Writes or reads what was learnt, and where chains are.
    void exchange(StateArchive& archive);

private:
    const Scene& scene_;
    const PhotonSettings settings_;
    const int threads_;
    std::uint64_t learn_passes_ = 0;
    std::optional<EmissionMap> map_;
    std::optional<VisiblePaths> chains_;
};

}  // namespace photonlab
