// The order in which photons lie in memory: along a Morton curve through them, so that neighbours in the list are
// mostly neighbours in space. What is built over them is built faster, and what is searched is read in runs.

#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "transport/light/photons.h"

namespace photonlab {

/// Sorts the photons, all of them at positions that float can square, in place. Those that share a place of the curve
/// follow a finer one of their own: a caustic may be smaller than a cell of the scene. Ties stay in their order. The
/// notes stay with their photons.
void sort_along_curve(std::vector<Photon>& photons, PhotonNotes& notes);

/// Held at once beside each photon while they are sorted.
inline constexpr std::size_t part_bytes_of_photon = 16;
inline constexpr std::uint64_t sort_bytes_per_photon = sizeof(std::uint64_t) + part_bytes_of_photon;

}  // namespace photonlab
