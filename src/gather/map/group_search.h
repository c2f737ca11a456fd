// FLANN, and nothing of the map but photon_map.cpp includes it: k-d trees over the centres of groups of photons, one
// for each tier of density, whose own recursive search calls a visitor.
//
// FLANN squares radii in float, excludes the rim and crashes on an empty set; what it cannot square makes it lose other
// points of a search. Bounds are handed to it a hair wider and with a floor, tiers are never empty, and whoever makes
// this has left out what is not squarable.
//
// [Muja & Lowe 2009, "Fast Approximate Nearest Neighbors with Automatic Algorithm Configuration"]

#pragma once

#include <flann/defines.h>
// dist.h must come first: kdtree_single_index.h uses it without including it.
#include <flann/algorithms/dist.h>
#include <flann/algorithms/kdtree_single_index.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <vector>

#include "core/math.h"
#include "gather/map/photon_groups.h"
#include "gather/map/photon_map.h"

namespace photonlab {

/// By how much float may err in a squared distance: most in FLANN's, which it sums up on its way down a tree, 9e-6 in
/// the deepest there can be.
inline constexpr double squared_distance_slack = 1e-5;

/// The bound on squared distances in float that loses nothing within `radius`; what it keeps beyond is tested exactly
/// afterwards.
inline float squared_bound(double radius) {
    const double floored = std::max(radius, PhotonMap::minimum_radius);
    return static_cast<float>(std::min(floored * floored * (1.0 + squared_distance_slack),
                                       static_cast<double>(std::numeric_limits<float>::max())));
}

class GroupSearch {
public:
    /// Of photons along a curve through space, at squarable positions.
    explicit GroupSearch(const std::vector<Photon>& photons);

    /// Opens every group whose ball comes within `opened_share` (0 to 1) of the sink's reach around the centre, and
    /// hands the sink its photons within all of that reach: `bool take(const Vector& position, std::size_t index, const
    /// Photon&)`, true when `double reach() const` has shrunk by it. `photons` are those that this was made of. Nothing
    /// is found from a centre that is not squarable.
    template <typename Sink>
    void search(const std::vector<Photon>& photons, const Vector& centre, double opened_share, Sink& sink) const;

    std::uint64_t bytes() const { return bytes_; }  ///< of groups and trees

private:
    using Index = flann::KDTreeSingleIndex<flann::L2_3D<float>>;
    template <typename Sink>
    class Visitor;

    PhotonGroups groups_;
    std::vector<std::unique_ptr<Index>> trees_;  // of the centres of each tier's groups
    std::uint64_t bytes_ = 0;
};

/// What FLANN calls for each group whose centre is below the bound.
template <typename Sink>
class GroupSearch::Visitor : public flann::ResultSet<float> {
public:
    Visitor(const std::vector<Photon>& photons, const PhotonGroups& groups, const GroupTier& tier, const Vector& centre,
            double opened_share, Sink& sink)
        : photons_(photons), groups_(groups), tier_(tier), centre_(centre), opened_share_(opened_share), sink_(sink) {
        set_bounds();
    }

    bool full() const override { return true; }  // the sink's reach bounds the search from the start
    float worstDist() const override { return squared_group_bound_; }
    void addPoint(float squared_distance, std::size_t index) override {
        const PhotonGroup& group = groups_.list()[tier_.first + index];
        const float farthest = opened_ + group.radius;
        if (squared_distance > farthest * farthest * static_cast<float>(1.0 + squared_distance_slack)) return;
        const unsigned inside = groups_.within(group, centre_, squared_photon_bound_);
        const auto each = [&](const auto& call) {
            for (unsigned left = inside; left != 0; left &= left - 1)
                call(group.first + static_cast<std::size_t>(std::countr_zero(left)));
        };
        // A group's photons come from memory together, not one after the other.
        each([&](std::size_t photon) { __builtin_prefetch(&photons_[photon]); });
        bool has_shrunk = false;
        each([&](std::size_t photon) { has_shrunk |= sink_.take(groups_.position(photon), photon, photons_[photon]); });
        if (has_shrunk) set_bounds();
    }

private:
    void set_bounds() {
        const double reach = sink_.reach();
        // Not below what float can square, however near the k-th photon is.
        const double opened = std::clamp(reach * opened_share_, PhotonMap::minimum_radius,
                                         static_cast<double>(std::numeric_limits<float>::max()));
        opened_ = static_cast<float>(opened);
        squared_photon_bound_ = squared_bound(reach);
        squared_group_bound_ = squared_bound(opened + tier_.largest_radius);
    }

    const std::vector<Photon>& photons_;
    const PhotonGroups& groups_;
    const GroupTier& tier_;
    const Vector centre_;
    const double opened_share_;
    Sink& sink_;
    float opened_;  // distance within which a group's ball must come
    float squared_photon_bound_;
    float squared_group_bound_;  // on their centres
};

inline GroupSearch::GroupSearch(const std::vector<Photon>& photons) : groups_(photons) {
    constexpr int leaf_max_size = 8;
    // FLANN reports its nodes and permutation, in an int that wraps at 2 GB, and not its pointer to each point nor its
    // reordered copy of the positions.
    bytes_ = groups_.bytes() + groups_.list().size() * (sizeof(float*) + 3 * sizeof(float));
    for (const GroupTier& tier : groups_.tiers()) {
        // FLANN takes what it is given as not const, and only reads it.
        auto* first_centre = const_cast<float*>(&groups_.list()[tier.first].centre.x);
        const flann::Matrix<float> centres(first_centre, tier.end - tier.first, 3, sizeof(PhotonGroup));
        trees_.push_back(std::make_unique<Index>(centres, flann::KDTreeSingleIndexParams(leaf_max_size, true)));
        trees_.back()->buildIndex();
        bytes_ += static_cast<std::uint32_t>(trees_.back()->usedMemory());
    }
}

template <typename Sink>
void GroupSearch::search(const std::vector<Photon>& photons, const Vector& centre, double opened_share,
                         Sink& sink) const {
    if (!is_squarable(centre)) return;
    for (std::size_t tier = 0; tier < trees_.size(); ++tier) {
        Visitor<Sink> visitor(photons, groups_, groups_.tiers()[tier], centre, opened_share, sink);
        trees_[tier]->findNeighbors(visitor, &centre.x, flann::SearchParams());
    }
}

}  // namespace photonlab
