// The layers that the loop over passes makes, whatever the method: emission, which the camera sees by mirrors and glass
// alone, and direct light, sampled by shadow rays at the hit points in every pass and averaged over passes.
//
// Where hit points are the same in every pass, sums are kept at the points; where they are new, in pixels.

#pragma once

#include <cstdint>
#include <vector>

#include "core/files/state_archive.h"
#include "core/random.h"
#include "integrators/integrator.h"

namespace photonlab {

struct LoopLayerSettings {
    bool has_new_points = false;  ///< in every pass
    int direct_samples =
        1;               ///< shadow rays a hit point and pass; 0: direct light is somebody else's, and is black here
    int max_depth = -1;  ///< edges from camera to light, as in Mitsuba
    std::uint64_t seed = 1;
    int threads = 1;
    RandomPurpose direct_purpose = RandomPurpose::DirectLight;  ///< a reference's half has its own
};

class LoopLayers {
public:
    /// `hit_points`: of the grid, seen before the first pass. Scene and points must outlive this.
    LoopLayers(const Scene& scene, const HitPoints& hit_points, const LoopLayerSettings& settings);

    /// Begins the pass; the number of blocks for add_block(), each to be called once, on any thread, before end_pass().
    std::size_t begin_pass(std::uint64_t pass, const HitPoints& points);
    void add_block(std::size_t block);
    void end_pass();

    /// Means over the passes so far. Before the first: of the grid, direct light by one sampling for this call alone.
    std::vector<Color> emission() const;
    std::vector<Color> direct() const;

    /// See Integrator::exchange().
    void exchange(StateArchive& archive);

    std::uint64_t bytes() const;

private:
    std::vector<Color> mean(const std::vector<ColorD>& pixel_sums) const;
    std::size_t blocks(const HitPoints& points) const;
    void add_samples(const HitPoints& points, std::uint64_t pass, std::size_t block, std::vector<ColorD>& sums) const;

    const Scene& scene_;
    const HitPoints& grid_;
    const LoopLayerSettings settings_;
    std::uint64_t passes_ = 0;
    std::uint64_t begun_ = 0;            // the pass that was begun last, counted from 1
    const HitPoints* points_ = nullptr;  // its hit points, until its end
    std::vector<ColorD> direct_sums_;    // one a hit point: over all passes, or over this one where points are new
    std::vector<ColorD> direct_pixels_;  // where points are new: over all passes
    std::vector<ColorD> emission_pixels_;
};

}  // namespace photonlab
