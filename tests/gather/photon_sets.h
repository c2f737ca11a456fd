// Sets of photons that a search may stumble over, and what brute force finds in them.
//
// A photon's number is kept in `power`, so that an answer can be compared photon by photon. Distances here and in the
// map are both exact to the last bits of a double, so even the rim has one right answer.

#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "core/random.h"
#include "gather/map/photon_map.h"

namespace photonlab {

inline const Vector up(0.0f, 0.0f, 1.0f);
inline const Vector sideways(1.0f, 0.0f, 0.0f);

inline Photon photon_at(const Vector& position, std::size_t number, const Vector& normal = up,
                        const Vector& incoming = up) {
    return {.position = position,
            .power = Color(static_cast<float>(number)),
            .incoming = PackedDirection(incoming),
            .normal = CoarseDirection(normal),
            .edges = 1};
}

inline std::uint32_t number_of(const Photon& photon) {
    return static_cast<std::uint32_t>(photon.power.x);
}

inline Vector random_point(RandomStream& random, float size) {
    const float x = random.next() - 0.5f;
    const float y = random.next() - 0.5f;
    return Vector(x, y, random.next() - 0.5f) * size;
}

/// Photons of which some are rejected: by their normal, by the side they came from, or not at all.
inline Photon random_photon(RandomStream& random, const Vector& position, std::size_t number) {
    const float kind = random.next();
    if (kind < 0.2f) return photon_at(position, number, sideways, Vector(0.6f, 0.0f, 0.8f));
    if (kind < 0.4f) return photon_at(position, number, up, Vector(0.0f, 0.6f, -0.8f));
    return photon_at(position, number);
}

struct PhotonSet {
    std::string name;
    std::vector<Photon> photons;
};

template <typename Position>
PhotonSet photon_set(const std::string& name, std::size_t count, const Position& position) {
    PhotonSet set{name, {}};
    RandomStream random(1, RandomPurpose::Test, 0, std::accumulate(name.begin(), name.end(), std::uint64_t{0}));
    for (std::size_t i = 0; i < count; ++i) {
        const Vector at = position(random, i);
        set.photons.push_back(random_photon(random, at, i));
    }
    return set;
}

inline std::vector<PhotonSet> photon_sets() {
    std::vector<PhotonSet> sets;
    sets.push_back({"none", {}});
    sets.push_back({"one", {photon_at(Vector(0.25f, -0.125f, 0.5f), 0)}});
    sets.push_back(
        photon_set("random", 3000, [](RandomStream& random, std::size_t) { return random_point(random, 1.0f); }));
    sets.push_back(photon_set("dense patch", 3000, [](RandomStream& random, std::size_t i) {
        return i % 3 == 0 ? random_point(random, 1.0f) : Vector(0.2f, 0.1f, 0.0f) + random_point(random, 1e-4f);
    }));
    sets.push_back(photon_set("tiny patch at the origin", 1000, [](RandomStream& random, std::size_t i) {
        return i % 3 == 0 ? random_point(random, 1.0f) : random_point(random, 4e-12f);
    }));
    // Of several tiers, and denser than the cells of one Morton curve.
    sets.push_back(photon_set("caustic in a caustic", 30'000, [](RandomStream& random, std::size_t i) {
        const float sizes[] = {1.0f, 1.0f, 1e-2f, 1e-4f};
        return Vector(0.1f, 0.2f, 0.3f) + random_point(random, sizes[i % 4]);
    }));
    sets.push_back(photon_set("collinear", 1000, [](RandomStream& random, std::size_t) {
        return Vector(1.0f, 2.0f, -0.5f) * (0.4f * (random.next() - 0.5f));
    }));
    sets.push_back(photon_set("flat", 2000, [](RandomStream& random, std::size_t) {
        Vector point = random_point(random, 1.0f);
        point.z = 0.25f;
        return point;
    }));
    sets.push_back(photon_set("identical", 500, [](RandomStream&, std::size_t) { return Vector(0.1f, 0.2f, 0.3f); }));
    sets.push_back(photon_set("lattice of 1/16", 17 * 17 * 17, [](RandomStream&, std::size_t i) {
        return Vector(static_cast<float>(i % 17), static_cast<float>(i / 17 % 17), static_cast<float>(i / 289)) *
                   0.0625f -
               Vector(0.5f);
    }));
    return sets;
}

/// Query points: on photons, between them, on the lattice, and outside.
inline std::vector<Vector> query_points(const PhotonSet& set) {
    std::vector<Vector> points{Vector(0.0f), Vector(0.1f, 0.2f, 0.3f), Vector(0.0625f, -0.125f, 0.25f),
                               Vector(3.0f, -2.0f, 1.0f)};
    RandomStream random(2, RandomPurpose::Test, 0, 0);
    for (int i = 0; i < 6; ++i) points.push_back(random_point(random, 1.1f));
    for (int i = 0; i < 6 && !set.photons.empty(); ++i)
        points.push_back(
            set.photons[static_cast<std::size_t>(random.next_double() * static_cast<double>(set.photons.size()))]
                .position);
    return points;
}

inline double squared_distance(const Vector& a, const Vector& b) {
    const double x = static_cast<double>(a.x) - b.x;
    const double y = static_cast<double>(a.y) - b.y;
    const double z = static_cast<double>(a.z) - b.z;
    return x * x + y * y + z * z;
}

inline bool accepted(const Photon& photon, const Vector& normal) {
    return photon.incoming.unit().dot(normal) > 0.0f && photon.normal.unit().dot(normal) > 0.5f;
}

inline std::vector<std::uint32_t> numbers_within(const PhotonMap& map, const Vector& position, const Vector& normal,
                                                 double radius) {
    std::vector<std::uint32_t> numbers;
    map.within(position, normal, radius, [&](const Photon& photon, double d_squared) {
        numbers.push_back(number_of(photon));
        EXPECT_NEAR(d_squared, squared_distance(photon.position, position), 1e-15 * d_squared);
    });
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

inline std::vector<std::uint32_t> numbers_by_brute_force(const std::vector<Photon>& photons, const Vector& position,
                                                         const Vector& normal, double radius) {
    std::vector<std::uint32_t> numbers;
    for (const Photon& photon : photons)
        if (squared_distance(photon.position, position) <= radius * radius && accepted(photon, normal))
            numbers.push_back(number_of(photon));
    std::sort(numbers.begin(), numbers.end());
    return numbers;
}

inline std::size_t count_within(const PhotonMap& map, const Vector& position, const Vector& normal, double radius) {
    return numbers_within(map, position, normal, radius).size();
}

}  // namespace photonlab
