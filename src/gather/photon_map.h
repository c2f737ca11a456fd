// The gather layer: photons in a k-d tree of FLANN, asked by position, normal and radius.
//
// Photons are sorted along a Morton curve and taken in groups of up to 16 neighbours, whose centres FLANN's trees hold,
// one tree for each tier of density: a map is made in half of the time that a tree of photons takes. FLANN's own
// recursive search calls a visitor, so sums happen in place and every query has its own radius. FLANN squares radii,
// excludes the rim, crashes on an empty set and loses photons of *other* queries when one is NaN: the guards against
// each are here and nowhere else.
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
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "core/math.h"
#include "core/morton.h"
#include "gather/photon_groups.h"
#include "transport/photons.h"

namespace photonlab {

/// What of a photon decides whether it counts at a surface point.
struct PhotonSide {
    Vector incoming;  ///< length between 0.5 and 1
    Vector normal;    ///< likewise
    float least;      ///< 60 degrees: half the length of `normal`

    explicit PhotonSide(const Photon& photon)
        : incoming(photon.incoming.unnormalized()),
          normal(photon.normal.unnormalized()),
          least(0.5f * std::sqrt(normal.length2())) {}

    /// `surface_normal` is unit and faces the viewer.
    bool is_accepted_at(const Vector& surface_normal) const {
        return incoming.dot(surface_normal) > 0.0f && normal.dot(surface_normal) > least;
    }
};

inline bool is_accepted(const Photon& photon, const Vector& normal) {
    return PhotonSide(photon).is_accepted_at(normal);
}

/// A surface point that asks for photons.
struct GatherQuery {
    Vector position;
    Vector normal;  ///< unit, facing the viewer
    double radius;  ///< unit box
};

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

/// All queries are const and may run concurrently; none depends on the thread that asks. A query point that is not
/// finite, or farther out than largest_length, finds nothing.
///
/// `eps`, finite and at least 0, is exactness for speed, as FLANN's is: nothing within radius / sqrt(1 + eps) is
/// missed, beyond it what is in groups that lie there wholly; of k nearest photons, farther ones take the places of
/// those. 0 is exact.
class PhotonMap {
public:
    /// Sorts and indexes the photons; single-threaded, the same result always. Photons whose position is not finite (or
    /// so far out that float32 cannot square it) are left out and counted.
    explicit PhotonMap(std::vector<Photon> photons);
    PhotonMap(PhotonMap&&) = default;
    PhotonMap& operator=(PhotonMap&&) = default;

    /// Calls `visit(const Photon&, double squared_distance)` for every accepted photon with distance <= radius (unit
    /// box), in an order that depends on the photons and the query alone. A radius below minimum_radius is taken as
    /// that.
    template <typename Visit>
    void within(const Vector& position, const Vector& normal, double radius, const Visit& visit) const;

    /// within() for many queries: `visit(std::size_t query, const Photon&, double squared_distance)`. Queries that
    /// follow each other and lie together are answered by one search, so a coherent order is worth twice the speed;
    /// which photons are found does not depend on it. With `eps` above 0 each is searched alone, as eps says below.
    template <typename Visit>
    void within_each(const std::vector<GatherQuery>& queries, const Visit& visit, double eps = 0.0) const;

    /// Finds the k nearest accepted photons within `max_radius`, then calls `visit(const Photon&, double
    /// squared_distance, double squared_radius)`, nearest first, for those that carry flux: all of them when fewer than
    /// k were found; else all but the k-th, which sets the radius and carries none (theory.md, section 4).
    template <typename Visit>
    NearestPhotons nearest(const Vector& position, const Vector& normal, std::size_t k, double max_radius,
                           const Visit& visit, double eps = 0.0) const;

    std::size_t size() const { return photons_.size(); }    ///< photons that can be found
    std::uint64_t nonfinite() const { return nonfinite_; }  ///< photons left out
    std::uint64_t bytes() const { return bytes_; }          ///< most that photons, index and build held at once

