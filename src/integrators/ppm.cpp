#include "integrators/ppm.h"

#include <cassert>

#include "core/parallel.h"
#include "gather/photon_map.h"
#include "gather/radius_schedule.h"
#include "gather/search_order.h"
#include "integrators/density_estimate.h"
#include "integrators/layers.h"

namespace photonlab {

namespace {

constexpr double smallest_squared_radius = PhotonMap::minimum_radius * PhotonMap::minimum_radius;

class ProgressivePhotonMapping : public Integrator {
public:
    ProgressivePhotonMapping(const MethodSettings& settings, const IntegratorContext& context)
        : settings_(settings),
          context_(context),
          direct_(context, settings),
          order_(context.hit_points.points),
          statistics_(context.hit_points.points.size()) {
        for (std::size_t i = 0; i < statistics_.size(); ++i) {
            const double radius = initial_radius(settings, context, i);
            statistics_[i].squared_radius = radius * radius;
        }
    }

    void run_pass(std::uint64_t pass, const PhotonSupply& photons, const StageListener& enter) override {
        if (passes_ == 0) begin_at(pass);
        ++passes_;
        const PhotonMap& map = photons.pass_map();
        report_.map_bytes = std::max(report_.map_bytes, map.bytes());
        report_.nonfinite += map.nonfinite();

        enter(Stage::Gather);
        const std::size_t blocks = block_count(statistics_.size(), hit_points_per_block);
        std::vector<std::uint64_t> gathered(blocks, 0);
        parallel_for(blocks, context_.threads, [&](std::size_t block) {
            const BlockRange range = block_range(block, statistics_.size(), hit_points_per_block);
            const std::vector<FluxSum> sums =
                gather_within(map, context_.scene, context_.hit_points.points, order_, range, settings_,
                              [&](std::size_t i) { return std::sqrt(statistics_[i].squared_radius); });
            for (std::size_t i = range.begin; i < range.end; ++i) {
                const FluxSum& sum = sums[i - range.begin];
                update(statistics_[i], sum, photons.paths_of_pass(), pass);
                gathered[block] += sum.count();
            }
        });
        for (const std::uint64_t count : gathered) report_.photons_gathered += count;

        enter(Stage::Direct);
        direct_.run_pass(pass);
    }

    std::size_t begin_direct(std::uint64_t pass) override { return direct_.begin_pass(pass); }
    void add_direct(std::size_t block) override { direct_.add_block(block); }

    Image estimate(const PhotonSupply&, const StageListener& enter) override {
        enter(Stage::Direct);
        std::vector<Color> direct = direct_.layer();
        enter(Stage::Gather);
        return make_layers(context_.hit_points, settings_.max_depth, std::move(direct),
                           to_pixels(
                               context_.hit_points, [&](std::size_t i) { return statistics_[i].estimate; },
                               context_.scene.total_power));
    }

    IntegratorReport report() const override {
        IntegratorReport report = report_;
        report.hit_point_bytes = hit_point_bytes(context_.hit_points) + order_.bytes() +
                                 statistics_.size() * sizeof(GatherStatistics) + direct_.bytes();
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
        photonlab::exchange(archive, report_);
        direct_.exchange(archive);
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
    void update(GatherStatistics& statistics, const FluxSum& sum, std::uint64_t paths, std::uint64_t pass) const {
        const double area = pi * statistics.squared_radius;
        take_pass(statistics, settings_.schedule, settings_.alpha,
                  {.pass = pass,
                   .passes = passes_,
                   .found = static_cast<double>(sum.count()),
                   .estimate = sum.flux() / (area * static_cast<double>(paths))},
                  smallest_squared_radius);
    }

    const MethodSettings settings_;
    const IntegratorContext context_;
    DirectLight direct_;
    const SearchOrder order_;
    std::uint64_t passes_ = 0;                  // taken so far, from whichever pass they began at
    std::vector<GatherStatistics> statistics_;  // joined with the hit points by index
    IntegratorReport report_;
};

}  // namespace

std::unique_ptr<Integrator> make_ppm(const MethodSettings& settings, const IntegratorContext& context) {
    return std::make_unique<ProgressivePhotonMapping>(settings, context);
}

}  // namespace photonlab
