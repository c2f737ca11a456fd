// Photon mapping with photons that are moved apart, in memory that does not grow: those of the first pass stay, the
// primal ones, and all later photons bring them their flux.
//
// Passes 1, 2, 3 to 4, 5 to 8 and so on are epochs. After the first, the primal photons have their own flux and are
// moved apart (photon_relaxation.h). In a later one each new photon adds its flux to the nearest primal photon; at its
// end these have the flux of that epoch, and the image is theirs until the next one ends: the density estimate within a
// fixed radius, each photon counting its flux. Then they move once more, by that flux.
//
// It is not unbiased, and later passes take away less and less of the error: where primal photons lie, and how far each
// one's flux reaches, stays by chance. What it has is its size.
// [After Spencer & Jones 2009 and 2013; ours in all that their abstracts do not say.]

#include "integrators/relaxation/relaxed_photon_mapping.h"

#include <fmt/format.h>

#include <bit>

#include "core/error.h"
#include "core/parallel.h"
#include "gather/map/search_order.h"
#include "integrators/density_estimate.h"
#include "integrators/layers.h"
#include "integrators/relaxation/photon_relaxation.h"

namespace photonlab {

namespace {

class RelaxedPhotonMapping : public Integrator {
public:
    RelaxedPhotonMapping(const MethodSettings& settings, const IntegratorContext& context)
        : settings_(settings),
          context_(context),
          order_(context.hit_points.points),
          areas_(context.scene, gather_area_settings(settings), context.hit_points.points.size()) {
        const std::size_t points = context.hit_points.points.size();
        radii_.reserve(points);
        for (std::size_t i = 0; i < points; ++i) radii_.push_back(initial_radius(settings, context, i));
        counts_.assign(points, 0);
        radiance_.assign(points, ColorD(0.0));
    }

    void take(const Pass& pass) override {
        ++passes_;
        if (passes_ == 1) {
            std::vector<ColorD> own;
            for (const Photon& photon : pass.photons->photons()) own.push_back(ColorD(photon.power));
            shown_ =
                relaxed(context_.scene, with_power(*pass.photons, own, pass.paths), relaxation(), context_.threads);
            begin_epoch();
            return;
        }
        left_out_ += add_to_nearest(collecting(), *pass.photons, context_.threads, sums_);
        paths_of_epoch_ += pass.paths;
        if (!std::has_single_bit(passes_)) return;
        shown_ = with_power(collecting(), sums_, paths_of_epoch_);
        moved_ = relaxed(context_.scene, shown_, relaxation(), context_.threads);
        begin_epoch();
    }

    MethodLayers image(const PhotonsOfAllPasses*) override {
        const HitPointList& points = context_.hit_points.points;
        const std::size_t blocks = block_count(points.size(), hit_points_per_block);
        parallel_for(blocks, context_.threads, [&](std::size_t block) {
            const BlockRange range = block_range(block, points.size(), hit_points_per_block);
            const auto found = gather_within(
                shown_, context_.scene, points, order_, range, settings_, [&](std::size_t i, const HitPoint& point) {
                    return GatherReach{.radius = radii_[i],
                                       .area = area_around(areas_, context_.scene, point, i, radii_[i])};
                });
            for (std::size_t i = range.begin; i < range.end; ++i) {
                const FluxSum& sum = found[i - range.begin].sum;
                radiance_[i] = sum.flux() / (pi * radii_[i] * radii_[i]);
                counts_[i] = static_cast<std::uint32_t>(sum.count());
            }
        });
        photons_gathered_ = 0;
        for (const std::uint32_t count : counts_) photons_gathered_ += count;
        return {.gathered = to_pixels(
                    context_.hit_points, [&](std::size_t i) { return radiance_[i]; }, context_.scene.total_power)};
    }

