// Density estimation at a hit point, shared by photonmapper, ppm and sppm: what the photons around it bring.
//
// L = sum over photons of f power K w / (pi r^2 N), with N emitted paths; here everything but the division. w is 1 in a
// whole disc, and elsewhere what makes the area that is there of the disc's.
// [Jensen 2001, equation 7.6; kernels: gather/kernel.h; w: gather/areas/area_weights.h]

#pragma once

#include <atomic>
#include <cassert>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/math.h"
#include "core/parallel.h"
#include "gather/kernel.h"
#include "gather/map/photon_map.h"
#include "gather/map/search_order.h"
#include "integrators/integrator.h"
#include "integrators/photon_moments.h"
#include "scene/scene.h"
#include "transport/camera/hit_point_list.h"
#include "transport/path_length.h"

namespace photonlab {

/// Sums flux times BRDF at one hit point, photon by photon.
class FluxSum {
public:
    FluxSum(const Scene& scene, const HitPoint& point, int max_depth)
        : camera_edges_(point.camera_edges), max_depth_(max_depth) {
        const Material& material = scene.materials[point.material];
        const bool is_turned = has_turned_normals(material);
        const Bsdf bsdf = bsdf_at(material, point.texture_coordinate, point.from_back);
        const std::optional<Color> uniform = uniform_value(bsdf);
        if (uniform && !is_turned) {
            uniform_ = *uniform;
        } else {
            const Frame frame = make_frame(point.normal, point.turn);
            glossy_.emplace(Glossy{bsdf, frame, frame.to_local(point.outgoing), point.geometric_normal, is_turned});
        }
    }

    /// False for a photon whose path would be deeper than max_depth: it is not counted.
    bool counts(const Photon& photon) const {
        return depth_allows(max_depth_, photon.edges + std::uint32_t{camera_edges_});
    }

    /// Flux times BRDF of a photon that was accepted at the point, but for factor().
    ColorD carried(const Photon& photon) const {
        if (!glossy_) return ColorD(photon.power);
        const Vector direction = photon.incoming.unit();
        const Vector incoming = glossy_->frame.to_local(direction);
        const Color reflected = evaluate(glossy_->bsdf, glossy_->outgoing, incoming) * photon.power;
        if (!glossy_->is_turned) return ColorD(reflected);
        // The power is that by the geometric normal's cosine, and nothing comes where the two disagree.
        return ColorD(reflected) * std::max(0.0f, incoming.z / direction.dot(glossy_->geometric_normal));
    }

    /// The BRDF where it is a constant; else 1.
    ColorD factor() const { return glossy_ ? ColorD(1.0) : ColorD(uniform_); }

    /// `weight`: the kernel's times the area's. `times`: photons that `carried` is of.
    void add(const ColorD& carried, double weight, std::uint32_t times = 1) {
        count_ += times;
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
        Vector geometric_normal;
        bool is_turned;  // by a texture, the frame
    };

    ColorD sum_ = ColorD(0.0);  // of flux times BRDF; of flux alone where the BRDF is a constant
    std::uint64_t count_ = 0;
    Color uniform_ = Color(0.0f);  // that constant
    std::uint16_t camera_edges_;
    int max_depth_;
    std::optional<Glossy> glossy_;
};

/// What a hit point asks the map for within `radius` (unit box).
inline GatherQuery query_at(const Scene& scene, const HitPoint& point, double radius) {
    const Material& material = scene.materials[point.material];
    GatherQuery query{point.position, gather_normal(material, point.normal, point.geometric_normal), radius};
    if (may_scatter_through(material)) query.beyond = point.from_back ? Beyond::Front : Beyond::Back;
    return query;
}

/// The point with the normal of the plane in which photons lie around it.
inline HitPoint in_plane_of_photons(const Scene& scene, HitPoint point) {
    point.normal = gather_normal(scene.materials[point.material], point.normal, point.geometric_normal);
    return point;
}

/// What one gather finds at one hit point.
template <typename Moments>
struct PointGather {
    FluxSum sum;
    [[no_unique_address]] Moments moments;

