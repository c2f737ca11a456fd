// Photons laid by hand on a square floor, even or brighter on one side, and how evenly they lie.

#pragma once

#include <cmath>
#include <vector>

#include "core/random.h"
#include "gather/map/photon_map.h"
#include "tests/statistical/scenes.h"

namespace photonlab::test {

inline constexpr double half_square = 5.0;  ///< photons lie in |x|, |z| < this, scene units

inline Scene floor_for_photons() {
    SceneDescription description = floor_seen_at_origin(Color(0.5f));
    description.lights = {point_light(VectorD(0.0, 50.0, 0.0), ColorD(1.0))};
    return build_scene(description);
}

/// Of power 1, straight from above, at a place in scene units.
inline Photon photon_on_floor(const Scene& scene, const VectorD& place, std::uint16_t edges) {
    Photon photon{};
    photon.position = Vector((place - scene.centre) / scene.unit_length);
    photon.power = Color(1.0f);
    photon.incoming = PackedDirection(Vector(0, 1, 0));
    photon.normal = CoarseDirection(Vector(0, 1, 0));
    photon.edges = edges & 0x3fffu;
    return photon;
}

/// `brighter` times as many a unit of area where x < 0 as where x > 0.
inline std::vector<Photon> lay_photons(const Scene& scene, std::size_t count, double brighter, std::uint64_t seed) {
    RandomStream random(seed, RandomPurpose::Test, 0, 0);
    std::vector<Photon> photons;
    while (photons.size() < count) {
        const bool is_bright = random.next_double() * (1.0 + brighter) < brighter;
        const double x = half_square * random.next_double() * (is_bright ? -1.0 : 1.0);
        const double z = half_square * (2.0 * random.next_double() - 1.0);
        photons.push_back(photon_on_floor(scene, {x, 0.0, z}, 1));
    }
    return photons;
}

inline VectorD place_of(const Scene& scene, const Photon& photon) {
    return VectorD(photon.position) * scene.unit_length + scene.centre;
}

/// Variance of the counts in discs where `expected` photons of an even square are expected, well within it.
inline double count_variance(const Scene& scene, const PhotonMap& map, double expected) {
    const double radius = 2.0 * half_square * std::sqrt(expected / (pi * static_cast<double>(map.size())));
    RandomStream random(7, RandomPurpose::Test, 1, 0);
    double sum = 0.0;
    double squares = 0.0;
    constexpr int probes = 4000;
    for (int probe = 0; probe < probes; ++probe) {
        const double x = 0.7 * half_square * (2.0 * random.next_double() - 1.0);
        const double z = 0.7 * half_square * (2.0 * random.next_double() - 1.0);
        double count = 0.0;
        map.within(Vector((VectorD(x, 0.0, z) - scene.centre) / scene.unit_length), Vector(0, 1, 0),
                   radius / scene.unit_length, [&](const Photon&, double) { count += 1.0; });
        sum += count;
        squares += count * count;
    }
    return squares / probes - sum / probes * (sum / probes);
}

/// Photons in the strip beyond the edge that is a fiftieth of the square wide.
inline double beyond_the_edge(const Scene& scene, const PhotonMap& map) {
    double count = 0.0;
    for (const Photon& photon : map.photons()) {
        const VectorD place = place_of(scene, photon);
        if (place.x > 0.0 && place.x < half_square / 25.0 && std::abs(place.z) < 0.9 * half_square) count += 1.0;
    }
    return count;
}

}  // namespace photonlab::test
