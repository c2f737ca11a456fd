#include "integrators/photonmapper.h"

#include "core/parallel.h"
#include "gather/photon_map.h"
#include "integrators/density_estimate.h"
#include "integrators/layers.h"

namespace photonlab {

namespace {

class PhotonMapping : public Integrator {
public:
    PhotonMapping(const MethodSettings& settings, const IntegratorContext& context)
        : settings_(settings), context_(context), direct_(context, settings), radii_(context.hit_points.points.size()) {
        const double bounding_radius = context.scene.bounding_radius;
        const double max_radius = settings.max_radius ? *settings.max_radius / context.scene.unit_length
                                                      : default_share_of_scene * bounding_radius;
        max_radius_ = std::max(max_radius, PhotonMap::minimum_radius);
        for (std::size_t i = 0; i < radii_.size(); ++i)
            radii_[i] = settings.mode == GatherMode::Radius
                            ? initial_radius(settings, context.scene, context.hit_points, i)
                            : max_radius_;
    }

    void run_pass(std::uint64_t pass, const PhotonPass& photons, const StageListener& enter) override {
        enter(Stage::Build);
        photons_.insert(photons_.end(), photons.photons.begin(), photons.photons.end());
        paths_emitted_ += photons.paths_emitted;
        enter(Stage::Direct);
        direct_.run_pass(pass);
    }

    Image estimate(const StageListener& enter) override {
        enter(Stage::Direct);
        std::vector<Color> direct = direct_.layer();
        return make_layers(context_.hit_points, settings_.max_depth, std::move(direct), gather(enter));
    }

    IntegratorReport report() const override {
        IntegratorReport report = report_;
        report.hit_point_bytes =
            context_.hit_points.points.size() * sizeof(HitPoint) + radii_.size() * sizeof(double) + direct_.bytes();
        set_radii(report, radii_, context_.scene.unit_length);
        return report;
    }

private:
    /// Mitsuba 0.6's default for its global map, in shares of the scene's bounding radius.
    static constexpr double default_share_of_scene = 0.05;

    std::vector<Color> gather(const StageListener& enter) {
        enter(Stage::Build);
        const PhotonMap map(photons_);
        report_.map_bytes = photons_.capacity() * sizeof(Photon) + map.bytes();
        report_.nonfinite = map.nonfinite();

        enter(Stage::Gather);
        const std::vector<HitPoint>& points = context_.hit_points.points;
        std::vector<ColorD> radiance(points.size(), ColorD(0.0));
        const std::size_t blocks = block_count(points.size(), hit_points_per_block);
        std::vector<std::uint64_t> gathered(blocks, 0);
        parallel_for(blocks, context_.threads, [&](std::size_t block) {
            const BlockRange range = block_range(block, points.size(), hit_points_per_block);
            for (std::size_t i = range.begin; i < range.end; ++i) {
                const FluxSum sum = settings_.mode == GatherMode::Radius
                                        ? gather_within(map, context_.scene, points[i], radii_[i], settings_.kernel,
                                                        settings_.max_depth)
                                        : gather_nearest(map, points[i], radii_[i]);
                radiance[i] = sum.flux() / (pi * radii_[i] * radii_[i]);
                gathered[block] += sum.count();
            }
        });
        report_.photons_gathered = 0;
        for (const std::uint64_t count : gathered) report_.photons_gathered += count;
        const double paths = static_cast<double>(std::max<std::uint64_t>(1, paths_emitted_));
        return to_pixels(context_.hit_points, radiance, context_.scene.total_power / paths);
    }

    /// The k nearest; `radius` becomes that of the disc to divide by.
    FluxSum gather_nearest(const PhotonMap& map, const HitPoint& point, double& radius) const {
        FluxSum sum(context_.scene, point, settings_.max_depth);
        const NearestPhotons nearest = map.nearest(
            point.position, point.normal, static_cast<std::size_t>(settings_.k), max_radius_,
            [&](const Photon& photon, double squared_distance, double squared_radius) {
                sum.add(photon, kernel_weight(settings_.kernel, std::min(1.0, squared_distance / squared_radius)));
            });
        radius = std::sqrt(nearest.squared_radius);
        return sum;
    }

    const MethodSettings settings_;
    const IntegratorContext context_;
    DirectLight direct_;
    std::vector<double> radii_;  // one a hit point, unit box: of the last gather; mode `radius`: fixed
    double max_radius_ = 0.0;
    std::vector<Photon> photons_;  // of all passes, in their order
    std::uint64_t paths_emitted_ = 0;
    IntegratorReport report_;
};

}  // namespace

std::unique_ptr<Integrator> make_photonmapper(const MethodSettings& settings, const IntegratorContext& context) {
    return std::make_unique<PhotonMapping>(settings, context);
}

}  // namespace photonlab
