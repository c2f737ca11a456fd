// What the benchmarks measure on: the Cornell box at 256 x 256, passes of 100,000 paths, initial radius 5.55, seed 1.
// Early is the first pass, late the 64th, when the radii of hit points have spread over a factor of ten and more.

#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "gather/map/photon_map.h"
#include "integrators/integrator.h"
#include "integrators/settings/settings.h"
#include "scene/scene.h"
#include "transport/camera/camera_pass.h"
#include "transport/light/photons.h"

namespace photonlab::benchmarks {

inline constexpr std::uint64_t seed = 1;
inline constexpr std::uint64_t late_pass = 64;

/// The scene, its camera pass, and the photons and queries of two passes of PPM.
struct Work {
    Scene scene;
    HitPoints hit_points;
    MethodSettings method;
    std::vector<Photon> photons[2];       ///< early, late; in path order
    std::vector<GatherQuery> queries[2];  ///< one a hit point, with its radius in that pass, in the order of search
};

/// Made at the first call.
const Work& work();

PhotonPass trace_pass(std::uint64_t pass);

/// What a query finds: enough to tell whether two ways of searching agree.
struct Found {
    std::uint64_t photons = 0;
    ColorD power = ColorD(0.0);

    void add(const Photon& photon) {
        ++photons;
        power += ColorD(photon.power);
    }
};

/// What is wrong when the answers differ: another number of photons anywhere, or sums that rounding does not explain.
std::optional<std::string> difference(const std::vector<Found>& ours, const std::vector<Found>& theirs);

}  // namespace photonlab::benchmarks