    /// Smallest radius that float32 can still square with room to spare; unit box.
    static constexpr double minimum_radius = 1e-18;

private:
    using Index = flann::KDTreeSingleIndex<flann::L2_3D<float>>;

    /// Hands `sink` every photon of the groups that reach into its ball; see GroupVisitor.
    template <typename Sink>
    void search(const Vector& centre, double eps, Sink& sink) const;

    /// Fills `neighbours` with the (at most) k nearest accepted photons, nearest first.
    void find_nearest(const Vector& position, const Vector& normal, std::size_t k, double max_squared_radius,
                      double eps, std::vector<Neighbour>& neighbours) const;

    std::vector<Photon> photons_;                  // in Morton order
    PhotonGroups groups_;                          // of them
    std::vector<std::unique_ptr<Index>> indices_;  // of the centres of each tier's groups
    std::uint64_t nonfinite_ = 0;
    std::uint64_t bytes_ = 0;
};

// ---------------------------------------------------------------------------------------------------------------------
// How a query is answered.

/// In double and exact to its last bits: FLANN's float distance only decides what is worth a look.
inline double squared_distance_between(const Vector& a, const Vector& b) {
    return (VectorD(a) - VectorD(b)).length2();
}

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

/// Queries that one search answers: at most 16, in a box whose half-diagonal is at most four of the largest radius, and
/// with radii that differ by a factor of two at most. Wider and narrower ones were slower, early and late.
class QueryCluster {
public:
    static constexpr std::size_t capacity = 16;

    /// The longest cluster from query `first` on, of at most `most` queries (1 to capacity).
    QueryCluster(const std::vector<GatherQuery>& queries, std::size_t first, std::size_t most) : first_(first) {
        Box box;
        double smallest = queries[first].radius;
        double largest = smallest;
        for (std::size_t i = first; i < queries.size() && count_ < most; ++i) {
            const GatherQuery& query = queries[i];
            box.include(query.position);
            smallest = std::min(smallest, query.radius);
            largest = std::max(largest, query.radius);
            const float squared_diagonal = box.squared_diagonal();
            const bool is_compact = std::isfinite(squared_diagonal) && squared_diagonal <= 64.0 * largest * largest &&
                                    largest <= 2.0 * smallest;
            if (count_ > 0 && !is_compact) break;
            x_[count_] = query.position.x;
            y_[count_] = query.position.y;
            z_[count_] = query.position.z;
            const double radius = std::max(query.radius, PhotonMap::minimum_radius);
            squared_radius_[count_] = radius * radius;
            ++count_;
            centre_ = (box.lower + box.upper) * 0.5f;
        }
        for (std::size_t i = count_; i < capacity; ++i) {
            x_[i] = y_[i] = z_[i] = 0.0;
            squared_radius_[i] = -1.0;
        }
        for (std::size_t i = 0; i < count_; ++i) {
            const double distance = (VectorD(x_[i], y_[i], z_[i]) - VectorD(centre_)).length();
            reach_ = std::max(reach_, distance + std::sqrt(squared_radius_[i]));
        }
    }

    std::size_t first() const { return first_; }
    std::size_t end() const { return first_ + count_; }
    const Vector& centre() const { return centre_; }
    double reach() const { return reach_; }  ///< from the centre, of the ball that holds all of theirs

