// The camera pass: where each sample position of the image sees a non-specular surface. Every integrator, PM, PPM and
// the path tracer alike, starts from these same points, so what differs between them is what they estimate there
// and nothing else.
//
// Mirrors and glass are followed into all their branches, without chance, until a branch meets a surface that can be
// gathered at, or carries too little to be seen.
//
// [Hachisuka et al. 2008, "Progressive Photon Mapping": the eye pass]

#pragma once

#include <cstdint>
#include <vector>

#include "core/math.h"
#include "scene/scene.h"

namespace photonlab {

/// A point to gather at. Const once made; what changes from pass to pass is in GatherStatistics.
struct HitPoint {
    Vector position;
    Vector normal;               ///< shading normal, unit, facing `outgoing`
    Vector geometric_normal;     ///< unit, facing `outgoing`
    Vector outgoing;             ///< unit, towards the camera's side of the path
    Color weight;                ///< path throughput from here to the pixel, times the sample's share of the pixel
    std::uint32_t pixel;         ///< y * width + x
    std::uint16_t material;      ///< index into Scene::materials
    std::uint16_t camera_edges;  ///< edges of the path from the camera to here; 1 when seen directly
    Imath::V2f texture_coordinate;
};

/// Light that the camera sees without a bounce at a hit point.
struct SeenEmission {
    std::uint32_t pixel;
    std::uint32_t edges;  ///< of the path from the camera to the light; 1 when seen directly
    ColorD radiance;      ///< times the path's throughput and the sample's share of the pixel
};

/// The result of the camera pass.
struct HitPoints {
    int width = 0;
    int height = 0;
    int samples_per_pixel = 1;
    std::vector<HitPoint> points;  ///< tile by tile and along a Morton curve in each, so that neighbours in the list
                                   ///< are neighbours in space
    std::vector<float>
        footprints;  ///< one a point, unit box: unfolded distance from the camera times the pixel's angle
    std::vector<SeenEmission> emission;
    double weight_cut = 0.0;      ///< throughput of the branches that were ended, mean channel, mean over pixels
    std::uint64_t nonfinite = 0;  ///< camera paths that met a non-finite value
};

/// Where camera branches end unless a method says otherwise, and always those of a reference.
inline constexpr double default_branch_cutoff = 1e-4;

/// Traces the deterministic grid of sample positions: `samples_per_pixel` is a perfect square, 1 is the pixel's centre.
/// Specular branches whose throughput (strongest channel) is below `branch_cutoff`, above 0, end, and so do those of
/// 10,000 edges.
HitPoints trace_hit_points(const Scene& scene, int samples_per_pixel, int threads,
                           double branch_cutoff = default_branch_cutoff);

inline std::size_t pixel_count(const HitPoints& hit_points) {
    return static_cast<std::size_t>(hit_points.width) * static_cast<std::size_t>(hit_points.height);
}

/// One a pixel: the emission that paths of at most max_depth edges see.
std::vector<ColorD> emission_image(const HitPoints& hit_points, int max_depth);

/// True when a path of `edges` edges from camera to light may count; max_depth -1 is unlimited.
inline bool depth_allows(int max_depth, std::uint32_t edges) {
    return max_depth < 0 || edges <= static_cast<std::uint32_t>(max_depth);
}

/// The hit point as a surface to be shaded.
Surface surface_at(const Scene& scene, const HitPoint& point);

}  // namespace photonlab
