// The camera pass: where each sample position of the image sees a non-specular surface. Every integrator, PM, PPM and
// the path tracer alike, starts from these same points, so what differs between them is what they estimate there
// and nothing else.
//
// Mirrors and glass are followed into all their branches, without chance, until a branch meets a surface that can be
// gathered at, or carries too little to be seen. Where hit points are new in every pass a path may go on from glossy
// surfaces, too, in a direction drawn from the BSDF. What lights bring to such a surface itself is found twice, by a
// connection and by the ray that goes on, and weighted by the balance heuristic, as path tracing does.
//
// [Hachisuka et al. 2008, "Progressive Photon Mapping": the eye pass; Veach & Guibas 1995, "Optimally Combining
// Sampling Techniques"]

#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/math.h"
#include "core/random.h"
#include "core/text/names.h"
#include "scene/scene.h"
#include "transport/camera/hit_point_list.h"

namespace photonlab {

/// What light is that camera paths find by themselves: whether the path was spread by a glossy surface that it went on
/// from, and whether its last edge begins at the first of these.
enum class SeenLayer : std::uint8_t { Emission, Direct, Gathered };

/// Light that the camera sees without a bounce at a hit point.
struct SeenEmission {
    std::uint32_t pixel;
    std::uint32_t edges;  ///< of the path from the camera to the light; 1 when seen directly
    ColorD radiance;      ///< times the path's throughput and the sample's share of the pixel
    SeenLayer layer = SeenLayer::Emission;
};

/// The result of the camera pass.
struct HitPoints {
    int width = 0;
    int height = 0;
    int samples_per_pixel = 1;
    HitPointList points;  ///< tile by tile and along a Morton curve in each, so that neighbours in the list are
                          ///< neighbours in space; those of a pixel follow each other
    std::vector<float>
        footprints;  ///< one a point, unit box: unfolded distance from the camera times the pixel's angle
    std::vector<SeenEmission> emission;  ///< that of a pixel follows each other
    double weight_cut = 0.0;             ///< throughput of the branches that were ended, mean channel, mean over pixels
    std::uint64_t nonfinite = 0;         ///< camera paths that met a non-finite value
};

/// Where camera paths begin.
enum class Positions {
    Grid,   ///< at the sample positions of each pixel
    Box,    ///< uniform in the pixel, independent from pass to pass
    Sobol,  ///< the same, by the points of a scrambled sequence of each pixel, one a pass
};
inline constexpr std::array positions_names{ChoiceName<Positions>{Positions::Grid, "grid"},
                                            ChoiceName<Positions>{Positions::Box, "box"},
                                            ChoiceName<Positions>{Positions::Sobol, "sobol"}};
constexpr const auto& choice_names(Positions) {
    return positions_names;
}

/// "box" for all whose pictures converge to the mean over the pixels' areas, by which a reference of theirs is known.
constexpr Positions limit_of(Positions positions) {
    return positions == Positions::Grid ? Positions::Grid : Positions::Box;
}

/// How they go on from glass.
enum class Branches {
    All,  ///< every way, with its weight
    One,  ///< one of them, with the probability of its weight, which it then keeps
};
inline constexpr std::array branches_names{ChoiceName<Branches>{Branches::All, "all"},
                                           ChoiceName<Branches>{Branches::One, "one"}};
constexpr const auto& choice_names(Branches) {
    return branches_names;
}

/// What becomes of them at glossy surfaces.
enum class GlossyMode {
    Gather,    ///< a hit point
    Continue,  ///< they go on, as from a mirror
};
inline constexpr std::array glossy_mode_names{ChoiceName<GlossyMode>{GlossyMode::Gather, "gather"},
                                              ChoiceName<GlossyMode>{GlossyMode::Continue, "continue"}};
constexpr const auto& choice_names(GlossyMode) {
    return glossy_mode_names;
}

/// Camera paths of one pass of a method whose hit points are new in every pass.
struct NewPoints {
    Positions positions = Positions::Grid;
    Branches branches = Branches::All;
    bool all_cells = false;  ///< of others than "grid": as many paths a pixel as the grid of sample positions has
                             ///< cells, with "box" one in each
    double gather_roughness = 0.0;  ///< glossy surfaces that are less rough are gone on from; 0: all are gathered at
    bool operator==(const NewPoints&) const = default;
};

/// What the random numbers of a pass's camera paths are made from.
struct PassOfStream {
    std::uint64_t seed = 1;
    RandomPurpose purpose = RandomPurpose::CameraPositions;
    std::uint64_t pass = 1;
};

/// Where camera branches end unless a method says otherwise, and always those of a reference.
inline constexpr double default_branch_cutoff = 1e-4;

/// Traces the deterministic grid of sample positions: `samples_per_pixel` is a perfect square, 1 is the pixel's centre.
/// A lens has one point for each position, spread over it and always the same: its blur is that of so many points.
/// Specular branches whose throughput (strongest channel) is below `branch_cutoff`, above 0, end, and so do those of
/// 10,000 edges.
HitPoints trace_hit_points(const Scene& scene, int samples_per_pixel, int threads,
                           double branch_cutoff = default_branch_cutoff);

/// The same through another camera than the scene's: of fewer pixels, to know what is coming.
HitPoints trace_hit_points(const Scene& scene, const Camera& camera, int samples_per_pixel, int threads,
                           double branch_cutoff);

/// The camera paths of one pass, other ones in every pass. With positions "grid" a path a pixel begins at one of its
/// `samples_per_pixel` positions, each of them once in as many passes; with "box" and "sobol" it begins anywhere in
/// it, or one does for each cell of the grid. Each has the same share of its pixel.
HitPoints trace_new_hit_points(const Scene& scene, int samples_per_pixel, const NewPoints& points,
                               const PassOfStream& pass, int threads, double branch_cutoff = default_branch_cutoff);

/// The same through another camera.
HitPoints trace_new_hit_points(const Scene& scene, const Camera& camera, int samples_per_pixel, const NewPoints& points,
                               const PassOfStream& pass, int threads, double branch_cutoff);

/// Throws InputError unless `samples_per_pixel` is the square of a whole number, at most 1024^2.
void require_perfect_square(std::int64_t samples_per_pixel);

inline std::size_t pixel_count(const HitPoints& hit_points) {
    return static_cast<std::size_t>(hit_points.width) * static_cast<std::size_t>(hit_points.height);
}

/// Of the points and what is kept with them.
inline std::uint64_t hit_point_bytes(const HitPoints& hit_points) {
    return hit_points.points.bytes() + hit_points.footprints.size() * sizeof(float);
}

/// One a pixel: the light of the layer that camera paths of at most max_depth edges find by themselves.
std::vector<ColorD> seen_image(const HitPoints& hit_points, int max_depth, SeenLayer layer);

/// seen_image() of the emission.
std::vector<ColorD> emission_image(const HitPoints& hit_points, int max_depth);

}  // namespace photonlab
