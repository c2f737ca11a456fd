// How much memory runs will take, before they are started, and how much there is.
//
// Hit points are counted by a camera of at most 64 x 64 pixels with the same view, so that what mirrors and glass split
// is in it; photons by 10,000 paths. Both are scaled, and a tenth is added: the estimate is
// above what is taken, by up to a factor of two.

#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "experiment/runner.h"

namespace photonlab {

/// Mebibytes, at the largest.
struct MemoryEstimate {
    double program = 0.0;     ///< what it holds now: the scene
    double hit_points = 0.0;  ///< with their statistics, of all methods together
    double photons = 0.0;     ///< and the maps over them
    double images = 0.0;      ///< being made, judged, kept and written

    double total() const { return program + hit_points + photons + images; }
};

/// Of methods that run together; `kept_images` are held by each until its end.
MemoryEstimate estimate_memory(const Scene& scene, int samples_per_pixel, const std::vector<RunSettings>& together,
                               std::size_t kept_images);

/// Mebibytes that this process can still have: of the machine, of its control group, of its own limit.
double available_mebibytes();

/// "up to 812 MiB (scene 30, hit points 410, photons 250, images 122) of 7421 MiB available"
std::string describe(const MemoryEstimate& estimate);

/// Throws InputError with the numbers when it cannot fit.
void require_memory(const std::string& what, const MemoryEstimate& estimate);

}  // namespace photonlab