    /// A bit for each query whose ball holds the position, the first query's lowest; fills their squared distances.
    std::uint64_t holding(const Vector& position, std::array<double, capacity>& squared_distance) const {
        // Straight-line code over all slots, so that the compiler does several at once.
        std::uint64_t inside = 0;  // as wide as a double: the compiler's vectors have lanes of one width
        for (std::size_t i = 0; i < capacity; ++i) {
            const double x = x_[i] - position.x;
            const double y = y_[i] - position.y;
            const double z = z_[i] - position.z;
            squared_distance[i] = x * x + y * y + z * z;
        }
        for (std::size_t i = 0; i < capacity; ++i)
            inside |= squared_distance[i] <= squared_radius_[i] ? std::uint64_t{1} << i : 0u;
        return inside;
    }

private:
    std::size_t first_;
    std::size_t count_ = 0;
    std::array<double, capacity> x_;
    std::array<double, capacity> y_;
    std::array<double, capacity> z_;
    std::array<double, capacity> squared_radius_;  // negative in a slot without query
    Vector centre_;
    double reach_ = 0.0;
};

/// What FLANN's search calls for each group whose centre is below the bound. A group is opened when its ball comes
/// within reach / sqrt(1 + eps) of the search's centre; its photons within reach go to the sink:
/// `bool take(const Vector& position, std::size_t index, const Photon&)`, true when `double reach() const` has shrunk
/// by it.
template <typename Sink>
class GroupVisitor : public flann::ResultSet<float> {
public:
    GroupVisitor(const std::vector<Photon>& photons, const PhotonGroups& groups, const GroupTier& tier,
                 const Vector& centre, double eps, Sink& sink)
        : photons_(photons),
          groups_(groups),
          tier_(tier),
          centre_(centre),
          opened_share_(1.0 / std::sqrt(1.0 + eps)),
          sink_(sink) {
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

template <typename Sink>
void PhotonMap::search(const Vector& centre, double eps, Sink& sink) const {
    if (!is_squarable(centre)) return;
    for (std::size_t tier = 0; tier < indices_.size(); ++tier) {
        GroupVisitor<Sink> visitor(photons_, groups_, groups_.tiers()[tier], centre, eps, sink);
        indices_[tier]->findNeighbors(visitor, &centre.x, flann::SearchParams());
    }
}

/// Calls `visit` for each query of the cluster that a photon counts at.
template <typename Visit>
class ClusterSink {
public:
    ClusterSink(const std::vector<GatherQuery>& queries, const QueryCluster& cluster, const Visit& visit)
        : queries_(queries), cluster_(cluster), visit_(visit) {}

    double reach() const { return cluster_.reach(); }
    bool take(const Vector& position, std::size_t, const Photon& photon) {
        std::array<double, QueryCluster::capacity> squared_distance;
        std::uint64_t inside = cluster_.holding(position, squared_distance);
        if (inside == 0) return false;
        const PhotonSide side(photon);
        for (; inside != 0; inside &= inside - 1) {
            const auto slot = static_cast<std::size_t>(std::countr_zero(inside));
            const std::size_t query = cluster_.first() + slot;
            if (side.is_accepted_at(queries_[query].normal)) visit_(query, photon, squared_distance[slot]);
        }
        return false;
    }

private:
    const std::vector<GatherQuery>& queries_;
    const QueryCluster& cluster_;
    const Visit& visit_;
};

template <typename Visit>
void PhotonMap::within_each(const std::vector<GatherQuery>& queries, const Visit& visit, double eps) const {
    // An inexact search of a cluster would take the photons of the queries at its edge: there, each is its own.
    const std::size_t most = eps > 0.0 ? 1 : QueryCluster::capacity;
    for (std::size_t first = 0; first < queries.size();) {
        const QueryCluster cluster(queries, first, most);
        ClusterSink<Visit> sink(queries, cluster, visit);
        search(cluster.centre(), eps, sink);
        first = cluster.end();
    }
}

template <typename Visit>
void PhotonMap::within(const Vector& position, const Vector& normal, double radius, const Visit& visit) const {
    within_each({{position, normal, radius}},
                [&](std::size_t, const Photon& photon, double squared_distance) { visit(photon, squared_distance); });
}

template <typename Visit>
NearestPhotons PhotonMap::nearest(const Vector& position, const Vector& normal, std::size_t k, double max_radius,
                                  const Visit& visit, double eps) const {
    const double floored = std::max(max_radius, minimum_radius);
    NearestPhotons result{0, floored * floored};

    // One buffer a thread, so that queries do not allocate. It is borrowed, not shared: `visit` may ask the map again.
    thread_local std::vector<Neighbour> spare;
    std::vector<Neighbour> neighbours = std::move(spare);
    find_nearest(position, normal, k, result.squared_radius, eps, neighbours);

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
