// The area that is there around a point whose surroundings are flat, in closed form but for one integral over angles:
// what of the disc its triangles cover, as far as nothing that stands on it hides the rest. Without variance, where
// lines (seen_area.h) would have some; and the edges of a room, where most of the bias is, are all of this kind.
//
// In polar coordinates around the point, a triangle covers what its edges leave of a ray: with G(q) the integral of
// K(t) t from 0 to q, its part is the sum over the edges that the ray crosses, each with the sign of its turn, of G at
// the crossing, or at the nearest wall or the rim where these are nearer.

#pragma once

#include "gather/areas/area_weights.h"
#include "gather/kernel.h"
#include "scene/surroundings.h"

namespace photonlab {

struct FlatArea {
    AreaMoments moments;
    bool is_obstructed = false;  ///< something is hidden
    bool is_valid = true;        ///< false where triangles lie upon each other
};

FlatArea flat_area(const FlatSurroundings& surroundings, Kernel kernel, double radius);

/// True when a wall stands between the point and what lies at `offset` from it, in the axes and lengths of the
/// surroundings.
bool is_hidden(const FlatSurroundings& surroundings, const Imath::V2d& offset);

}  // namespace photonlab
