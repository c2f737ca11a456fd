// What ppm and sppm share: their settings as those of a radius rule, what they ask of a gather, and where radii begin.

#pragma once

#include <cmath>
#include <string_view>
#include <vector>

#include "gather/adaptive_radius.h"
#include "gather/radius_rule.h"
#include "integrators/density_estimate.h"

namespace photonlab {

/// No radius shrinks below it.
inline constexpr double smallest_squared_radius = PhotonMap::minimum_radius * PhotonMap::minimum_radius;

/// What the loop has to give: passes of a blind schedule can be taken from any number on, as long as their photons do
/// not follow from those of earlier ones.
inline Needs progressive_needs(const MethodSettings& settings) {
    const bool has_own_photons = emits_adaptively(settings) || traces_visible_paths(settings);
    return {.photons = Needs::Photons::OfPass,
            .has_own_photons = has_own_photons,
            .passes =
                is_blind(settings.schedule) && !has_own_photons ? Needs::Passes::Independent : Needs::Passes::Ordered};
}

/// The names of what both use, after those that only one has.
inline std::vector<std::string_view> progressive_settings(std::vector<std::string_view> own = {}) {
    for (const std::string_view name : {"photon_paths",    "step_rule",
                                        "emission",        "learn_passes",
                                        "schedule",        "alpha",
                                        "kappa",           "smallest_radius",
                                        "largest_radius",  "laplacian_radius",
                                        "test_variant",    "start",
                                        "test_photons",    "test_shrink",
                                        "test_growth",     "estimate_error",
                                        "radius",          "footprints",
                                        "kernel",          "area",
                                        "area_lines",      "eps",
                                        "direct",          "direct_samples",
                                        "max_depth",       "branch_cutoff",
                                        "photons_per_pass"})
        own.push_back(name);
    return own;
}

inline RadiusRuleSettings radius_rule_settings(const MethodSettings& settings) {
    return {.schedule = settings.schedule,
            .alpha = settings.alpha,
            .kernel = settings.kernel,
            .kappa = settings.kappa,
            .smallest_radius = settings.smallest_radius,
            .largest_radius = settings.largest_radius,
            .variant = settings.test_variant,
            .test_photons = static_cast<double>(settings.test_photons),
            .test_shrink = settings.test_shrink,
            .test_growth = settings.test_growth};
}

/// The factor that the passes before `pass` would have put on a squared radius under a blind rule.
inline double shrink_before(const RadiusRule& rule, std::uint64_t pass) {
    double shrink = 1.0;
    for (std::uint64_t before = 1; before < pass; ++before) shrink *= rule.shrink_after(before);
    return shrink;
}

/// The discs of a pass, for Integrator::accepting_discs(): `reach_of(index, point)` is what its gather asks for.
template <typename ReachOf>
AcceptingDiscs discs_of_reaches(const IntegratorContext& context, const MethodSettings& settings,
                                const HitPointList& points, const ReachOf& reach_of) {
    std::vector<AcceptingDisc> discs(points.size());
    std::vector<GatherArea> areas(settings.area == AreaMode::Disc ? 0 : points.size());
    parallel_for(block_count(points.size(), hit_points_per_block), context.threads, [&](std::size_t block) {
        const BlockRange range = block_range(block, points.size(), hit_points_per_block);
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const HitPoint& point = points[i];
            const GatherReach reach = reach_of(i, point);
            discs[i] = {query_at(context.scene, point, std::max(reach.radius, reach.bandwidth)), point.camera_edges};
            if (!areas.empty()) areas[i] = reach.area;
        }
    });
    return AcceptingDiscs(context.scene, settings.max_depth, std::move(discs), std::move(areas));
}

/// The squared distance of photon number `test_photons` from the point, or that of the largest radius where there are
/// fewer: 100 pixels of a picture as wide as the scene. A gather within it does not find that photon itself, so that
/// what it finds is k - 1 photons in the k-th one's disc, which is not too bright (docs/theory.md, section 4).
inline double nearest_squared_radius(const PhotonMap& map, const HitPoint& point, const MethodSettings& settings,
                                     const IntegratorContext& context) {
    constexpr double just_inside = 1.0 - 1e-15;
    const double pixel = static_cast<double>(context.scene.bounding_radius) /
                         std::min(context.hit_points.width, context.hit_points.height);
    const NearestPhotons nearest =
        map.nearest(query_at(context.scene, point, 100.0 * pixel), static_cast<std::size_t>(settings.test_photons),
                    [](const Photon&, double, double) {});
    return nearest.squared_radius * just_inside * just_inside;
}

}  // namespace photonlab
