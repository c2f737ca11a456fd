// Progressive photon mapping: gather radii that shrink as photons accumulate, so that bias and variance vanish together
// in bounded memory.
//
// Each pass makes a density estimate of its own at every hit point, with the radius before it shrinks, and the image is
// the running mean of these: the same numbers as the 2008 paper's shrinking flux, to rounding, and stable over millions
// of passes (docs/theory.md, section 1; a test shows it). How the radius changes is a rule of
// gather/radii/radius_rule.h.
//
// [Hachisuka, Ogaki & Jensen 2008, "Progressive Photon Mapping"; Knaus & Zwicker 2011]

#include <optional>

#include "core/parallel.h"
#include "gather/map/photon_map.h"
#include "gather/map/search_order.h"
#include "integrators/error_estimate.h"
#include "integrators/layers.h"
#include "integrators/progressive.h"
#include "integrators/registry.h"

namespace photonlab {

namespace {

class ProgressivePhotonMapping : public Integrator {
public:
    ProgressivePhotonMapping(const MethodSettings& settings, const IntegratorContext& context)
        : settings_(settings),
          context_(context),
          order_(context.hit_points.points),
          rule_(make_radius_rule(radius_rule_settings(settings), context.hit_points.points.size())),
          areas_(context.scene, gather_area_settings(settings), context.hit_points.points.size()),
          statistics_(context.hit_points.points.size(), 0.0, progressive_needs(settings).can_be_joined()) {
        for (std::size_t i = 0; i < statistics_.size(); ++i) statistics_[i].squared_radius = initial_squared_radius(i);
        if (settings.estimate_error == ErrorEstimation::Off) return;
        error_.emplace(pixel_count(context.hit_points), statistics_.size());
        of_pass_.assign(statistics_.size(), 0.0);
    }

    void take(const Pass& pass) override {
        set_radii(pass);
        ++passes_;
        with_moments(wants_curvature(settings_, *rule_), rule_->wants_sectors(),
                     [&]<typename Moments>(std::type_identity<Moments>) { gather<Moments>(pass); });
        if (error_) take_pixels();
    }

    MethodLayers image(const PhotonsOfAllPasses*) override {
        const HitPointList& points = context_.hit_points.points;
        const double scale = context_.scene.total_power;
        MethodLayers layers{
            .gathered = to_pixels(
                context_.hit_points, [&](std::size_t i) { return statistics_.estimate(i, passes_); }, scale)};
        if (error_ && passes_ > 0)
            layers.estimated_error = error_->of_image(
                [&](const auto& add) {
                    for (std::size_t i = 0; i < points.size(); ++i) add(points[i].pixel, i, ColorD(points[i].weight));
                },
                settings_.kernel, scale, passes_);
        return layers;
    }

    IntegratorReport report() const override {
        IntegratorReport report{.photons_gathered = photons_gathered_,
                                .bytes = order_.bytes() + statistics_.bytes() + rule_->bytes() + areas_.bytes() +
                                         of_pass_.size() * sizeof(double) + (error_ ? error_->bytes() : 0),
                                .inexact_additions = statistics_.inexact_additions()};
        photonlab::set_radii(
            report, statistics_.size(), [&](std::size_t i) { return std::sqrt(statistics_[i].squared_radius); },
            context_.scene.unit_length);
        return report;
    }

    AcceptingDiscs accepting_discs(const Pass& pass) override {
        set_radii(pass);
        return discs_of_reaches(context_, settings_, pass.points.points,
                                [&](std::size_t i, const HitPoint& point) { return reach_of(i, point, passes_ + 1); });
    }

    std::optional<GatherState> gather_state(std::size_t hit_point) const override {
        const GatherStatistics& at = statistics_[hit_point];
        GatherState state;
        state.radius = std::sqrt(at.squared_radius) * context_.scene.unit_length;
        state.photons = at.count;
        if (settings_.schedule == ScheduleName::Hachisuka)
            state.density = at.count / (pi * state.radius * state.radius);
        state.radiance = statistics_.estimate(hit_point, passes_) * context_.scene.total_power;
        return state;
    }

    void exchange(StateArchive& archive) override {
        archive.exchange_sum(passes_);
        statistics_.exchange(archive);
        archive.exchange_sum(photons_gathered_);
        rule_->exchange(archive);
        if (error_) error_->exchange(archive);
    }

private:
    double initial_squared_radius(std::size_t hit_point) const {
        const double radius = initial_radius(settings_, context_, hit_point);
        return radius * radius;
    }

