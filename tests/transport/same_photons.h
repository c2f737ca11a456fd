// Whether two passes have left the same photons, to the bit.

#pragma once

#include <cstring>

#include "transport/light/photons.h"

namespace photonlab::test {

inline bool same_bits(const PhotonPass& a, const PhotonPass& b) {
    return a.photons.size() == b.photons.size() && a.paths_emitted == b.paths_emitted && a.paths_cut == b.paths_cut &&
           a.power_cut == b.power_cut && a.nonfinite == b.nonfinite &&
           (a.photons.empty() ||
            std::memcmp(a.photons.data(), b.photons.data(), a.photons.size() * sizeof(Photon)) == 0);
}

}  // namespace photonlab::test