    PointGather(const Scene& scene, const HitPoint& point, int max_depth, const GatherReach& reach)
        : sum(scene, point, max_depth), moments(in_plane_of_photons(scene, point), reach) {}

    /// Takes a photon that the map found around the point, and that counts `times` times; the density estimate is that
    /// within `squared_radius`. False when it is not accepted there.
    bool add(const Scene& scene, const Photon& photon, std::uint32_t times, double squared_distance,
             double squared_radius, const GatherArea& area, Kernel kernel) {
        if (!sum.counts(photon)) return false;
        double area_weight = 1.0;
        if (!area.is_whole()) {
            const std::optional<double> weight = area.weight(scene, photon);
            if (!weight) return false;
            area_weight = *weight;
        }
        ColorD carried = sum.carried(photon);
        if (times > 1) carried *= static_cast<double>(times);
        if constexpr (Moments::are_none) {
            sum.add(carried, area_weight * kernel_weight(kernel, std::min(1.0, squared_distance / squared_radius)),
                    times);
            return true;
        } else {
            const bool is_inside = squared_distance <= squared_radius;
            const double weight =
                is_inside ? area_weight * kernel_weight(kernel, squared_distance / squared_radius) : 0.0;
            if (is_inside) sum.add(carried, weight, times);
            moments.add({photon, times, squared_distance, carried, is_inside, weight});
            return is_inside;
        }
    }
};

/// Everything within each hit point's own reach: what is found at hit points [range.begin, range.end), one of the
/// blocks, in order. `order` is that of `points`; `reach_of(index, point)` is in the unit box. `accepted`: Pass's.
template <typename Moments = NoMoments, typename ReachOf>
std::vector<PointGather<Moments>> gather_within(const PhotonMap& map, const Scene& scene, const HitPointList& points,
                                                const SearchOrder& order, BlockRange range,
                                                const MethodSettings& settings, const ReachOf& reach_of,
                                                std::span<std::uint32_t> accepted = {}) {
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
        in_list.push_back(query_at(scene, point, std::max(reach.radius, reach.bandwidth)));
        gathered.emplace_back(scene, point, settings.max_depth, reach);
    }
    std::vector<GatherQuery> queries;
    queries.reserve(count);
    for (const std::uint8_t place : places) queries.push_back(in_list[place]);
    const std::span<const std::uint32_t> multiplicity = map.notes().multiplicity;
    map.within_each(
        queries,
        [&](std::size_t query, const Photon& photon, double squared_distance) {
            const std::size_t place = places[query];
            const GatherReach& reach = reaches[place];
            const std::uint32_t times = multiplicity.empty() ? 1 : multiplicity[map.index_of(photon)];
            const bool counts = gathered[place].add(scene, photon, times, squared_distance, reach.radius * reach.radius,
                                                    reach.area, settings.kernel);
            if (counts && !accepted.empty())
                std::atomic_ref(accepted[map.index_of(photon)]).fetch_add(1, std::memory_order_relaxed);
        },
        settings.eps);
    return gathered;
}

inline GatherAreaSettings gather_area_settings(const MethodSettings& settings) {
    return {.mode = settings.area, .kernel = settings.kernel, .lines = settings.area_lines};
}

inline SurfaceEnd surface_end(const Scene& scene, const HitPoint& point) {
    const Material& material = scene.materials[point.material];
    return {point.position, gather_normal(material, point.normal, point.geometric_normal), point.geometric_normal,
            may_scatter_through(material)};
}

/// The area within a radius (unit box) around one of the hit points that stay.
inline GatherArea area_around(GatherAreas& areas, const Scene& scene, const HitPoint& point, std::size_t index,
                              double radius) {
    return areas.are_discs() ? GatherArea() : areas.at(surface_end(scene, point), index, radius);
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

/// The names of the settings that all use which gather, after those that only one has.
inline std::vector<std::string_view> gather_settings(std::vector<std::string_view> own) {
    for (const std::string_view name : {"kernel", "area", "area_lines", "eps", "direct", "direct_samples", "max_depth",
                                        "branch_cutoff", "photons_per_pass"})
        own.push_back(name);
    return own;
}

}  // namespace photonlab
