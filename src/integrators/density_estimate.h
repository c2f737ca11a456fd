// Density estimation at a hit point, shared by photonmapper and ppm: what the photons around it bring.
//
// L = sum over photons of f power K / (pi r^2 N), with N emitted paths; here everything but the division.
// [Jensen 2001, equation 7.6; kernels: gather/kernel.h]

#pragma once

#include <cstdint>

#include "core/math.h"
#include "gather/kernel.h"
#include "gather/photon_map.h"
#include "integrators/integrator.h"
#include "scene/scene.h"
#include "transport/hit_points.h"

namespace photonlab {

/// Sums flux times BRDF at one hit point, photon by photon.
class FluxSum {
public:
    FluxSum(const Scene& scene, const HitPoint& point, int max_depth)
        : point_(point),
          surface_(surface_at(scene, point)),
          outgoing_(surface_.frame.to_local(point.outgoing)),
          max_depth_(max_depth) {}

    /// Takes a photon with its kernel weight. A photon whose path would be deeper than max_depth is not counted.
    void add(const Photon& photon, double weight) {
        if (!depth_allows(max_depth_, photon.edges + point_.camera_edges)) return;
        ++count_;
        const Color f = evaluate(surface_.bsdf, outgoing_, surface_.frame.to_local(photon.incoming));
        flux_ += ColorD(f * photon.power) * weight;
    }

    ColorD flux() const { return flux_; }  ///< relative to Scene::total_power, per steradian
    std::uint64_t count() const { return count_; }

private:
    const HitPoint& point_;
    const Surface surface_;
    const Vector outgoing_;
    const int max_depth_;
    ColorD flux_ = ColorD(0.0);
    std::uint64_t count_ = 0;
};

/// Everything within `radius` (unit box), weighted by the kernel.
inline FluxSum gather_within(const PhotonMap& map, const Scene& scene, const HitPoint& point, double radius,
                             Kernel kernel, int max_depth) {
    FluxSum sum(scene, point, max_depth);
    const double inverse_squared_radius = 1.0 / (radius * radius);
    map.within(point.position, point.normal, radius, [&](const Photon& photon, double squared_distance) {
        sum.add(photon, kernel_weight(kernel, std::min(1.0, squared_distance * inverse_squared_radius)));
    });
    return sum;
}

/// Initial gather radius of a hit point, unit box: the setting (scene units), or three times the pixel's footprint.
inline double initial_radius(const MethodSettings& settings, const IntegratorContext& context, std::size_t index) {
    const double radius = settings.radius ? *settings.radius / context.scene.unit_length
                                          : 3.0 * context.hit_points.footprints[index] * context.auto_radius_scale;
    return std::max(radius, PhotonMap::minimum_radius);
}

}  // namespace photonlab
