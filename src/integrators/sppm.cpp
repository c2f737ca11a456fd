// Stochastic progressive photon mapping: new hit points in every pass, so that the image converges to the mean of the
// radiance over whatever they are drawn from: the area of the pixel, the lens, the ways behind glass. Statistics belong
// to the pixel.
//
// A pixel has one shrink factor S, and each of its hit points the radius r_1 sqrt(S), with r_1 its own initial radius:
// distant, mirrored and near points keep sensible discs. Where `radius` is given all r_1 are that, which is the paper's
// rule. As in ppm.cpp the image is the running mean of what the passes give by themselves; a pass whose path ends
// nowhere counts.
//
// [Hachisuka & Jensen 2009, "Stochastic Progressive Photon Mapping"; the shared factor is ours: docs/theory.md, section
// 9]

#include <algorithm>
#include <optional>

#include "core/parallel.h"
#include "gather/map/photon_map.h"
#include "gather/map/search_order.h"
#include "integrators/error_estimate.h"
#include "integrators/findable_light.h"
#include "integrators/layers.h"
#include "integrators/progressive.h"
#include "integrators/registry.h"

namespace photonlab {

namespace {

class StochasticProgressivePhotonMapping : public Integrator {
public:
    StochasticProgressivePhotonMapping(const MethodSettings& settings, const IntegratorContext& context)
        : settings_(settings),
          context_(context),
          pixels_(pixel_count(context.hit_points)),
          rule_(make_radius_rule(radius_rule_settings(settings), pixels_)),
          areas_(context.scene, gather_area_settings(settings), 0),
          statistics_(pixels_, 1.0, progressive_needs(settings).can_be_joined()) {
        if (settings.estimate_error == ErrorEstimation::On) error_.emplace(pixels_, pixels_);
        note_radii(context.hit_points);
        if (goes_on_somewhere())
            require_findable_light(context.scene, settings.max_depth, "cannot be rendered with glossy continue",
                                   "its caustics would be missing on glossy surfaces; use glossy gather");
    }

    void take(const Pass& pass) override {
        set_radii(pass);
        ++passes_;
        with_moments(wants_curvature(settings_, *rule_), rule_->wants_sectors(),
                     [&]<typename Moments>(std::type_identity<Moments>) { gather<Moments>(pass); });
        note_radii(pass.points);
    }

    MethodLayers image(const PhotonsOfAllPasses*) override {
        const double scale = context_.scene.total_power;
        MethodLayers layers;
        layers.gathered.reserve(pixels_);
        for (std::size_t pixel = 0; pixel < pixels_; ++pixel)
            layers.gathered.push_back(Color(statistics_.estimate(pixel, passes_) * scale));
        if (error_ && passes_ > 0)
            layers.estimated_error = error_->of_image(
                [&](const auto& add) {
                    for (std::size_t pixel = 0; pixel < pixels_; ++pixel) add(pixel, pixel, ColorD(1.0));
                },
                settings_.kernel, scale, passes_);
        return layers;
    }

    /// Radii are those that the hit points of the last pass would have in the next.
    IntegratorReport report() const override {
        IntegratorReport report = radii_;
        report.photons_gathered = photons_gathered_;
        report.bytes = statistics_.bytes() + rule_->bytes() + (error_ ? error_->bytes() : 0);
        report.inexact_additions = statistics_.inexact_additions();
        return report;
    }

    AcceptingDiscs accepting_discs(const Pass& pass) override {
        set_radii(pass);
        return discs_of_reaches(context_, settings_, pass.points.points, [&](std::size_t i, const HitPoint& point) {
            return reach_of(pass, i, point, passes_ + 1);
        });
    }