    /// What was gathered is not kept: every image gathers anew.
    void exchange(StateArchive& archive) override {
        archive.exchange(passes_);
        archive.exchange(paths_of_epoch_);
        archive.exchange(sums_);
        archive.exchange(photons_gathered_);
        archive.exchange(left_out_);
        exchange_photons(archive, shown_);
        exchange_photons(archive, moved_);
    }

    IntegratorReport report() const override {
        IntegratorReport report{.photons_gathered = photons_gathered_,
                                .bytes = order_.bytes() + areas_.bytes() + radii_.size() * sizeof(double) +
                                         counts_.size() * sizeof(std::uint32_t) + radiance_.size() * sizeof(ColorD) +
                                         shown_.bytes() + moved_.bytes() + sums_.size() * sizeof(ColorD),
                                .photons_left_out = left_out_};
        set_radii(
            report, radii_.size(), [&](std::size_t i) { return radii_[i]; }, context_.scene.unit_length);
        return report;
    }

    std::optional<GatherState> gather_state(std::size_t hit_point) const override {
        GatherState state;
        state.radius = radii_[hit_point] * context_.scene.unit_length;
        state.photons = counts_[hit_point];
        state.density = counts_[hit_point] / (pi * state.radius * state.radius);
        state.radiance = radiance_[hit_point] * context_.scene.total_power;
        return state;
    }

private:
    RelaxationSettings relaxation() const {
        return {.steps = settings_.relaxation_steps, .protects_features = settings_.features == Features::Protected};
    }

    /// Those that the flux of this epoch goes to: in the second, that after the first pass, those that are shown.
    const PhotonMap& collecting() const { return moved_.size() > 0 ? moved_ : shown_; }

    void begin_epoch() {
        sums_.assign(collecting().size(), ColorD(0.0));
        paths_of_epoch_ = 0.0;
    }

    static void exchange_photons(StateArchive& archive, PhotonMap& map) {
        std::vector<Photon> photons(map.photons().begin(), map.photons().end());
        archive.exchange(photons);
        if (archive.reads()) map = PhotonMap(std::move(photons));
    }

    const MethodSettings settings_;
    const IntegratorContext context_;
    const SearchOrder order_;
    GatherAreas areas_;
    std::vector<double> radii_;          // one a hit point, unit box
    std::vector<std::uint32_t> counts_;  // photons that each found in the last gather
    std::vector<ColorD> radiance_;       // of the last gather, in shares of all emitted light
    std::uint64_t photons_gathered_ = 0;
    std::uint64_t left_out_ = 0;  // photons that found none to bring their flux to
    std::uint64_t passes_ = 0;
    PhotonMap shown_{std::vector<Photon>{}};  // with the flux a path of the last epoch that ended
    PhotonMap moved_{std::vector<Photon>{}};  // since then; none before the third pass
    std::vector<ColorD> sums_;                // what the photons of the epoch brought, one a photon of collecting()
    double paths_of_epoch_ = 0.0;
};

}  // namespace

std::unique_ptr<Integrator> make_relaxed_photon_mapping(const MethodSettings& settings,
                                                        const IntegratorContext& context) {
    return std::make_unique<RelaxedPhotonMapping>(settings, context);
}

void require_relaxable(const Scene& scene, int max_depth) {
    for (const Shape& shape : scene.shapes) {
        const Material& material = scene.materials[shape.material];
        if (may_look_different_from_elsewhere(material))
            throw InputError(
                fmt::format("material \"{}\": expected a diffuse one, mirrors or glass with mode "
                            "\"relaxed\", whose photons stand for light from all directions",
                            material.id));
        if (has_turned_normals(material))
            throw InputError(
                fmt::format("material \"{}\": expected normals that no texture turns with mode \"relaxed\", whose "
                            "photons stand for light from all directions",
                            material.id));
        if (max_depth >= 0 && may_be_specular(material))
            throw InputError(
                fmt::format("material \"{}\": expected no mirrors or glass where mode \"relaxed\" has a finite "
                            "max_depth, since its photons stand for light of all depths",
                            material.id));
    }
}

}  // namespace photonlab