    /// Sets the radii of a pass where they do not follow from what earlier ones found.
    void set_radii(const Pass& pass) {
        if (is_blind(settings_.schedule)) {
            const double shrink = shrink_.before(*rule_, pass.number);
            for (std::size_t i = 0; i < statistics_.size(); ++i)
                statistics_[i].squared_radius = std::max(initial_squared_radius(i) * shrink, smallest_squared_radius);
        }
        if (passes_ > 0 || !starts_at_nearest(settings_)) return;
        parallel_for(statistics_.size(), context_.threads, [&](std::size_t i) {
            statistics_[i].squared_radius =
                nearest_squared_radius(*pass.photons, pass.points.points[i], settings_, context_);
        });
    }

    template <typename Moments>
    void gather(const Pass& pass) {
        const std::size_t blocks = block_count(statistics_.size(), hit_points_per_block);
        std::vector<std::uint64_t> gathered(blocks, 0);
        parallel_for(blocks, context_.threads, [&](std::size_t block) {
            const BlockRange range = block_range(block, statistics_.size(), hit_points_per_block);
            const std::vector<PointGather<Moments>> found = gather_within<Moments>(
                *pass.photons, context_.scene, pass.points.points, order_, range, settings_,
                [&](std::size_t i, const HitPoint& point) { return reach_of(i, point, passes_); }, pass.accepted);
            for (std::size_t i = range.begin; i < range.end; ++i) {
                const PointGather<Moments>& at = found[i - range.begin];
                update(i, at, pass);
                gathered[block] += at.sum.count();
            }
        });
        for (const std::uint64_t count : gathered) photons_gathered_ += count;
    }

    /// In the pass that is number `passes` of those taken here.
    GatherReach reach_of(std::size_t i, const HitPoint& point, std::uint64_t passes) {
        GatherReach reach{.radius = std::sqrt(statistics_[i].squared_radius)};
        reach.area = area_around(areas_, context_.scene, point, i, reach.radius);
        if (wants_curvature(settings_, *rule_))
            reach.bandwidth =
                std::sqrt(squared_curvature_bandwidth(settings_.laplacian_radius, initial_squared_radius(i), passes));
        return reach;
    }

    /// One pass at one hit point.
    template <typename Moments>
    void update(std::size_t i, const PointGather<Moments>& found, const Pass& pass) {
        const double squared_radius = statistics_[i].squared_radius;
        const double area = pi * squared_radius;
        const double paths = pass.paths;
        PassGather gathered{.pass = pass.number,
                            .passes = passes_,
                            .found = static_cast<double>(found.sum.count()),
                            .estimate = found.sum.flux() / (area * paths)};
        if constexpr (Moments::are_none) {
            statistics_.take(i, *rule_, gathered);
        } else {
            const MomentsOfPass moments = found.moments.of_pass(found.sum.factor(), paths, 1.0);
            gathered.initial_squared_radius = initial_squared_radius(i);
            gathered.curvature = &moments.curvature;
            gathered.sectors = &moments.sectors;
            if (error_) {
                error_->take_region(i, moments.curvature, squared_radius, passes_);
                of_pass_[i] = mean_channel(gathered.estimate * ColorD(pass.points.points[i].weight));
            }
            statistics_.take(i, *rule_, gathered);
        }
    }

    /// What the pass gave to the pixels.
    void take_pixels() {
        const HitPointList& points = context_.hit_points.points;
        std::vector<double> values(pixel_count(context_.hit_points), 0.0);
        for (std::size_t i = 0; i < points.size(); ++i) values[points[i].pixel] += of_pass_[i];
        for (std::size_t pixel = 0; pixel < values.size(); ++pixel) error_->take_pixel(pixel, values[pixel], passes_);
    }

    const MethodSettings settings_;
    const IntegratorContext context_;
    const SearchOrder order_;
    const std::unique_ptr<RadiusRule> rule_;
    GatherAreas areas_;
    std::uint64_t passes_ = 0;            // taken so far, from whichever pass they began at
    BlindShrink shrink_;                  // of a rule that is blind
    RegionStatistics statistics_;         // joined with the hit points by index
    std::optional<ErrorEstimate> error_;  // where it is asked for
    std::vector<double> of_pass_;         // what each hit point gave to its pixel in this pass, mean channel
    std::uint64_t photons_gathered_ = 0;
};

}  // namespace

IntegratorKind ppm_kind() {
    return {.name = "ppm",
            .label = "PPM",
            .paper = "Hachisuka, Ogaki and Jensen 2008; Knaus and Zwicker 2011",
            .needs = progressive_needs,
            .settings = progressive_settings(),
            .make = make_integrator_of<ProgressivePhotonMapping>};
}

}  // namespace photonlab
