// What lies around a point of a surface: whether it is flat as far as a radius, how much of the disc is there and what
// stands on it, and all surfaces along a line. Questions about geometry and materials alone, asked by estimators that
// divide by an area.

#pragma once

#include <array>
#include <optional>
#include <vector>

#include "scene/scene.h"

namespace photonlab {

/// A point of a surface, seen from one side.
struct SurfaceEnd {
    Vector position;
    Vector normal;                ///< gather_normal(), unit, on that side
    Vector geometric_normal;      ///< unit, on that side
    bool has_other_side = false;  ///< light is gathered from behind it as well
};

/// True when the ball of `radius` (unit box) around the point holds nothing but one whole surface on whose side the
/// point lies and where a photon would be accepted anywhere: a disc of coplanar triangles, or of an analytic shape that
/// says so itself (AnalyticKind). Within any distance up to the radius its area is then that of the flat disc, and
/// nothing of it is hidden from the point. A false answer may only mean that it is not known.
bool is_whole_around(const Scene& scene, const SurfaceEnd& point, double radius);

/// Surroundings in which a photon can be accepted in the point's own plane alone. Positions are offsets from the point
/// in the axes of make_frame(its geometric normal), unit box.
struct FlatSurroundings {
    std::vector<std::array<Imath::V2d, 3>> triangles;  ///< where photons are accepted; counter-clockwise
    std::vector<std::array<Imath::V2d, 2>> walls;      ///< what stands on the plane, where it meets it: whatever lies
                                                       ///< behind is hidden
};

/// Of the ball of `radius` (unit box). Empty where it is not flat, or not known to be: curved or tilted surfaces on
/// which photons would be accepted, shapes other than triangles, textures that are black somewhere, smooth normals.
std::optional<FlatSurroundings> flat_surroundings(const Scene& scene, const SurfaceEnd& point, double radius);

/// Replaces `hits` by all surfaces that the ray crosses within `length` (unit box), nearest first, each as intersect()
/// gives it. Of surfaces within 1e-7 of each other only the first is met.
void find_crossings(const Scene& scene, const Ray& ray, float length, std::vector<Hit>& hits);

}  // namespace photonlab
