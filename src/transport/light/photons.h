// The photon pass: paths from the lights, leaving a photon wherever they meet a surface that can be gathered at.
//
// Paths are made in blocks that are joined in path order, and every path draws from a random stream of its own, so the
// photons of a pass are the same, in the same order, at any thread count.
//
// [Jensen 2001, "Realistic Image Synthesis Using Photon Mapping", chapters 4 and 5]

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/math.h"
#include "core/packed_direction.h"
#include "core/random.h"
#include "scene/scene.h"

namespace photonlab {

/// 32 bytes. Position and power are exact. The direction is off by 6.5e-5 radians at most, which is less than a BRDF
/// here can change over; the normal, which only decides whether a photon counts at a hit point, by one degree.
struct Photon {
    Vector position;
    Color power;  ///< flux that one emitted path carries here, relative to Scene::total_power; not divided by the
                  ///< number of paths; times |incoming.normal| / |incoming.geometric normal| (Veach 1996), with the
                  ///< normal below
    PackedDirection incoming;  ///< towards where the photon came from
    CoarseDirection normal;    ///< gather_normal() on the side on which the photon arrived
    std::uint16_t edges : 14;  ///< edges of the path from the light to here; 1 when it came straight from the light
    std::uint16_t from_back : 1 = 0;  ///< 1: it arrived on the inside of the shape
    std::uint16_t caustic : 1 = 0;    ///< 1: it came from the light by specular surfaces alone, and by at least one
};
static_assert(sizeof(Photon) == 32);

/// What only some methods want of photons: a number each, in their order, or none.
struct PhotonNotes {
    std::vector<std::uint32_t> path = {};          ///< its path, counted from 0: where emission learns
    std::vector<std::uint32_t> multiplicity = {};  ///< how often it counts: where paths repeat
};

/// How the Markov chains of a pass went (visible_paths.h).
struct ChainReport {
    std::optional<double> accepted = std::nullopt;  ///< share of mutations; empty: there were none
    double step_size = 1.0;                         ///< of the pass
};

/// Photons of one pass, or of several passes joined.
struct PhotonPass {
    std::vector<Photon> photons;  ///< in path order
    PhotonNotes notes = {};
    std::vector<std::uint32_t> cell = {};  ///< in which each path began, where emission learns (emission_map.h)
    std::uint64_t paths_emitted = 0;
    std::uint64_t paths_traced = 0;  ///< to find these; more than emitted where some are tried in vain
    double seen_share = 1.0;         ///< of the paths emitted, that these photons are of: b of visible_paths.h
    std::optional<ChainReport> chains = std::nullopt;
    std::uint64_t paths_cut = 0;  ///< ended at largest_path_edges
    double power_cut = 0.0;       ///< what those still carried: mean channel, relative, summed over paths
    std::uint64_t nonfinite = 0;  ///< photons refused for a non-finite position, direction or power
};

/// Adds the photons of a part of a pass, behind those that are there, with what was noted of its paths and left out of
/// them. How many paths there were is the caller's to say.
void append(PhotonPass& all, const PhotonPass& part);

/// Where the numbers come from by which light is emitted. All others are independent.
enum class EmissionNumbers {
    Independent,
    SobolOfAllPasses,  ///< one sequence (core/sobol.h), over the paths of all passes in order
    SobolOfPass,       ///< a sequence of each pass's own
};

struct PhotonSettings {
    std::uint64_t paths = 100'000;  ///< emitted a pass
    std::uint64_t seed = 1;
    int max_depth = -1;         ///< edges from camera to light, as in Mitsuba; a photon's own edges stay below it
    bool store_direct = false;  ///< also store photons that came straight from the light
    RandomPurpose purpose = RandomPurpose::PhotonPaths;  ///< a reference's half has its own
    EmissionNumbers emission = EmissionNumbers::Independent;

    bool operator==(const PhotonSettings&) const = default;
};

class EmissionMap;

/// Traces pass `pass` (counted from 1). A scene without light gives no photons and still counts its paths. With a map
/// light is emitted by what was learnt, and paths that carry nothing are not followed.
PhotonPass trace_photons(const Scene& scene, const PhotonSettings& settings, std::uint64_t pass, int threads,
                         const EmissionMap* learnt = nullptr);

}  // namespace photonlab
