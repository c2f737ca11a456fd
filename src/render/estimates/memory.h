// How much memory runs will take, before they are started.
//
// Hit points are counted in a coarse view (coarse_view.h), photons in 10,000 paths. Both are scaled, and a tenth is
// added: the estimate is above what is taken, by up to a factor of two.

#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <tuple>
#include <vector>

#include "render/pass_loop.h"

namespace photonlab {

/// Mebibytes, at the largest.
struct MemoryEstimate {
    double program = 0.0;     ///< what it holds now: the scene
    double hit_points = 0.0;  ///< with their statistics, of all methods together
    double photons = 0.0;     ///< and the maps over them
    double images = 0.0;      ///< being made, judged, kept and written

    double total() const { return program + hit_points + photons + images; }
};

/// Estimates for runs of one scene, which it counts once.
class MemoryEstimator {
public:
    MemoryEstimator(const Scene& scene, int samples_per_pixel) : scene_(scene), samples_per_pixel_(samples_per_pixel) {}

    /// Of methods that run together; `kept_images` are held by each until its end.
    MemoryEstimate of(const std::vector<RunSettings>& together, std::size_t kept_images);

private:
    struct HitPointSize {
        double count = 0.0;
        double bytes_each = 0.0;  ///< once it is stored
    };
    /// Of the photons of a pass.
    struct PhotonSize {
        double photon_bytes = 0.0;
        double map_bytes = 0.0;
    };
    const HitPointSize& hit_point_size(double branch_cutoff);
    const PhotonSize& photon_size(const RunSettings& settings);
    double photon_bytes(const std::vector<RunSettings>& together);

    const Scene& scene_;
    const int samples_per_pixel_;
    std::map<double, HitPointSize> hit_points_;                                 // by cutoff
    std::map<std::tuple<std::uint64_t, int, DirectMode>, PhotonSize> photons_;  // by paths, depth, what is stored
};

/// "up to 812 MiB (scene 30, hit points 410, photons 250, images 122) of 7421 MiB that the machine leaves"; what the
/// program holds already is in both.
std::string describe(const MemoryEstimate& estimate);

/// Throws InputError with the numbers when it cannot fit.
void require_memory(const std::string& what, const MemoryEstimate& estimate);

}  // namespace photonlab
