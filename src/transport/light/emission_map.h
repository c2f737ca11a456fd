// Emission that learns: a density over lights and what they emit, so that more light paths begin where paths were seen.
//
// Each light's square of random numbers is cut into 16 x 16 cells. A path draws a cell c with probability p_c and is
// uniform inside; its power is multiplied by plain_c / p_c, with plain_c what plain emission would draw it with. So any
// density is unbiased as long as it is above 0, and learnt from passes before, never from the one that it serves
// (docs/theory.md, section 10). Half and half with plain emission,
//
//     p_c = (1 - e) q_c + e plain_c,   q_c ~ plain_c sqrt(s_c / m_c),   e = 1/2,
//
// the variance is at most twice the second moment of plain emission, whatever was learnt. m_c: paths that cell c had so
// far; s_c: the hit points, summed over those, that accepted one of their photons.
//
// After Li, Chen & Liu 2012, Computer Engineering and Design 33(1), of which the abstract alone was seen: emission
// adapts by statistics that progressive photon mapping has anyway. The cells, the square root, the factor plain_c in
// q_c (without it a faint light that is seen would get as many paths as a bright one) and the mixture are ours.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/files/state_archive.h"
#include "core/math.h"
#include "scene/scene.h"

namespace photonlab {

/// What a pass found out about its light paths, one a path, in their order.
struct PathsSeen {
    std::span<const std::uint32_t> cell;         ///< in which it began
    std::span<const std::uint64_t> acceptances;  ///< of its photons, at hit points; 0: it was not seen
};

class EmissionMap {
public:
    static constexpr std::uint32_t cells_per_side = 16;
    static constexpr std::uint32_t cells_per_light = cells_per_side * cells_per_side;
    static constexpr double plain_share = 0.5;  ///< e

    /// Which random numbers of a light tell its rays apart.
    enum class Square : std::uint8_t {
        Direction,
        Position,  ///< of light from one direction
    };

    /// Emits plainly until it learns.
    explicit EmissionMap(const Scene& scene);

    /// Where a path begins.
    struct Choice {
        std::uint32_t emitter;
        std::uint32_t cell;
        Square square;
        double weight;  ///< plain_c / p_c, at most 1 / plain_share
    };
    /// By the density; u uniform in [0, 1). The scene must have a light.
    Choice choose(double u) const;

    /// The point of the unit square, in [0, 1)^2, that is at u of the cell.
    static Imath::V2f within(std::uint32_t cell, const Imath::V2f& u);

    /// Takes what a pass found, and changes the density.
    void learn(const PathsSeen& seen);

    std::size_t cell_count() const { return paths_.size(); }  ///< light by light, row by row in each
    Square square(std::size_t light) const { return lights_[light].square; }
    double plain_probability(std::size_t cell) const;
    double probability(std::size_t cell) const { return probability_[cell]; }
    std::uint64_t paths(std::size_t cell) const { return paths_[cell]; }              ///< m_c
    std::uint64_t acceptances(std::size_t cell) const { return acceptances_[cell]; }  ///< s_c
    std::uint64_t bytes() const { return cell_count() * (2 * sizeof(std::uint64_t) + 2 * sizeof(double)); }

    /// True when both learnt the same.
    bool operator==(const EmissionMap& other) const {
        return paths_ == other.paths_ && acceptances_ == other.acceptances_;
    }

    /// Writes or reads what was learnt.
    void exchange(StateArchive& archive);

private:
    void set_density();

    struct LearntLight {
        double plain;  // probability with which plain emission chooses it
        Square square;
    };
    std::vector<LearntLight> lights_;
    std::vector<std::uint64_t> paths_;
    std::vector<std::uint64_t> acceptances_;
    std::vector<double> probability_;
    std::vector<double> cdf_;  // running sum; the last is 1
};

}  // namespace photonlab