    /// Of the pixel that the hit point is in; the radius is that which this point would have.
    std::optional<GatherState> gather_state(std::size_t hit_point) const override {
        const std::uint32_t pixel = context_.hit_points.points[hit_point].pixel;
        const GatherStatistics& at = statistics_[pixel];
        GatherState state;
        state.radius =
            initial_radius(settings_, context_, hit_point) * std::sqrt(at.squared_radius) * context_.scene.unit_length;
        state.photons = at.count;
        state.radiance = statistics_.estimate(pixel, passes_) * context_.scene.total_power;
        return state;
    }

    void exchange(StateArchive& archive) override {
        archive.exchange_sum(passes_);
        statistics_.exchange(archive);
        archive.exchange_sum(photons_gathered_);
        exchange_radii(archive, radii_);
        rule_->exchange(archive);
        if (error_) error_->exchange(archive);
    }

private:
    bool goes_on_somewhere() const {
        if (settings_.glossy != GlossyMode::Continue) return false;
        const auto goes_on = [&](const Material& material) {
            const std::optional<float> alpha = roughness(material.bsdf);
            return alpha && (static_cast<double>(*alpha) < settings_.gather_roughness || !material.textures.empty());
        };
        return std::any_of(context_.scene.shapes.begin(), context_.scene.shapes.end(), [&](const Shape& shape) {
            const Material& material = context_.scene.materials[shape.material];
            return goes_on(material) || (material.back && goes_on(*material.back));
        });
    }

    /// Unit box; before any shrinking.
    double initial_radius_at(const HitPoints& points, std::size_t i) const {
        return initial_radius(settings_, context_.scene, points, i);
    }

    /// Unit box; of the pass that comes.
    double radius_at(const HitPoints& points, std::size_t i, std::uint32_t pixel) const {
        return initial_radius_at(points, i) * std::sqrt(statistics_[pixel].squared_radius);
    }

    /// For the report.
    void note_radii(const HitPoints& points) {
        photonlab::set_radii(
            radii_, points.points.size(), [&](std::size_t i) { return radius_at(points, i, points.points[i].pixel); },
            context_.scene.unit_length);
    }

    /// Sets the radii of a pass where they do not follow from what earlier ones found.
    void set_radii(const Pass& pass) {
        if (is_blind(settings_.schedule)) {
            const double shrink = shrink_.before(*rule_, pass.number);
            for (std::size_t pixel = 0; pixel < pixels_; ++pixel) statistics_[pixel].squared_radius = shrink;
        }
        if (passes_ > 0 || !starts_at_nearest(settings_)) return;
        std::vector<bool> has_begun(pixels_, false);
        for (std::size_t i = 0; i < pass.points.points.size(); ++i) {
            const HitPoint point = pass.points.points[i];
            if (has_begun[point.pixel]) continue;
            has_begun[point.pixel] = true;
            const double radius = initial_radius_at(pass.points, i);
            statistics_[point.pixel].squared_radius =
                nearest_squared_radius(*pass.photons, point, settings_, context_) / (radius * radius);
        }
    }

    template <typename Moments>
    void gather(const Pass& pass) {
        const HitPointList& points = pass.points.points;
        const SearchOrder order(points);
        std::vector<PassGather> of_pixels(pixels_);
        std::vector<MomentsOfPass> moments(Moments::are_none ? 0 : pixels_);
        std::vector<ColorD> estimates(points.size());
        std::vector<std::uint32_t> found(points.size());
        std::vector<MomentsOfPass> parts(Moments::are_none ? 0 : points.size());
        parallel_for(block_count(points.size(), hit_points_per_block), context_.threads, [&](std::size_t block) {
            const BlockRange range = block_range(block, points.size(), hit_points_per_block);
            const auto gathered = gather_within<Moments>(
                *pass.photons, context_.scene, points, order, range, settings_,
                [&](std::size_t i, const HitPoint& point) { return reach_of(pass, i, point, passes_); }, pass.accepted);
            for (std::size_t i = range.begin; i < range.end; ++i) {
                const PointGather<Moments>& at = gathered[i - range.begin];
                const HitPoint point = points[i];
                const double paths = pass.paths;
                const double radius = gather_radius_at(pass.points, i, point.pixel);
                const ColorD weight(point.weight);
                estimates[i] = weight * at.sum.flux() / (pi * radius * radius * paths);
                found[i] = static_cast<std::uint32_t>(at.sum.count());
                if constexpr (!Moments::are_none) {
                    const double unit = initial_radius_at(pass.points, i);
                    parts[i] = at.moments.of_pass(at.sum.factor() * weight, paths, unit * unit);
                }
            }
        });
        for (std::size_t i = 0; i < points.size(); ++i) {
            const std::uint32_t index = points[i].pixel;
            PassGather& pixel = of_pixels[index];
            pixel.estimate += estimates[i];
            pixel.found += found[i];
            photons_gathered_ += found[i];
            if constexpr (!Moments::are_none) moments[index] += parts[i];
        }
        take_pixels(pass, of_pixels, moments);
    }

