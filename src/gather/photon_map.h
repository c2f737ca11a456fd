// The gather layer: photons in a k-d tree of FLANN, asked by position, normal and radius.
//
// Photons are sorted along a Morton curve before the build, which makes build and search together 1.4 to 3 times
// cheaper, and FLANN's own recursive search calls a visitor, so sums happen in place and every query has its own
// radius. FLANN squares radii, excludes the rim, crashes on an empty set and loses photons of *other* queries when one
// is NaN: the guards against each are here and nowhere else.
//
// A photon is found when it passes the geometric tests, whatever its BRDF value: distance at most the radius, arrived
// on the side of the query's normal, its own normal within 60 degrees of that normal.
//
// [Jensen 2001, chapter 5: the photon map; Muja & Lowe 2009: FLANN]

#pragma once

#include <flann/defines.h>
// dist.h must come first: kdtree_single_index.h uses it without including it.
#include <flann/algorithms/dist.h>
#include <flann/algorithms/kdtree_single_index.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/math.h"
#include "transport/photons.h"

namespace photonlab {

/// True when a photon counts at a surface point with this normal (unit, facing the viewer).
inline bool is_accepted(const Photon& photon, const Vector& normal) {
    return photon.incoming.dot(normal) > 0.0f && photon.normal.dot(normal) > 0.5f;
}

/// Answer of PhotonMap::nearest().
struct NearestPhotons {
    std::size_t found = 0;        ///< accepted photons within the maximum radius, at most k
    double squared_radius = 0.0;  ///< of the disc to divide by: the k-th photon's, or the maximum when fewer were found
};

/// One candidate among the k nearest. Ties in distance go to the lower index, so that the answer does not depend on the
/// order of the search.
struct Neighbour {
    double squared_distance;
    std::uint32_t index;  ///< into the map's photons
    bool operator<(const Neighbour& other) const {
        return squared_distance != other.squared_distance ? squared_distance < other.squared_distance
                                                          : index < other.index;
    }
};

/// All queries are const and may run concurrently; none depends on the thread that asks. A non-finite query point finds
/// nothing.
class PhotonMap {
public:
    /// Sorts and indexes the photons; single-threaded, the same result always. Photons whose position is not finite (or
    /// so far out that float32 cannot square it) are left out and counted.
    explicit PhotonMap(std::vector<Photon> photons);

    /// Calls `visit(const Photon&, double squared_distance)` for every accepted photon with distance <= radius (unit
    /// box), in an order that depends on the photons and the query alone. A radius below minimum_radius is taken as
    /// that.
    template <typename Visit>
    void within(const Vector& position, const Vector& normal, double radius, const Visit& visit) const;

    /// Finds the k nearest accepted photons within `max_radius`, then calls `visit(const Photon&, double
    /// squared_distance, double squared_radius)`, nearest first, for those that carry flux: all of them when fewer than
    /// k were found; else all but the k-th, which sets the radius and carries none (theory.md, section 4).
    template <typename Visit>
    NearestPhotons nearest(const Vector& position, const Vector& normal, std::size_t k, double max_radius,
                           const Visit& visit) const;

    std::size_t size() const { return photons_.size(); }    ///< photons that can be found
    std::uint64_t nonfinite() const { return nonfinite_; }  ///< photons left out
    std::uint64_t bytes() const { return bytes_; }          ///< most that photons, index and build held at once

    /// Smallest radius that float32 can still square with room to spare; unit box.
    static constexpr double minimum_radius = 1e-18;

private:
    using Index = flann::KDTreeSingleIndex<flann::L2_3D<float>>;

    void search(flann::ResultSet<float>& result, const Vector& position) const;

    /// Fills `neighbours` with the (at most) k nearest accepted photons, nearest first.
    void find_nearest(const Vector& position, const Vector& normal, std::size_t k, double max_squared_radius,
                      std::vector<Neighbour>& neighbours) const;

    std::vector<Photon> photons_;   // in Morton order; the index points into it
    std::unique_ptr<Index> index_;  // none without photons
    std::uint64_t nonfinite_ = 0;
    std::uint64_t bytes_ = 0;
};

// ---------------------------------------------------------------------------------------------------------------------
// How a query is answered.

/// In double and exact to its last bits: FLANN's float distance only decides what is worth a look.
inline double squared_distance_between(const Vector& a, const Vector& b) {
    return (VectorD(a) - VectorD(b)).length2();
}

/// The bound that FLANN is given: it keeps a point, or enters a cell, when its float d^2 is below. Wider than r^2 by
/// more than float can err in d^2 and in the sum over a descent, so that nothing at the rim is lost; the exact test
/// follows.
inline float pruning_bound(double squared_radius) {
    const double floored = std::max(squared_radius, PhotonMap::minimum_radius * PhotonMap::minimum_radius);
    return static_cast<float>(std::min(floored * (1.0 + 1e-5), static_cast<double>(std::numeric_limits<float>::max())));
}

/// What FLANN's search calls for each point below the bound; sums happen inside `visit`, nothing is stored.
template <typename Visit>
class RadiusVisitor : public flann::ResultSet<float> {
public:
    RadiusVisitor(const std::vector<Photon>& photons, const Vector& position, const Vector& normal,
                  double squared_radius, const Visit& visit)
        : photons_(photons),
          position_(position),
          normal_(normal),
          squared_radius_(squared_radius),
          bound_(pruning_bound(squared_radius)),
          visit_(visit) {}

    bool full() const override { return true; }
    float worstDist() const override { return bound_; }
    void addPoint(float, std::size_t index) override {
        const Photon& photon = photons_[index];
        const double squared_distance = squared_distance_between(photon.position, position_);
        if (squared_distance <= squared_radius_ && is_accepted(photon, normal_)) visit_(photon, squared_distance);
    }

private:
    const std::vector<Photon>& photons_;
    const Vector position_;
    const Vector normal_;
    const double squared_radius_;
    const float bound_;
    const Visit& visit_;
};

template <typename Visit>
void PhotonMap::within(const Vector& position, const Vector& normal, double radius, const Visit& visit) const {
    const double floored = std::max(radius, minimum_radius);
    RadiusVisitor<Visit> visitor(photons_, position, normal, floored * floored, visit);
    search(visitor, position);
}

template <typename Visit>
NearestPhotons PhotonMap::nearest(const Vector& position, const Vector& normal, std::size_t k, double max_radius,
                                  const Visit& visit) const {
    const double floored = std::max(max_radius, minimum_radius);
    NearestPhotons result{0, floored * floored};

    // One buffer a thread, so that queries do not allocate. It is borrowed, not shared: `visit` may ask the map again.
    thread_local std::vector<Neighbour> spare;
    std::vector<Neighbour> neighbours = std::move(spare);
    find_nearest(position, normal, k, result.squared_radius, neighbours);

    result.found = neighbours.size();
    std::size_t carrying = neighbours.size();
    if (k > 0 && neighbours.size() == k) {
        // Photons at one and the same position would make this 0, and it is about to be divided by.
        result.squared_radius = std::max(neighbours.back().squared_distance, minimum_radius * minimum_radius);
        --carrying;
    }
    for (std::size_t i = 0; i < carrying; ++i)
        visit(photons_[neighbours[i].index], neighbours[i].squared_distance, result.squared_radius);
    spare = std::move(neighbours);
    return result;
}

}  // namespace photonlab
