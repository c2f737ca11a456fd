// The photons that methods gather: those of the current pass for progressive ones, those of all passes so far for
// photon mapping, each with the maps over them. Methods that run side by side on the same photons share one supply, so
// that photons are traced, sorted and indexed once, and that all see the same ones is true by construction.
//
// It does nothing by itself: whoever runs the methods calls what they need, and so can tell what each step costs.

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gather/photon_map.h"
#include "transport/photons.h"

namespace photonlab {

/// What a method gathers.
enum class PhotonNeed { None, PassMap, AllPassesMaps };

class PhotonSupply {
public:
    void begin_pass(PhotonPass photons);

    /// Adds the photons of the pass to those of all passes: PhotonNeed::AllPassesMaps, in every pass.
    void add_pass();

    /// Turns the photons of the pass into a map: PhotonNeed::PassMap, before a method's run_pass(). After add_pass(),
    /// for they are moved, not copied.
    void index_pass();

    /// Frees the photons of the pass and their map, so that they are gone before the next pass is traced.
    void end_pass();

    /// Indexes the photons of all passes: PhotonNeed::AllPassesMaps, before a method's estimate().
    void index_all_passes();

    /// Frees the maps of index_all_passes(), which are large; the photons stay.
    void drop_maps_of_all_passes();

    std::uint64_t paths_of_pass() const { return pass_.paths_emitted; }
    const PhotonMap& pass_map() const { return pass_map_.value(); }

    std::uint64_t paths_of_all_passes() const { return all_paths_; }
    const PhotonMap& global_map() const { return global_map_.value(); }  ///< all but caustic photons
    const PhotonMap& caustic_map() const {
        return caustic_map_.value();
    }                                           ///< light that came by mirrors and glass alone
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
