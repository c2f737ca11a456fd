// Photon mapping, directly visualised: all photons of all passes so far, gathered at the hit points without final
// gathering. The baseline whose bias progressive photon mapping removes. Caustic photons, which came from the light by
// mirrors and glass alone, have a map and settings of their own.
//
// Mode `radius` averages over a fixed disc: with more photons its variance vanishes and its bias stays. Mode `nearest`
// averages over the k nearest photons: with more photons the disc and with it the bias shrink, and the variance stays
// near 1/k. Its memory grows with the passes. Mode `relaxed` is in
// relaxed_photon_mapping.cpp.
//
// [Jensen 1996, "Global Illumination using Photon Maps"; Jensen 2001, chapter 7]

#include "core/parallel.h"
#include "gather/map/photon_map.h"
#include "gather/map/search_order.h"
#include "integrators/density_estimate.h"
#include "integrators/layers.h"
#include "integrators/registry.h"
#include "integrators/relaxation/relaxed_photon_mapping.h"

namespace photonlab {

namespace {

/// How far around each hit point one of the two maps is searched.
struct Search {
    std::vector<double> radii;          ///< one a hit point, unit box: of the last gather; mode `radius`: fixed
    std::vector<std::uint32_t> counts;  ///< photons that each hit point found in the last gather
    double max_radius = 0.0;            ///< mode `nearest`, unit box
    std::size_t k = 0;                  ///< mode `nearest`
    GatherAreas areas;

    Search(const MethodSettings& settings, const IntegratorContext& context)
        : areas(context.scene, gather_area_settings(settings), context.hit_points.points.size()) {}

    /// Photons found in the last gather; none where there is no such map.
    std::uint32_t count_at(std::size_t hit_point) const { return counts.empty() ? 0 : counts[hit_point]; }

    /// How close these lie within their own disc, a squared unit of the unit box.
    double density_at(std::size_t hit_point) const {
        return counts.empty() ? 0.0 : counts[hit_point] / (pi * radii[hit_point] * radii[hit_point]);
    }

    std::uint64_t bytes() const {
        return radii.size() * sizeof(double) + counts.size() * sizeof(std::uint32_t) + areas.bytes();
    }
};

class PhotonMapping : public Integrator {
public:
    PhotonMapping(const MethodSettings& settings, const IntegratorContext& context)
        : settings_(settings),
          context_(context),
          order_(context.hit_points.points),
          global_(settings, context),
          caustic_(settings, context) {
        global_.k = static_cast<std::size_t>(settings.k);
        caustic_.k = static_cast<std::size_t>(settings.caustic_k);
        const Scene& scene = context.scene;
        global_.max_radius =
            chosen_radius(settings.max_radius, default_max_radius_share * scene.bounding_radius, scene);
        caustic_.max_radius =
            chosen_radius(settings.caustic_max_radius, default_caustic_share * global_.max_radius, scene);
        const std::size_t points = context.hit_points.points.size();
        global_.radii.assign(points, global_.max_radius);
        global_.counts.assign(points, 0);
        if (has_specular_surfaces(scene)) {
            caustic_.radii.assign(points, caustic_.max_radius);
            caustic_.counts.assign(points, 0);
        }
        radiance_.assign(points, ColorD(0.0));
        if (settings.mode == GatherMode::Nearest) return;
        for (std::size_t i = 0; i < points; ++i) {
            global_.radii[i] = initial_radius(settings, context, i);
            if (!caustic_.radii.empty())
                caustic_.radii[i] = chosen_radius(settings.caustic_radius, global_.radii[i], scene);
        }
    }

    void take(const Pass&) override {}

    MethodLayers image(const PhotonsOfAllPasses* photons) override {
        photons_gathered_ = 0;
        std::fill(radiance_.begin(), radiance_.end(), ColorD(0.0));
        gather(photons->global, global_);
        gather(photons->caustic, caustic_);
        scale_ = context_.scene.total_power / static_cast<double>(std::max<std::uint64_t>(1, photons->paths_emitted));
        return {.gathered = to_pixels(
                    context_.hit_points, [&](std::size_t i) { return radiance_[i]; }, scale_)};
    }

    /// Radii are those of the global map.
    IntegratorReport report() const override {
        IntegratorReport report{
            .photons_gathered = photons_gathered_,
            .bytes = radiance_.size() * sizeof(ColorD) + order_.bytes() + global_.bytes() + caustic_.bytes()};
        set_radii(
            report, global_.radii.size(), [&](std::size_t i) { return global_.radii[i]; }, context_.scene.unit_length);
        return report;
    }

