// Photons in groups of neighbours, so that a tree need only hold the groups: where light is spread out, a fourteenth of
// the points to build it over, and sixteen distances at a time where a search arrives.

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math.h"
#include "transport/light/photons.h"

namespace photonlab {

/// Photons [first, first + count) of the list, all of them in a ball.
struct PhotonGroup {
    Vector centre;
    float radius;
    std::uint32_t first;
    std::uint32_t count;  ///< 1 to PhotonGroups::capacity
};

/// Groups [first, end) of the list: those that are about as far apart.
struct GroupTier {
    std::size_t first;
    std::size_t end;
    float largest_radius;
};

class PhotonGroups {
public:
    static constexpr std::size_t capacity = 16;

    PhotonGroups() = default;

    /// Of photons that follow each other along a curve through space. A group ends at `capacity` photons, or before it
    /// would become wider than the median run of as many: curves jump, and the widest group widens every search.
    explicit PhotonGroups(const std::vector<Photon>& photons);

    const std::vector<PhotonGroup>& list() const { return list_; }  ///< tier by tier, along the curve in each

    /// Densest first. A tree can be told one radius for all of its groups, and the widest of a whole scene would make a
    /// search inside a caustic open every group there: so each tier is a tree of its own.
    const std::vector<GroupTier>& tiers() const { return tiers_; }

    Vector position(std::size_t photon) const { return {x_[photon], y_[photon], z_[photon]}; }
    std::uint64_t bytes() const;

    /// A bit for each photon of the group whose squared distance from `centre`, in float, is at most `bound`; the first
    /// one's lowest.
    unsigned within(const PhotonGroup& group, const Vector& centre, float bound) const {
        const float* x = &x_[group.first];
        const float* y = &y_[group.first];
        const float* z = &z_[group.first];
        // Straight-line code over the whole capacity, so that the compiler does all at once.
        std::array<float, capacity> squared_distance;
        for (std::size_t i = 0; i < capacity; ++i) {
            const float dx = x[i] - centre.x;
            const float dy = y[i] - centre.y;
            const float dz = z[i] - centre.z;
            squared_distance[i] = dx * dx + dy * dy + dz * dz;
        }
        unsigned inside = 0;
        for (std::size_t i = 0; i < capacity; ++i) inside |= static_cast<unsigned>(squared_distance[i] <= bound) << i;
        return inside & ((1u << group.count) - 1u);
    }

private:
    void make_groups(const std::vector<Photon>& photons);
    void make_tiers();

    std::vector<PhotonGroup> list_;
    std::vector<GroupTier> tiers_;
    // Positions once more, axis by axis, and then as many as a group may have, so that every group can be read whole.
    std::vector<float> x_;
    std::vector<float> y_;
    std::vector<float> z_;
};

}  // namespace photonlab
