// The area that density estimation divides by: not the disc's, but that of the surface on which a photon would be
// accepted at the point. At edges and corners, on curved surfaces and beside what stands on a floor a disc reaches over
// surface that is not there; photons divided by all of it come out too dark (boundary bias), and those from beyond a
// thin wall too many (occlusion bias). The area is geometry alone, so it is measured once and serves all passes.
//
// It is measured by lines parallel to the point's normal. Each crossing within the ball stands for 1 / |cosine| of
// surface, and counts when a photon lying there would: on its side, normals within 60 degrees, in reach (in_reach.h),
// of a material that takes photons. One set of lines serves radii from the largest, `top`, down to a quarter of it:
// rings whose areas double outwards hold equally many lines, spread over radius and angle by the golden ratio with a
// random shift. The measure is unbiased, with one line as with a thousand; where all is flat and whole it is the disc's
// area without any variance.

#pragma once

#include <array>
#include <cstdint>

#include "gather/areas/area_weights.h"
#include "gather/kernel.h"
#include "scene/surroundings.h"

namespace photonlab {

/// The measure around one point, for all radii between `top` and a quarter of it.
struct SeenArea {
    static constexpr int rings = 5;  ///< of lines, radii by sqrt(2); the innermost is a disc of a quarter of the top
    static constexpr std::size_t radii = 9;  ///< from the top to a quarter of it

    double top = 0.0;                       ///< largest radius, unit box
    std::array<AreaMoments, radii> within;  ///< of the radii top / 2^(i/4)
    bool is_obstructed = false;             ///< some surface in the ball was out of reach, so photons may be

    double least() const { return 0.25 * top; }
    /// `radius` from least() to top; interpolated.
    AreaMoments moments(double radius) const;
};

/// Where float32 positions are too coarse for lines and reach: what is asked for smaller radii is measured there.
inline constexpr double least_seen_radius = 3e-5;

/// What the lines are drawn by.
struct AreaLines {
    int per_ring = default_area_lines;  ///< >= 1
    std::uint64_t index = 0;            ///< of the point, below 2^56
    std::uint64_t series = 0;           ///< of the measure at this point, below 2^32
};

/// Measures around `point` for radii up to `top`.
SeenArea measure_seen_area(const Scene& scene, const SurfaceEnd& point, Kernel kernel, double top,
                           const AreaLines& lines);

}  // namespace photonlab
