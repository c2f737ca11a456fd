// Density estimation at a hit point, shared by photonmapper, ppm and sppm: what the photons around it bring.
//
// L = sum over photons of f power K w / (pi r^2 N), with N emitted paths; here everything but the division. w is 1 in a
// whole disc, and elsewhere what makes the area that is there of the disc's.
// [Jensen 2001, equation 7.6; kernels: gather/kernel.h; w: gather/area_weights.h]

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
#include "integrators/photon_moments.h"
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

    /// False for a photon whose path would be deeper than max_depth: it is not counted.
    bool counts(const Photon& photon) const {
        return depth_allows(max_depth_, photon.edges + std::uint32_t{camera_edges_});
    }

    /// Flux times BRDF of a photon that was accepted at the point, but for factor().
    ColorD carried(const Photon& photon) const {
        if (!glossy_) return ColorD(photon.power);
        const Vector incoming = glossy_->frame.to_local(photon.incoming.unit());
        return ColorD(evaluate(glossy_->bsdf, glossy_->outgoing, incoming) * photon.power);
    }

    /// The BRDF where it is a constant; else 1.
    ColorD factor() const { return glossy_ ? ColorD(1.0) : ColorD(uniform_); }

    /// `weight`: the kernel's times the area's.
    void add(const ColorD& carried, double weight) {
        ++count_;
        sum_ += carried * weight;
    }

    /// The same from the photon, if it counts.
    void add(const Photon& photon, double weight) {
        if (counts(photon)) add(carried(photon), weight);
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

/// What one gather finds at one hit point.
template <typename Moments>
struct PointGather {
    FluxSum sum;
    [[no_unique_address]] Moments moments;

    PointGather(const Scene& scene, const HitPoint& point, int max_depth, const GatherReach& reach)
        : sum(scene, point, max_depth), moments(point, reach) {}

    /// Takes a photon that the map found around the point; the density estimate is that within `squared_radius`.
    void add(const Scene& scene, const Photon& photon, double squared_distance, double squared_radius,
             const GatherArea& area, Kernel kernel) {
        if (!sum.counts(photon)) return;
        double area_weight = 1.0;
        if (!area.is_whole()) {
            const std::optional<double> weight = area.weight(scene, photon);
            if (!weight) return;
            area_weight = *weight;
        }
        const ColorD carried = sum.carried(photon);
        if constexpr (Moments::are_none) {
            sum.add(carried, area_weight * kernel_weight(kernel, std::min(1.0, squared_distance / squared_radius)));
        } else {
            const bool is_inside = squared_distance <= squared_radius;
            const double weight =
                is_inside ? area_weight * kernel_weight(kernel, squared_distance / squared_radius) : 0.0;
            if (is_inside) sum.add(carried, weight);
            moments.add({photon, squared_distance, carried, is_inside, weight});
        }
    }
};

/// Everything within each hit point's own reach: what is found at hit points [range.begin, range.end), one of the
/// blocks, in order. `order` is that of `points`; `reach_of(index, point)` is in the unit box.
template <typename Moments = NoMoments, typename ReachOf>
std::vector<PointGather<Moments>> gather_within(const PhotonMap& map, const Scene& scene, const HitPointList& points,
                                                const SearchOrder& order, BlockRange range,
                                                const MethodSettings& settings, const ReachOf& reach_of) {
    const std::size_t count = range.end - range.begin;
    assert(range.begin % hit_points_per_block == 0);
    assert(count == std::min(hit_points_per_block, points.size() - range.begin));
    const std::span<const std::uint8_t> places = order.of_block(range);
    std::vector<PointGather<Moments>> gathered;
    std::vector<GatherReach> reaches;
    std::vector<GatherQuery> in_list;
    gathered.reserve(count);
    reaches.reserve(count);
    in_list.reserve(count);
    for (std::size_t i = range.begin; i < range.end; ++i) {
        const HitPoint& point = points[i];
        const GatherReach& reach = reaches.emplace_back(reach_of(i, point));
        in_list.push_back({point.position, point.normal, std::max(reach.radius, reach.bandwidth)});
        gathered.emplace_back(scene, point, settings.max_depth, reach);
    }
    std::vector<GatherQuery> queries;
    queries.reserve(count);
    for (const std::uint8_t place : places) queries.push_back(in_list[place]);
    map.within_each(
        queries,
        [&](std::size_t query, const Photon& photon, double squared_distance) {
            const std::size_t place = places[query];
            const GatherReach& reach = reaches[place];
            gathered[place].add(scene, photon, squared_distance, reach.radius * reach.radius, reach.area,
                                settings.kernel);
        },
        settings.eps);
    return gathered;
}

inline GatherAreaSettings gather_area_settings(const MethodSettings& settings) {
    return {.mode = settings.area, .kernel = settings.kernel, .lines = settings.area_lines};
}

inline SurfaceEnd surface_end(const HitPoint& point) {
    return {point.position, point.normal, point.geometric_normal};
}

/// Radii that can be asked for, in shares of the scene (unit box). Float positions near its walls are 3e-8 apart: a
/// disc of 1e-6 still has its area to 0.2%, one of 1e-7 to 5%. The largest is largest_length.
inline constexpr double smallest_initial_radius = 1e-7;

/// A radius in the unit box: what was chosen (scene units), or what is taken when nothing was (unit box).
inline double chosen_radius(const std::optional<double>& chosen, double otherwise, const Scene& scene) {
    return std::max(chosen ? *chosen / scene.unit_length : otherwise, smallest_initial_radius);
}

/// Initial gather radius of a hit point, unit box: the setting, or so many footprints of the pixel there.
inline double initial_radius(const MethodSettings& settings, const Scene& scene, const HitPoints& hit_points,
                             std::size_t index) {
    return chosen_radius(settings.radius, settings.footprints * hit_points.footprints[index], scene);
}

/// The same of one of the grid's.
inline double initial_radius(const MethodSettings& settings, const IntegratorContext& context, std::size_t index) {
    return initial_radius(settings, context.scene, context.hit_points, index);
}

}  // namespace photonlab
