// Photons along a Morton curve: each once, neighbours next to each other, ties as they were.

#include "gather/map/photon_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/gather/photon_sets.h"

namespace photonlab {
namespace {

TEST(PhotonOrder, HoldsEveryPhotonOnce) {
    for (const PhotonSet& set : photon_sets()) {
        std::vector<Photon> sorted = set.photons;
        PhotonNotes none;
        sort_along_curve(sorted, none);
        ASSERT_EQ(sorted.size(), set.photons.size());
        std::vector<int> seen(sorted.size(), 0);
        for (const Photon& photon : sorted) {
            ++seen.at(number_of(photon));
            ASSERT_EQ(photon.position, set.photons[number_of(photon)].position) << set.name;
        }
        EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), static_cast<std::ptrdiff_t>(seen.size())) << set.name;
    }
}

TEST(PhotonOrder, LeavesThoseAtOnePointInTheirOrder) {
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < 5000; ++i)
        photons.push_back(photon_at(i % 2 == 0 ? Vector(0.1f, 0.2f, 0.3f) : Vector(0.7f, 0.2f, 0.3f), i));
    PhotonNotes none;
    sort_along_curve(photons, none);
    for (std::size_t i = 0; i < 2500; ++i) {
        ASSERT_EQ(number_of(photons[i]), 2 * i);
        ASSERT_EQ(number_of(photons[2500 + i]), 2 * i + 1);
    }
}

}  // namespace
}  // namespace photonlab
