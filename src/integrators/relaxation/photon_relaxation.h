// Photons moved apart along the surfaces that they lie on, so that they lie evenly where light is even and discs of few
// photons are less noisy; and the flux that later photons bring to those that stay.
//
// With K = 6 neighbours at the offsets v_j (from a neighbour to the photon, in its tangent plane), r the distance of
// the farthest, and w_j the neighbour's flux over the mean of the K + 1:
//
//     force = 1/K sum_j w_j v_j (r / |v_j| - 1),    target = x + force / 2
//
// and from the target a ray finds the surface again. Flux that falls off, as at the rim of a caustic, would be pushed
// over its edge. So with features protected only that part of the force is followed which is across the gradient of the
// flux, where chance does not explain one: of n photons that lie evenly in a disc of radius R around x,
//
//     z^2 = 4 |sum_j w_j v_j|^2 / (R^2 sum_j w_j^2)
//
// is chi-square with two degrees of freedom, and 9.21 is its 99% point.
//
// [After Spencer & Jones 2009, "Into the Blue: Better Caustics through Photon Relaxation", and 2013, "Progressive
// Photon
//  Relaxation", of which the abstracts were read: the force, the test and all constants are ours.]

#pragma once

#include <optional>
#include <span>
#include <vector>

#include "gather/map/photon_map.h"
#include "scene/scene.h"

namespace photonlab {

inline constexpr std::size_t pushing_neighbours = 6;
inline constexpr std::size_t feature_neighbours = 48;  ///< by which a gradient is told from chance
inline constexpr double gradient_threshold = 9.210340371976184;

/// Of a photon.
struct Neighbour {
    VectorD offset;  ///< from the photon to it, in the photon's tangent plane
    double flux;     ///< above 0
};

/// `nearest`: the neighbours that push, nearest first; the last one only says how far they reach.
VectorD relaxation_force(std::span<const Neighbour> nearest, double own_flux);

/// The direction in which flux grows, unit, where it does so significantly among neighbours within `radius`.
std::optional<VectorD> significant_gradient(std::span<const Neighbour> neighbours, double radius);

struct RelaxationSettings {
    int steps = 10;
    bool protects_features = true;
};

/// The photons of the map after `settings.steps` steps; each keeps its power. One that moved has its incoming direction
/// along its normal: it stands for light from all. A move that ends on no surface of nearly the same normal is not
/// made.
PhotonMap relaxed(const Scene& scene, const PhotonMap& map, const RelaxationSettings& settings, int threads);

/// Adds the power of each of `photons` to the sum of the nearest of `primal` whose normal agrees; `sums` has one for
/// each, in the order of the map. Photons that find none are left out; returns how many.
std::uint64_t add_to_nearest(const PhotonMap& primal, const PhotonMap& photons, int threads, std::vector<ColorD>& sums);

/// The same photons with the power sum / paths each. They stand for light of paths of every length, and count at every
/// hit point.
PhotonMap with_power(const PhotonMap& primal, const std::vector<ColorD>& sums, double paths);

}  // namespace photonlab
