// What ppm and sppm share: their settings as those of a radius rule, what they ask of a gather, where radii begin, and
// what regions accumulate.

#pragma once

#include <cmath>
#include <string_view>
#include <vector>

#include "gather/radii/adaptive_radius.h"
#include "gather/radii/radius_rule.h"
#include "integrators/density_estimate.h"
#include "integrators/pass_sums.h"

namespace photonlab {

/// No radius shrinks below it.
inline constexpr double smallest_squared_radius = PhotonMap::minimum_radius * PhotonMap::minimum_radius;

/// What the loop has to give: passes of a blind schedule can be taken from any number on, as long as their photons do
/// not follow from those of earlier ones.
inline Needs progressive_needs(const MethodSettings& settings) {
    Needs needs{.photons = Needs::Photons::OfPass,
                .has_own_photons = emits_adaptively(settings) || traces_visible_paths(settings)};
    if (!is_blind(settings.schedule))
        needs.ordered_since = "its radii follow from what earlier passes found; those of schedule knaus-zwicker do not";
    else if (traces_visible_paths(settings))
        needs.ordered_since = "the chains of photon_paths visible go on from where earlier passes left them";
    else if (settings.estimate_error == ErrorEstimation::On)
        needs.ordered_since = "estimate_error compares each pass with the mean of those before";
    else
        needs.passes = emits_adaptively(settings) ? Needs::Passes::AfterLearning : Needs::Passes::Independent;
    return needs;
}

/// Whether the curvature of the light is asked for around each hit point: by the rule of the radii, or to tell the
/// bias.
inline bool wants_curvature(const MethodSettings& settings, const RadiusRule& rule) {
    return settings.estimate_error == ErrorEstimation::On || rule.wants_curvature();
}

/// The names of what both use, after those that only one has.
inline std::vector<std::string_view> progressive_settings(std::vector<std::string_view> own = {}) {
    for (const std::string_view name :
         {"photon_paths", "step_rule", "emission", "learn_passes", "light_sequence", "schedule", "alpha", "kappa",
          "smallest_radius", "largest_radius", "laplacian_radius", "test_variant", "start", "test_photons",
          "test_shrink", "test_growth", "estimate_error", "radius", "footprints"})
        own.push_back(name);
    return gather_settings(std::move(own));
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

/// What all squared radii of a pass under a blind rule have been multiplied by: one number, shrunk pass by pass from
/// the first, whichever pass a run begins at.
class BlindShrink {
public:
    double before(const RadiusRule& rule, std::uint64_t pass) {
        if (pass < pass_) *this = {};
        while (pass_ < pass) shrink_ *= rule.shrink_after(pass_++);
        return shrink_;
    }

private:
    std::uint64_t pass_ = 1;
    double shrink_ = 1.0;
};

/// What the regions of a method accumulate. Where passes can be joined, estimates are kept as exact sums: `estimate` is
/// then nearest to the sum over passes, and the rest is beside it.
class RegionStatistics {
public:
    RegionStatistics(std::size_t regions, double squared_radius, bool can_be_joined)
        : statistics_(regions, GatherStatistics{.squared_radius = squared_radius}),
          rests_(can_be_joined ? regions : 0) {}

    std::size_t size() const { return statistics_.size(); }
    GatherStatistics& operator[](std::size_t region) { return statistics_[region]; }
    const GatherStatistics& operator[](std::size_t region) const { return statistics_[region]; }

    /// take_pass() of one region; on any thread.
    void take(std::size_t region, RadiusRule& rule, const PassGather& gathered) {
        GatherStatistics& at = statistics_[region];
        if (!rests_.are_kept()) return take_pass(at, rule, region, gathered, smallest_squared_radius);
        rests_.add(at.estimate, region, gathered.estimate);
        take_radius(at, rule, region, gathered, smallest_squared_radius);
    }

    /// Mean over so many passes of their own estimates.
    ColorD estimate(std::size_t region, std::uint64_t passes) const {
        const ColorD& kept = statistics_[region].estimate;
        return !rests_.are_kept() || passes == 0 ? kept : kept / static_cast<double>(passes);
    }

    std::uint64_t inexact_additions() const { return rests_.inexact_additions(); }
    std::uint64_t bytes() const { return statistics_.size() * sizeof(GatherStatistics) + rests_.bytes(); }

    void exchange(StateArchive& archive) {
        rests_.exchange_with(statistics_, archive,
                             [](GatherStatistics& here, const GatherStatistics& read, const auto& add) {
                                 here.squared_radius = read.squared_radius;
                                 here.count += read.count;
                                 add(here.estimate, read.estimate);
                             });
    }

private:
    std::vector<GatherStatistics> statistics_;
    SumRests rests_;  // of the estimates; none where they are running means
};

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