    /// The same as what a gather can be asked for.
    double gather_radius_at(const HitPoints& points, std::size_t i, std::uint32_t pixel) const {
        return std::max(radius_at(points, i, pixel), PhotonMap::minimum_radius);
    }

    /// In the pass that is number `passes` of those taken here.
    GatherReach reach_of(const Pass& pass, std::size_t i, const HitPoint& point, std::uint64_t passes) const {
        GatherReach reach{.radius = gather_radius_at(pass.points, i, point.pixel)};
        if (!areas_.are_discs())
            reach.area = areas_.of_pass(surface_end(context_.scene, point), i, pass.number, reach.radius);
        if (wants_curvature(settings_, *rule_)) {
            const double unit = initial_radius_at(pass.points, i);
            reach.bandwidth = std::sqrt(squared_curvature_bandwidth(settings_.laplacian_radius, unit * unit, passes));
        }
        return reach;
    }

    void take_pixels(const Pass& pass, std::vector<PassGather>& of_pixels, const std::vector<MomentsOfPass>& moments) {
        for (std::size_t pixel = 0; pixel < pixels_; ++pixel) {
            PassGather& gathered = of_pixels[pixel];
            gathered.pass = pass.number;
            gathered.passes = passes_;
            if (!moments.empty()) {
                gathered.curvature = &moments[pixel].curvature;
                gathered.sectors = &moments[pixel].sectors;
            }
            if (error_) {
                error_->take_region(pixel, moments[pixel].curvature, statistics_[pixel].squared_radius, passes_);
                error_->take_pixel(pixel, mean_channel(gathered.estimate), passes_);
            }
            statistics_.take(pixel, *rule_, gathered);
        }
    }

    const MethodSettings settings_;
    const IntegratorContext context_;
    const std::size_t pixels_;
    const std::unique_ptr<RadiusRule> rule_;
    const GatherAreas areas_;
    std::uint64_t passes_ = 0;            // taken so far, from whichever pass they began at
    BlindShrink shrink_;                  // of a rule that is blind
    RegionStatistics statistics_;         // one a pixel; squared radii in shares of each hit point's initial one
    std::optional<ErrorEstimate> error_;  // where it is asked for
    IntegratorReport radii_;              // of which only the radii are set
    std::uint64_t photons_gathered_ = 0;
};

}  // namespace

IntegratorKind sppm_kind() {
    return {.name = "sppm",
            .label = "SPPM",
            .paper = "Hachisuka and Jensen 2009",
            .needs =
                [](const MethodSettings& settings) {
                    Needs needs = progressive_needs(settings);
                    needs.new_points = NewPoints{.positions = settings.positions, .branches = settings.branches};
                    if (settings.glossy == GlossyMode::Continue)
                        needs.new_points->gather_roughness = settings.gather_roughness;
                    return needs;
                },
            .settings = progressive_settings({"positions", "branches", "glossy", "gather_roughness"}),
            .make = make_integrator_of<StochasticProgressivePhotonMapping>};
}

}  // namespace photonlab
