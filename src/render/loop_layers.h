// The layers that the loop over passes makes, whatever the method: emission, which the camera sees by mirrors and glass
// alone, and direct light, sampled by shadow rays at the hit points in every pass, where lobes may be narrow by
// directions drawn from them as well, and averaged over passes. Where camera paths go on from glossy surfaces, they
// bring light of all three layers, and shadow rays at their ends light that was scattered twice, which is of the layer
// gathered.
//
// Where hit points are the same in every pass, sums are kept at the points; where they are new, in pixels.

#pragma once

#include <cstdint>
#include <vector>

#include "core/files/state_archive.h"
#include "core/random.h"
#include "integrators/integrator.h"
#include "integrators/pass_sums.h"

namespace photonlab {

struct LoopLayerSettings {
    bool has_new_points = false;  ///< in every pass
    bool goes_on = false;         ///< from glossy surfaces, where points are new
    int direct_samples = 1;  ///< shadow rays a hit point and pass; 0: direct light is somebody else's, and is black
                             ///< here; where camera paths bring some, it is of the layer gathered
    int max_depth = -1;      ///< edges from camera to light, as in Mitsuba
    std::uint64_t seed = 1;
    int threads = 1;
    bool has_exact_sums = false;                                ///< of a method whose passes can be joined
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
    std::vector<Color> gathered() const;  ///< to be added to the method's; empty where there is none

    /// See Integrator::exchange().
    void exchange(StateArchive& archive);

    std::uint64_t inexact_additions() const;  ///< as in IntegratorReport

    std::uint64_t bytes() const;

private:
    void add_sampled(bool after_glossy, PassSums& pixel_sums) const;
    void add_seen();
    std::vector<Color> mean(const PassSums& pixel_sums) const;
    std::size_t blocks(const HitPoints& points) const;
    template <typename Add>
    void add_samples(const HitPoints& points, std::uint64_t pass, std::size_t block, const Add& add) const;

    const Scene& scene_;
    const HitPoints& grid_;
    const LoopLayerSettings settings_;
    std::uint64_t passes_ = 0;
    std::uint64_t begun_ = 0;             // the pass that was begun last, counted from 1
    const HitPoints* points_ = nullptr;   // its hit points, until its end
    PassSums direct_sums_;                // one a hit point, where these stay
    std::vector<ColorD> direct_of_pass_;  // one a hit point, where they are new
    PassSums direct_pixels_;              // there, over all passes
    PassSums emission_pixels_;
    PassSums gathered_pixels_;  // where paths go on from glossy surfaces
};

}  // namespace photonlab
