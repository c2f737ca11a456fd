// What radius rules and error estimates want to know of the photons around a point beside their flux: how the light
// curves there, and how the photons are spread over the disc. One pass of one region, which is a hit point or, where
// hit points are new in every pass, a pixel.
//
// Notation of docs/theory.md, section 9: n paths emitted, phi_p flux times BRDF of photon p, s_p its distance from the
// point, K the kernel, D_h the curvature kernel.

#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "core/math.h"

namespace photonlab {

/// D_h(s) = 24 / (pi h^4) (2 s^2 / h^2 - 1) for s < h: its integral over the disc of radius h against a constant or a
/// linear function is 0, and against any quadratic is that function's Laplacian. Its variance from photons of density E
/// and flux phi is 192 E phi / (pi h^6).
inline double curvature_kernel(double squared_distance, double squared_bandwidth) {
    return 24.0 / (pi * squared_bandwidth * squared_bandwidth) * (2.0 * squared_distance / squared_bandwidth - 1.0);
}

/// Sums over the photons of a pass, for the region's own unit of length: squared lengths are in shares of its initial
/// squared radius where the region is a pixel, and in the unit box where it is a hit point.
struct Curvature {
    double squared_estimate = 0.0;   ///< sum over photons and channels of (phi K)^2 / n^2
    ColorD laplacian = ColorD(0.0);  ///< sum of phi D_h / n: an unbiased estimate of the Laplacian, blurred over h
    double squared_laplacian = 0.0;  ///< sum over photons and channels of (phi D_h)^2 / n^2

    Curvature& operator+=(const Curvature& other) {
        squared_estimate += other.squared_estimate;
        laplacian += other.laplacian;
        squared_laplacian += other.squared_laplacian;
        return *this;
    }
};

/// Bins of a disc: 2 rings of equal area, the inner first, times 6 sectors of 60 degrees around the normal.
inline constexpr std::size_t sectors_per_ring = 6;
inline constexpr std::size_t sector_count = 2 * sectors_per_ring;

/// Photons of a pass by their bin of the disc.
struct Sectors {
    std::array<double, sector_count> count{};
    std::array<double, sector_count> flux{};  ///< sum of phi / n, mean channel

    Sectors& operator+=(const Sectors& other) {
        for (std::size_t bin = 0; bin < sector_count; ++bin) {
            count[bin] += other.count[bin];
            flux[bin] += other.flux[bin];
        }
        return *this;
    }
};

/// The bin of a photon at (x, y) in the tangent plane. `squared_share`: its squared distance over the squared radius.
inline std::size_t sector_of(double x, double y, double squared_share) {
    const double slope = 1.7320508075688772 * x;  // |y| against it: which side of the lines at +-60 degrees
    const std::size_t upper = y < slope ? 0 : y <= -slope ? 2 : 1;
    const std::size_t sector = y >= 0.0 ? upper : -y < -slope ? 3 : -y <= slope ? 5 : 4;
    return (2.0 * squared_share < 1.0 ? 0 : sectors_per_ring) + sector;
}

}  // namespace photonlab
