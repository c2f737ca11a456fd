// Surfaces that lie too close together to be told apart. A path leaves a surface some 2e-6 of the scene above it
// (offset_from_surface), and float32 positions are 3e-8 apart: sheets and gaps of 1e-5 of the scene are safe, of much
// less are not. Light may then pass through a sheet, or miss the nearer of two surfaces.

#pragma once

#include <cstdint>
#include <optional>

#include "scene/scene.h"

namespace photonlab {

/// Sheets and gaps below this share of the scene are not safe.
inline constexpr float narrowest_gap = 1e-5f;

/// Two surfaces closer together than that, or one and the same.
struct NarrowGap {
    std::uint32_t shape;
    std::uint32_t other;
    Vector position;
};

struct NarrowGaps {
    std::uint64_t tried = 0;         ///< points, spread over all surfaces
    std::uint64_t found = 0;         ///< of them, with another surface too close
    std::optional<NarrowGap> first;  ///< when there are any
};

/// Looks along the normals of points on every shape, to both sides. A spot check: what overlaps by a little may be
/// missed, and triangles narrower than a gap are not looked at.
NarrowGaps find_narrow_gaps(const Scene& scene);

}  // namespace photonlab
