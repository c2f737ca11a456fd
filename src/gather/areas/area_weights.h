// What a density estimate divides by, as weights of its photons: the disc's area, the area that is there, or a local
// linear fit over it.
//
// With the kernel's moments over the area that is there, m0 = integral K, m1 = integral K x, M2 = integral K x x', a
// photon at the offset x counts K / m0, or K (1 - x' M2^-1 m1) / (m0 - m1' M2^-1 m1). Both are unbiased where light is
// uniform; the second also where it has a gradient, though the area's centroid lies beside the point. Its weights can
// be negative.
//
// [Jones 1993, "Simple boundary correction for kernel density estimation"; Wand & Jones 1995, "Kernel Smoothing",
//  section 5.5]

#pragma once

#include <array>

#include "core/text/names.h"

namespace photonlab {

enum class AreaMode {
    Disc,    ///< pi r^2
    Seen,    ///< of the surface in the ball on which a photon would be accepted
    Linear,  ///< the same, by weights of a local linear fit
};
inline constexpr std::array area_mode_names{ChoiceName<AreaMode>{AreaMode::Disc, "disc"},
                                            ChoiceName<AreaMode>{AreaMode::Seen, "seen"},
                                            ChoiceName<AreaMode>{AreaMode::Linear, "linear"}};
constexpr const auto& choice_names(AreaMode) {
    return area_mode_names;
}

/// Lines, in each ring of seen_area.h, unless a method says otherwise.
inline constexpr int default_area_lines = 32;

/// Integrals of the kernel (times pi r^2, kernel.h) over the area within a radius r, in shares of pi r^2; offsets from
/// the point, in its tangent plane, in units of r. Of a whole flat disc: 1, 0, 0, and uu = vv > 0 = uv.
struct AreaMoments {
    double area = 0.0;
    double u = 0.0;
    double v = 0.0;
    double uu = 0.0;
    double uv = 0.0;
    double vv = 0.0;
};

/// `share` of the way from a to b.
inline AreaMoments between(const AreaMoments& a, const AreaMoments& b, double share) {
    const auto mix = [&](double AreaMoments::*moment) { return a.*moment + share * (b.*moment - a.*moment); };
    return {mix(&AreaMoments::area), mix(&AreaMoments::u),  mix(&AreaMoments::v),
            mix(&AreaMoments::uu),   mix(&AreaMoments::uv), mix(&AreaMoments::vv)};
}

/// A photon at (u, v), in units of r, counts constant + slope_u u + slope_v v times what it counts in a whole disc.
struct AreaWeights {
    double constant = 1.0;
    double slope_u = 0.0;
    double slope_v = 0.0;
};

/// By the area. Where none was found, as little as chance may leave of a point's own surroundings, by the disc's.
inline AreaWeights seen_weights(const AreaMoments& moments) {
    constexpr double least_area = 1e-3;
    return {.constant = moments.area > least_area ? 1.0 / moments.area : 1.0};
}

/// By the local linear fit. Its variance is constant * area times that of seen_weights(): 1 in a whole disc, 3.6 on an
/// edge, 8.4 in a square corner. Where it exceeds `most_variance`, as on narrow strips, seen_weights() are taken.
inline AreaWeights linear_weights(const AreaMoments& moments, double most_variance = 16.0) {
    const double determinant = moments.uu * moments.vv - moments.uv * moments.uv;
    if (!(determinant > 0.0)) return seen_weights(moments);
    const double u = -(moments.vv * moments.u - moments.uv * moments.v) / determinant;
    const double v = -(moments.uu * moments.v - moments.uv * moments.u) / determinant;
    const double rest = moments.area + u * moments.u + v * moments.v;
    if (!(rest * most_variance > moments.area)) return seen_weights(moments);
    return {1.0 / rest, u / rest, v / rest};
}

}  // namespace photonlab
