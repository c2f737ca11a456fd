// The gather layer: photons in a k-d tree of FLANN, asked by position, normal and radius.
//
// Photons are sorted along a Morton curve before the build, which makes build and search together 1.4 to 3 times cheaper,
// and FLANN's own recursive search calls a visitor, so sums happen in place and every query has its own radius. FLANN
// squares radii, excludes the rim, crashes on an empty set and loses photons of *other* queries when one is NaN: the
// guards against each are here and nowhere else.
//
// A photon is found when it passes the geometric tests, whatever its BRDF value: distance at most the radius, arrived on
// the side of the query's normal, its own normal within 60 degrees of that normal.
//
// [Jensen 2001, chapter 5: the photon map; Muja & Lowe 2009: FLANN]

#pragma once

#include <cstdint>
#include <memory>
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
    std::size_t found = 0;           ///< accepted photons within the maximum radius, at most k
    double squared_radius = 0.0;     ///< of the disc to divide by: to the k-th photon, or the maximum when fewer than k were found
};

class PhotonMap {
public:
    /// Sorts and indexes the photons; single-threaded, the same result always. Photons with a non-finite position are left
    /// out and counted.
    explicit PhotonMap(std::vector<Photon> photons);
    ~PhotonMap();
    PhotonMap(PhotonMap&&) noexcept;
    PhotonMap& operator=(PhotonMap&&) noexcept;

    /// Calls `visit(const Photon&, float squared_distance)` for every accepted photon with distance <= radius (unit box),
    /// in an order that depends on the photons alone. A radius below minimum_radius is taken as that.
    template <typename Visit>
    void within(const Vector& position, const Vector& normal, double radius, const Visit& visit) const;

    /// Finds the k nearest accepted photons within `max_radius` and calls `visit` for those that carry flux: all of them when
    /// fewer than k were found; else all but the k-th, which sets the radius and carries none (theory.md, section 4).
    template <typename Visit>
    NearestPhotons nearest(const Vector& position, const Vector& normal, std::size_t k, double max_radius,
                           const Visit& visit) const;

    std::size_t size() const;             ///< photons that can be found
    std::uint64_t nonfinite() const;      ///< photons left out
    std::uint64_t bytes() const;          ///< photons, index, and buffers at their largest during the build

    /// Smallest radius that can be told from 0 after squaring in float32 with room to spare; unit box.
    static constexpr double minimum_radius = 1e-18;
};

}  // namespace photonlab
