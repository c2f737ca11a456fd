// Density estimation at a hit point, shared by photonmapper and ppm: what the photons around it bring.
//
// L = sum over photons of f power K / (pi r^2 N), with N emitted paths; here everything but the division.
// [Jensen 2001, equation 7.6; kernels: gather/kernel.h]

#pragma once

#include <cassert>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/math.h"
#include "core/parallel.h"
#include "gather/kernel.h"
#include "gather/photon_map.h"
#include "gather/search_order.h"
#include "integrators/integrator.h"
#include "scene/scene.h"
#include "transport/hit_point_list.h"
#include "transport/path_length.h"

namespace photonlab {

/// Sums flux times BRDF at one hit point, photon by photon.
class FluxSum {
public:
    FluxSum(const Scene& scene, const HitPoint& point, int max_depth)
        : camera_edges_(point.camera_edges), max_depth_(max_depth) {
        const Bsdf bsdf = bsdf_at(scene.materials[point.material], point.texture_coordinate, false);
        if (const std::optional<Color> uniform = uniform_value(bsdf))
            uniform_ = *uniform;
        else
            glossy_.emplace(Glossy{bsdf, make_frame(point.normal), make_frame(point.normal).to_local(point.outgoing)});
    }

    /// Takes a photon that was accepted at the point, with its kernel weight. A photon whose path would be deeper than
    /// max_depth is not counted.
    void add(const Photon& photon, double weight) {
        if (!depth_allows(max_depth_, photon.edges + std::uint32_t{camera_edges_})) return;
        ++count_;
        if (glossy_) {
            const Vector incoming = glossy_->frame.to_local(photon.incoming.unit());
            sum_ += ColorD(evaluate(glossy_->bsdf, glossy_->outgoing, incoming) * photon.power) * weight;
        } else {
            sum_ += ColorD(photon.power) * weight;
        }
    }

    /// Relative to Scene::total_power, per steradian.
    ColorD flux() const { return glossy_ ? sum_ : sum_ * ColorD(uniform_); }
    std::uint64_t count() const { return count_; }

private:
    struct Glossy {
        Bsdf bsdf;
        Frame frame;
        Vector outgoing;  // local
    };

    ColorD sum_ = ColorD(0.0);  // of flux times BRDF; of flux alone where the BRDF is a constant
    std::uint64_t count_ = 0;
    Color uniform_ = Color(0.0f);  // that constant
    std::uint16_t camera_edges_;
    int max_depth_;
    std::optional<Glossy> glossy_;
};

/// Everything within each hit point's own radius, weighted by the kernel: the sums of hit points [range.begin,
/// range.end), one of the blocks, in order. `order` is that of `points`; `radius_of(index)` is in the unit box.
template <typename RadiusOf>
std::vector<FluxSum> gather_within(const PhotonMap& map, const Scene& scene, const HitPointList& points,
                                   const SearchOrder& order, BlockRange range, const MethodSettings& settings,
                                   const RadiusOf& radius_of) {
    const std::size_t count = range.end - range.begin;
    assert(range.begin % hit_points_per_block == 0);
    assert(count == std::min(hit_points_per_block, points.size() - range.begin));
    const std::span<const std::uint8_t> places = order.of_block(range);
    std::vector<FluxSum> sums;
    std::vector<GatherQuery> in_list;
    sums.reserve(count);
    in_list.reserve(count);
    for (std::size_t i = range.begin; i < range.end; ++i) {
        const HitPoint& point = points[i];
        in_list.push_back({point.position, point.normal, radius_of(i)});
        sums.emplace_back(scene, point, settings.max_depth);
    }
    std::vector<GatherQuery> queries;
    queries.reserve(count);
    for (const std::uint8_t place : places) queries.push_back(in_list[place]);
    map.within_each(
        queries,
        [&](std::size_t query, const Photon& photon, double squared_distance) {
            const double squared_radius = queries[query].radius * queries[query].radius;
            sums[places[query]].add(photon,
                                    kernel_weight(settings.kernel, std::min(1.0, squared_distance / squared_radius)));
        },
        settings.eps);
    return sums;
}

/// Radii that can be asked for, in shares of the scene (unit box). Float positions near its walls are 3e-8 apart: a
/// disc of 1e-6 still has its area to 0.2%, one of 1e-7 to 5%. The largest is largest_length.
inline constexpr double smallest_initial_radius = 1e-7;

/// A radius in the unit box: what was chosen (scene units), or what is taken when nothing was (unit box).
inline double chosen_radius(const std::optional<double>& chosen, double otherwise, const Scene& scene) {
    return std::max(chosen ? *chosen / scene.unit_length : otherwise, smallest_initial_radius);
}

/// Initial gather radius of a hit point, unit box: the setting, or so many footprints of the pixel there.
inline double initial_radius(const MethodSettings& settings, const IntegratorContext& context, std::size_t index) {
    return chosen_radius(settings.radius, settings.footprints * context.hit_points.footprints[index], context.scene);
}

}  // namespace photonlab
