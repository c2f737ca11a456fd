// Progressive photon mapping: gather radii that shrink as photons accumulate, so that bias and variance vanish together
// in bounded memory.
//
// Each pass makes a density estimate of its own at every hit point, with the radius before it shrinks, and the image is
// the running mean of these: the same numbers as the 2008 paper's shrinking flux, to rounding, and stable over millions
// of passes (docs/theory.md, section 1; a test shows it).
//
// [Hachisuka, Ogaki & Jensen 2008, "Progressive Photon Mapping"; Knaus & Zwicker 2011]

#include <cassert>

#include "core/parallel.h"
#include "gather/photon_map.h"
#include "gather/radius_schedule.h"
#include "gather/search_order.h"
#include "integrators/density_estimate.h"
#include "integrators/layers.h"
#include "integrators/registry.h"

namespace photonlab {

namespace {

constexpr double smallest_squared_radius = PhotonMap::minimum_radius * PhotonMap::minimum_radius;

class ProgressivePhotonMapping : public Integrator {
public:
    ProgressivePhotonMapping(const MethodSettings& settings, const IntegratorContext& context)
        : settings_(settings),
          context_(context),
          order_(context.hit_points.points),
          statistics_(context.hit_points.points.size()) {
        for (std::size_t i = 0; i < statistics_.size(); ++i) {
            const double radius = initial_radius(settings, context, i);
            statistics_[i].squared_radius = radius * radius;
        }
    }

    void take(const Pass& pass) override {
        if (passes_ == 0) begin_at(pass.number);
        ++passes_;
        const std::size_t blocks = block_count(statistics_.size(), hit_points_per_block);
        std::vector<std::uint64_t> gathered(blocks, 0);
        parallel_for(blocks, context_.threads, [&](std::size_t block) {
            const BlockRange range = block_range(block, statistics_.size(), hit_points_per_block);
            const std::vector<FluxSum> sums =
                gather_within(*pass.photons, context_.scene, pass.points.points, order_, range, settings_,
                              [&](std::size_t i) { return std::sqrt(statistics_[i].squared_radius); });
            for (std::size_t i = range.begin; i < range.end; ++i) {
                const FluxSum& sum = sums[i - range.begin];
                update(statistics_[i], sum, pass);
                gathered[block] += sum.count();
            }
        });
        for (const std::uint64_t count : gathered) photons_gathered_ += count;
    }

    MethodLayers image(const PhotonsOfAllPasses*) override {
        return {.gathered = to_pixels(
                    context_.hit_points, [&](std::size_t i) { return statistics_[i].estimate; },
                    context_.scene.total_power)};
    }

    IntegratorReport report() const override {
        IntegratorReport report{.photons_gathered = photons_gathered_,
                                .bytes = order_.bytes() + statistics_.size() * sizeof(GatherStatistics)};
        set_radii(
            report, statistics_.size(), [&](std::size_t i) { return std::sqrt(statistics_[i].squared_radius); },
            context_.scene.unit_length);
        return report;
    }

    std::optional<GatherState> gather_state(std::size_t hit_point) const override {
        const GatherStatistics& at = statistics_[hit_point];
        GatherState state;
        state.radius = std::sqrt(at.squared_radius) * context_.scene.unit_length;
        state.photons = at.count;
        if (settings_.schedule == ScheduleName::Hachisuka)
            state.density = at.count / (pi * state.radius * state.radius);
        state.radiance = at.estimate * context_.scene.total_power;
        return state;
    }

    void exchange(StateArchive& archive) override {
        archive.exchange(passes_);
        archive.exchange_as_many(statistics_);
        archive.exchange(photons_gathered_);
    }

private:
    /// Shrinks the radii as the passes before `pass` would have. Only a schedule that depends on the pass alone can.
    void begin_at(std::uint64_t pass) {
        assert(pass == 1 || settings_.schedule == ScheduleName::KnausZwicker);
        double shrink = 1.0;
        for (std::uint64_t before = 1; before < pass; ++before) shrink *= knaus_zwicker_shrink(settings_.alpha, before);
        for (GatherStatistics& statistics : statistics_)
            statistics.squared_radius = std::max(statistics.squared_radius * shrink, smallest_squared_radius);
    }

    /// One pass at one hit point.
    void update(GatherStatistics& statistics, const FluxSum& sum, const Pass& pass) const {
        const double area = pi * statistics.squared_radius;
        take_pass(statistics, settings_.schedule, settings_.alpha,
                  {.pass = pass.number,
                   .passes = passes_,
                   .found = static_cast<double>(sum.count()),
                   .estimate = sum.flux() / (area * static_cast<double>(pass.paths_emitted))},
                  smallest_squared_radius);
    }

    const MethodSettings settings_;
    const IntegratorContext context_;
    const SearchOrder order_;
    std::uint64_t passes_ = 0;                  // taken so far, from whichever pass they began at
    std::vector<GatherStatistics> statistics_;  // joined with the hit points by index
    std::uint64_t photons_gathered_ = 0;
};

}  // namespace

IntegratorKind ppm_kind() {
    return {.name = "ppm",
            .label = "PPM",
            .paper = "Hachisuka, Ogaki and Jensen 2008; Knaus and Zwicker 2011",
            .needs =
                [](const MethodSettings& settings) {
                    return Needs{.photons = Needs::Photons::OfPass,
                                 .passes = settings.schedule == ScheduleName::KnausZwicker ? Needs::Passes::Independent
                                                                                           : Needs::Passes::Ordered};
                },
            .settings = {"schedule", "alpha", "radius", "footprints", "kernel", "eps", "direct", "direct_samples",
                         "max_depth", "branch_cutoff", "photons_per_pass"},
            .make = make_integrator_of<ProgressivePhotonMapping>};
}

}  // namespace photonlab
