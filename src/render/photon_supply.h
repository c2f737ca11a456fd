// The photons that methods gather: those of the current pass for progressive ones, those of all passes so far for
// photon mapping, each with the maps over them. Methods that run side by side on the same photons share one supply, so
// that photons are traced, sorted and indexed once, and that all see the same ones is true by construction.
//
// It does nothing by itself: whoever runs the methods calls what they need, and so can tell what each step costs.

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "gather/map/photon_map.h"
#include "integrators/integrator.h"
#include "transport/light/photons.h"

namespace photonlab {

class PhotonSupply {
public:
    void begin_pass(PhotonPass photons);

    /// Adds the photons of the pass to those of all passes: Needs::Photons::OfAllPasses, in every pass.
    void add_pass();

    /// Turns the photons of the pass into a map: Needs::Photons::OfPass. After add_pass(), for they are moved, not
    /// copied.
    void index_pass();

    /// Frees the photons of the pass and their map, so that they are gone before the next pass is traced.
    void end_pass();

    /// Indexes the photons of all passes: Needs::Photons::OfAllPasses, before an image is asked for.
    void index_all_passes();

    /// Frees the maps of index_all_passes(), which are large; the photons stay.
    void drop_maps_of_all_passes();

    /// See Pass::paths.
    double paths_of_pass() const { return static_cast<double>(pass_.paths_emitted) / pass_.seen_share; }
    std::span<const std::uint32_t> cells_of_pass() const { return pass_.cell; }
    const PhotonMap& pass_map() const { return pass_map_.value(); }

    /// After index_all_passes().
    PhotonsOfAllPasses all_passes() const { return {global_map_.value(), caustic_map_.value(), all_paths_}; }
    std::uint64_t bytes_of_all_passes() const;  ///< photons, and maps while there are any

private:
    PhotonPass pass_;
    std::optional<PhotonMap> pass_map_;
    std::vector<Photon> global_;  // of all passes, in their order
    std::vector<Photon> caustic_;
    std::uint64_t all_paths_ = 0;
    std::optional<PhotonMap> global_map_;
    std::optional<PhotonMap> caustic_map_;
};

}  // namespace photonlab