    std::optional<GatherState> gather_state(std::size_t hit_point) const override {
        const double unit = context_.scene.unit_length;
        GatherState state;
        state.radius = global_.radii[hit_point] * unit;
        state.photons = global_.count_at(hit_point) + caustic_.count_at(hit_point);
        state.density = (global_.density_at(hit_point) + caustic_.density_at(hit_point)) / (unit * unit);
        state.radiance = radiance_[hit_point] * scale_;
        return state;
    }

    /// What was gathered is not kept: every image gathers anew.
    void exchange(StateArchive& archive) override { archive.exchange(photons_gathered_); }

private:
    /// Adds what the photons of one map bring to every hit point.
    void gather(const PhotonMap& map, Search& search) {
        if (map.size() == 0) return;
        const HitPointList& points = context_.hit_points.points;
        const std::size_t blocks = block_count(points.size(), hit_points_per_block);
        std::vector<std::uint64_t> gathered(blocks, 0);
        parallel_for(blocks, context_.threads, [&](std::size_t block) {
            const BlockRange range = block_range(block, points.size(), hit_points_per_block);
            const auto found =
                settings_.mode == GatherMode::Radius
                    ? gather_within(map, context_.scene, points, order_, range, settings_,
                                    [&](std::size_t i, const HitPoint& point) {
                                        return GatherReach{.radius = search.radii[i],
                                                           .area = area_around(search.areas, context_.scene, point, i,
                                                                               search.radii[i])};
                                    })
                    : gather_nearest(map, search, range);
            for (std::size_t i = range.begin; i < range.end; ++i) {
                const FluxSum& sum = found[i - range.begin].sum;
                radiance_[i] += sum.flux() / (pi * search.radii[i] * search.radii[i]);
                search.counts[i] = static_cast<std::uint32_t>(sum.count());
                gathered[block] += sum.count();
            }
        });
        for (const std::uint64_t count : gathered) photons_gathered_ += count;
    }

    /// The k nearest of each hit point; search.radii become those of the discs to divide by.
    std::vector<PointGather<NoMoments>> gather_nearest(const PhotonMap& map, Search& search, BlockRange range) const {
        std::vector<PointGather<NoMoments>> found;
        for (std::size_t i = range.begin; i < range.end; ++i) {
            const HitPoint& point = context_.hit_points.points[i];
            PointGather<NoMoments>& at = found.emplace_back(context_.scene, point, settings_.max_depth, GatherReach{});
            std::optional<GatherArea> area;  // in the k-th photon's ball
            const NearestPhotons nearest = map.nearest(
                query_at(context_.scene, point, search.max_radius), search.k,
                [&](const Photon& photon, double squared_distance, double squared_radius) {
                    if (!area) area = area_around(search.areas, context_.scene, point, i, std::sqrt(squared_radius));
                    at.add(context_.scene, photon, 1, squared_distance, squared_radius, *area, settings_.kernel);
                },
                settings_.eps);
            search.radii[i] = std::sqrt(nearest.squared_radius);
        }
        return found;
    }

    const MethodSettings settings_;
    const IntegratorContext context_;
    const SearchOrder order_;
    Search global_;
    Search caustic_;                // light that came by mirrors and glass alone; apart, since it is so much denser
    std::vector<ColorD> radiance_;  // one a hit point, of the last gather, in shares of all emitted light
    double scale_ = 0.0;            // what makes it radiance
    std::uint64_t photons_gathered_ = 0;  // in the last gather
};

}  // namespace

IntegratorKind photonmapper_kind() {
    return {
        .name = "photonmapper",
        .label = "PM",
        .paper = "Jensen 1996, directly visualised",
        .needs =
            [](const MethodSettings& settings) {
                if (is_relaxed(settings))
                    return Needs{.photons = Needs::Photons::OfPass,
                                 .holds_photons = true,
                                 .ordered_since = "it moves the photons that earlier passes left"};
                return Needs{.photons = Needs::Photons::OfAllPasses,
                             .ordered_since = "it gathers the photons of all passes together"};
            },
        .settings = gather_settings({"mode", "light_sequence", "k", "radius", "footprints", "max_radius", "caustic_k",
                                     "caustic_radius", "caustic_max_radius", "relaxation_steps", "features"}),
        .make =
            [](const MethodSettings& settings, const IntegratorContext& context) {
                return is_relaxed(settings) ? make_relaxed_photon_mapping(settings, context)
                                            : make_integrator_of<PhotonMapping>(settings, context);
            },
        .check =
            [](const MethodSettings& settings, const Scene& scene) {
                if (is_relaxed(settings)) require_relaxable(scene, settings.max_depth);
            }};
}

}  // namespace photonlab
