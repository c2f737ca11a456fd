// The gather asked the other way round: not which photons lie around a hit point, but whether any hit point of a pass
// accepts a photon. The tests are those of the gather (PhotonSide, depth, GatherArea), in discs of the same radii.
//
// A tree of boxes around the discs' balls, eight to a node, over the discs in their order along a Morton curve: it is
// made anew in every pass, since radii change, and takes a sort and one sweep.

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/morton.h"
#include "gather/areas/gather_areas.h"
#include "gather/map/photon_map.h"
#include "scene/scene.h"

namespace photonlab {

/// Where a hit point accepts photons.
struct AcceptingDisc {
    GatherQuery query;
    std::uint16_t camera_edges = 1;
};

class AcceptingDiscs {
public:
    AcceptingDiscs() = default;

    /// `areas`: of each disc; none where all are whole. `max_depth`: edges from camera to light. A disc whose point is
    /// not finite accepts nothing. The scene must outlive this.
    AcceptingDiscs(const Scene& scene, int max_depth, std::vector<AcceptingDisc> discs, std::vector<GatherArea> areas);

    bool empty() const { return discs_.empty(); }

    /// May be asked on any thread.
    bool accept(const Photon& photon) const;

    std::uint64_t bytes() const;

private:
    static constexpr std::size_t children = 8;

    bool accepts(const AcceptingDisc& disc, std::size_t index, const Photon& photon, const PhotonSide& side) const;
    bool is_accepted_below(std::size_t level, std::size_t node, const Photon& photon, const PhotonSide& side) const;

    const Scene* scene_ = nullptr;
    int max_depth_ = -1;
    std::vector<AcceptingDisc> discs_;      // along the curve
    std::vector<GatherArea> areas_;         // in their first order
    std::vector<std::uint32_t> order_;      // of each disc along the curve: its index in that order
    std::vector<std::vector<Box>> levels_;  // boxes of up to eight of the level before; the first level's of discs
};

}  // namespace photonlab
