// The gather layer: the photons around a surface point, asked for by position, normal and radius.
//
// A photon is found when it passes the geometric tests, whatever its BRDF value: distance at most the radius, arrived
// on the side of the query's normal, its own normal within 60 degrees of that normal.
//
// The search is compiled once, in photon_map.cpp: photons are sorted along a Morton curve and taken in groups of up to
// 16 neighbours, whose centres FLANN's trees hold. What it finds comes back in runs of a thousand, and the caller's own
// visitor, inlined here, sees each photon of a run.
//
// [Jensen 2001, "Realistic Image Synthesis Using Photon Mapping", chapter 5]

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "core/math.h"
#include "transport/light/photons.h"

namespace photonlab {

/// At an interface that spreads what arrives on either side, as rough glass does: the side of the shape that lies
/// beyond, as seen from the viewer. A photon counts that arrived there, or on the viewer's side; not one on another
/// face that happens to lie near, whose inside and outside are the other way around. At other surfaces nothing beyond
/// counts.
enum class Beyond : std::uint8_t { Nothing, Front, Back };

/// A surface point that asks for photons.
struct GatherQuery {
    Vector position;
    Vector normal;  ///< unit, facing the viewer
    double radius;  ///< unit box
    Beyond beyond = Beyond::Nothing;
};

/// What of a photon decides whether it counts at a surface point.
struct PhotonSide {
    Vector incoming;  ///< length between 0.5 and 1
    Vector normal;    ///< likewise
    float least;      ///< 60 degrees: half the length of `normal`
    bool from_back;

    explicit PhotonSide(const Photon& photon)
        : incoming(photon.incoming.unnormalized()),
          normal(photon.normal.unnormalized()),
          least(0.5f * std::sqrt(normal.length2())),
          from_back(photon.from_back != 0) {}

    bool is_accepted_at(const GatherQuery& query) const {
        const float along = incoming.dot(query.normal);
        const float facing = normal.dot(query.normal);
        if (query.beyond == Beyond::Nothing) return along > 0.0f && facing > least;
        const bool lies_beyond = from_back == (query.beyond == Beyond::Back);
        return lies_beyond ? along < 0.0f && facing < -least : along > 0.0f && facing > least;
    }
};

/// In double and exact to its last bits: FLANN's float distance only decides what is worth a look.
inline double squared_distance_between(const Vector& a, const Vector& b) {
    return (VectorD(a) - VectorD(b)).length2();
}

/// A photon that counts at a query.
struct FoundPhoton {
    double squared_distance;
    std::uint32_t photon;  ///< index into the map's photons
    std::uint32_t query;   ///< index into the queries that were asked together
};

/// Answer of PhotonMap::nearest().
struct NearestPhotons {
    std::size_t found = 0;        ///< accepted photons within the maximum radius, at most k
    double squared_radius = 0.0;  ///< of the disc to divide by: the k-th photon's, or the maximum when fewer were found
};

class GroupSearch;

/// All queries are const and may run concurrently; none depends on the thread that asks. A query point that is not
/// finite, or farther out than largest_length, finds nothing.
///
/// `eps`, finite and at least 0, is exactness for speed, as FLANN's is: nothing within radius / sqrt(1 + eps) is
/// missed, beyond it what is in groups that lie there wholly; of k nearest photons, farther ones take the places of
/// those. 0 is exact.
class PhotonMap {
public:
    /// Sorts and indexes the photons, the same always: on one thread, or with those that wait in a parallel loop around
    /// it. Photons whose position is not finite (or so far out that float32 cannot square it) are left out and counted.
    explicit PhotonMap(std::vector<Photon> photons, PhotonNotes notes = {});
    PhotonMap(PhotonMap&&) noexcept;
    PhotonMap& operator=(PhotonMap&&) noexcept;
    ~PhotonMap();

    /// Calls `visit(const Photon&, double squared_distance)` for every accepted photon with distance <= radius (unit
    /// box), in an order that depends on the photons and the query alone. A radius below minimum_radius is taken as
    /// that.
    template <typename Visit>
    void within(const Vector& position, const Vector& normal, double radius, const Visit& visit) const {
        within_each({{position, normal, radius}},
                    [&](std::size_t, const Photon& photon, double squared) { visit(photon, squared); });
    }

    /// within() for many queries: `visit(std::size_t query, const Photon&, double squared_distance)`. Queries that
    /// follow each other and lie together are answered by one search, so a coherent order is worth twice the speed;
    /// which photons are found does not depend on it. With `eps` above 0 each is searched alone.
    template <typename Visit>
    void within_each(const std::vector<GatherQuery>& queries, const Visit& visit, double eps = 0.0) const {
        find_within(queries, eps, [&](std::span<const FoundPhoton> run) {
            for (const FoundPhoton& found : run) visit(found.query, photons_[found.photon], found.squared_distance);
        });
    }

    /// Finds the k nearest accepted photons within `max_radius`, then calls `visit(const Photon&, double
    /// squared_distance, double squared_radius)`, nearest first, for those that carry flux: all of them when fewer than
    /// k were found; else all but the k-th, which sets the radius and carries none (docs/theory.md, section 4).
    template <typename Visit>
    NearestPhotons nearest(const Vector& position, const Vector& normal, std::size_t k, double max_radius,
                           const Visit& visit, double eps = 0.0) const {
        return nearest({position, normal, max_radius}, k, visit, eps);
    }
    template <typename Visit>
    NearestPhotons nearest(const GatherQuery& query, std::size_t k, const Visit& visit, double eps = 0.0) const {
        return find_nearest(query, k, eps, [&](std::span<const FoundPhoton> carrying, double squared_radius) {
            for (const FoundPhoton& found : carrying)
                visit(photons_[found.photon], found.squared_distance, squared_radius);
        });
    }

    /// Of a photon that was found here: its place in the map, below size(), and in the notes.
    std::size_t index_of(const Photon& photon) const { return static_cast<std::size_t>(&photon - photons_.data()); }
    const PhotonNotes& notes() const { return notes_; }           ///< in the order of the map
    std::span<const Photon> photons() const { return photons_; }  ///< likewise, those that can be found

    std::size_t size() const { return photons_.size(); }    ///< photons that can be found
    std::uint64_t nonfinite() const { return nonfinite_; }  ///< photons left out
    std::uint64_t bytes() const { return bytes_; }          ///< most that photons, index and build held at once

    /// Smallest radius that float32 can still square with room to spare; unit box.
    static constexpr double minimum_radius = 1e-18;

private:
    // Called once a run, not once a photon; what is bound above fits into them without an allocation.
    using TakeRun = std::function<void(std::span<const FoundPhoton>)>;
    using TakeNearest = std::function<void(std::span<const FoundPhoton>, double squared_radius)>;

    void find_within(const std::vector<GatherQuery>& queries, double eps, const TakeRun& take) const;

    /// The query's radius is the largest. Calls `take` at most once, with those that carry flux.
    NearestPhotons find_nearest(const GatherQuery& query, std::size_t k, double eps, const TakeNearest& take) const;

    std::vector<Photon> photons_;  // in Morton order
    PhotonNotes notes_;
    std::unique_ptr<const GroupSearch> search_;  // over them; none without photons
    std::uint64_t nonfinite_ = 0;
    std::uint64_t bytes_ = 0;
};

}  // namespace photonlab
