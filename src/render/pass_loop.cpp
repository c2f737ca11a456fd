#include "render/pass_loop.h"

#include <algorithm>
#include <cassert>
#include <numeric>

#include "core/parallel.h"
#include "transport/camera/camera_pass.h"

namespace photonlab {

namespace {

/// One sequence over all passes is for methods in which no pass follows from those before: where one does, what it
/// draws must not either, or the two conspire. With Hachisuka's radii that is a bias of 0.2% (docs/theory.md, section
/// 13).
EmissionNumbers emission_of(const MethodSettings& method) {
    if (method.light_sequence == LightSequenceMode::Independent) return EmissionNumbers::Independent;
    const Needs needs = needs_of(method);
    const bool none_follows =
        needs.passes == Needs::Passes::Independent || needs.photons == Needs::Photons::OfAllPasses;
    return none_follows ? EmissionNumbers::SobolOfAllPasses : EmissionNumbers::SobolOfPass;
}

LoopLayerSettings layers_of(const RunSettings& settings, const Needs& needs, RandomPurpose purpose) {
    const bool samples = needs.direct == Needs::Direct::ByLoop && settings.method.direct == DirectMode::Sampled;
    return {.has_new_points = needs.new_points.has_value(),
            .goes_on = needs.new_points && needs.new_points->gather_roughness > 0.0,
            .direct_samples = samples ? settings.method.direct_samples : 0,
            .max_depth = settings.method.max_depth,
            .seed = settings.seed,
            .threads = settings.threads,
            .has_exact_sums = needs.can_be_joined(),
            .direct_purpose = purpose};
}

/// Ranges that join come after those that are there.
void exchange_ranges(StateArchive& archive, std::vector<PassRange>& ranges) {
    if (!archive.joins()) return archive.exchange(ranges);
    std::vector<PassRange> read;
    archive.exchange(read);
    ranges.insert(ranges.end(), read.begin(), read.end());
}

/// What a method's own part of an image is.
Stage stage_of(const Needs& needs) {
    return needs.photons == Needs::Photons::None ? Stage::Trace : Stage::Gather;
}

/// The same of a pass.
Stage stage_of_pass(const Needs& needs) {
    return needs.holds_photons ? Stage::Relax : stage_of(needs);
}

}  // namespace

PhotonSettings photon_settings(const RunSettings& settings, RandomPurpose purpose) {
    return {.paths = settings.method.photons_per_pass,
            .seed = settings.seed,
            .max_depth = settings.method.max_depth,
            .store_direct = settings.method.direct == DirectMode::Photons,
            .purpose = purpose,
            .emission = emission_of(settings.method)};
}

bool can_run_together(const RunSettings& a, const RunSettings& b) {
    const auto photons = [](const RunSettings& settings) { return photon_settings(settings); };
    const auto traces = [](const RunSettings& settings) {
        return needs_of(settings.method).photons != Needs::Photons::None;
    };
    const auto shares = [](const RunSettings& settings) { return !needs_of(settings.method).has_own_photons; };
    return traces(a) && traces(b) && shares(a) && shares(b) && photons(a) == photons(b) && a.passes == b.passes &&
           a.threads == b.threads && a.shown == b.shown && a.method.branch_cutoff == b.method.branch_cutoff;
}

PassLoop::PassLoop(const Scene& scene, const HitPoints& hit_points, const std::vector<RunSettings>& settings,
                   const LoopPurposes& purposes, const std::vector<IntegratorKind>& kinds)
    : scene_(scene),
      hit_points_(hit_points),
      source_(scene, photon_settings(settings.at(0), purposes.photons), settings[0].threads, settings[0].method,
              find_integrator_kind(settings[0].method.integrator, kinds).needs(settings[0].method)),
      branch_cutoff_(settings[0].method.branch_cutoff),
      threads_(settings[0].threads),
      positions_purpose_(purposes.positions) {
    for (const RunSettings& one : settings) {
        assert(settings.size() == 1 || can_run_together(settings[0], one));
        const IntegratorKind& kind = find_integrator_kind(one.method.integrator, kinds);
        const Needs needs = kind.needs(one.method);
        Method method{make_integrator(kind, one.method, {scene, hit_points, one.seed, one.threads, purposes.paths}),
                      needs,
                      LoopLayers(scene, hit_points, layers_of(one, needs, purposes.direct)),
                      {},
                      one.shows_counts};
        describe(method, method.state);
        method.state.initial_radius = method.state.report.radius_mean;
        methods_.push_back(std::move(method));
    }
    if (settings[0].learnt) freeze_emission(*settings[0].learnt);
}

void PassLoop::take(std::uint64_t pass) {
    make_points(pass);
    PhotonPass traced;
    if (keeps_all_photons() || is_any_due(pass, Needs::Photons::OfPass)) trace(pass, traced);
    take(pass, std::move(traced));
}

void PassLoop::take(std::uint64_t pass, PhotonPass traced) {
    for (Method& method : methods_) {
        if (!is_due(method, pass)) continue;
        method.state.paths_emitted += traced.paths_emitted;
        method.state.paths_traced += traced.paths_traced;
        if (traced.chains) {
            method.state.paths_seen = traced.seen_share;
            method.state.mutations_accepted = traced.chains->accepted;
            method.state.step_size = traced.chains->step_size;
        }
        method.state.photons_stored += traced.photons.size();
        method.state.paths_cut += traced.paths_cut;
        method.state.power_cut += traced.power_cut;
        method.state.nonfinite_photons += traced.nonfinite;
    }
    make_points(pass);
    photons_.begin_pass(std::move(traced));
    if (keeps_all_photons()) {
        const StageTimes adding = timed(Stage::Build, [&] { photons_.add_pass(); });
        for (Method& method : methods_)
            if (is_due(method, pass) && method.needs.photons == Needs::Photons::OfAllPasses)
                method.passes_alone += adding;
    }
    if (is_any_due(pass, Needs::Photons::OfPass)) index_and_light(pass);
    for (Method& method : methods_)
        if (is_due(method, pass)) take(method, pass);
    photons_.end_pass();
    new_points_.clear();
}

void PassLoop::trace(std::uint64_t pass, PhotonPass& traced) {
    const auto where_accepted = [&] {
        const Method& only = methods_[0];
        return only.integrator->accepting_discs({.number = pass, .points = points_of(only)});
    };
    const StageTimes tracing = timed(Stage::Trace, [&] { traced = source_.trace(pass, where_accepted); });
    for (Method& method : methods_)
        if (is_due(method, pass)) method.passes_alone += tracing;
}

/// Makes the new hit points of each kind that is wanted, once.
void PassLoop::make_points(std::uint64_t pass) {
    for (const Method& first : methods_) {
        if (!first.needs.new_points || !is_due(first, pass) || find_new_points(*first.needs.new_points)) continue;
        const NewPoints& kind = *first.needs.new_points;
        const StageTimes making = timed(Stage::Points, [&] {
            Camera camera = scene_.camera;  // or a coarser one, as that of the fixed points is
            camera.width = hit_points_.width;
            camera.height = hit_points_.height;
            new_points_.emplace_back(kind, trace_new_hit_points(scene_, camera, hit_points_.samples_per_pixel, kind,
                                                                {source_.settings().seed, positions_purpose_, pass},
                                                                threads_, branch_cutoff_));
        });
        for (Method& method : methods_)
            if (is_due(method, pass) && method.needs.new_points == kind) method.passes_alone += making;
    }
}

const HitPoints* PassLoop::find_new_points(const NewPoints& kind) const {
    for (const auto& [made, points] : new_points_)
        if (made == kind) return &points;
    return nullptr;
}

/// Indexes the photons of the pass and samples the direct light of the methods that gather them, which needs no
/// photons: FLANN builds on one thread, and the others would wait for it. Those that have no more light to sample take
/// part in sorting the photons.
void PassLoop::index_and_light(std::uint64_t pass) {
    struct DirectBlock {
        std::size_t gathering;
        std::size_t block;
    };
    std::vector<Method*> gathering;
    std::vector<DirectBlock> blocks;
    for (Method& method : methods_) {
        if (method.needs.photons != Needs::Photons::OfPass || !is_due(method, pass)) continue;
        const std::size_t count = method.layers.begin_pass(pass, points_of(method));
        for (std::size_t block = 0; block < count; ++block) blocks.push_back({gathering.size(), block});
        gathering.push_back(&method);
    }

    OverlappedWork work;
    work.direct_cpu.assign(gathering.size(), 0.0);
    std::vector<double> cpu_of(blocks.size());
    const double began = steady_seconds();
    const double all_cpu_began = process_cpu_seconds();
    parallel_for(1 + blocks.size(), threads_, [&](std::size_t item) {
        if (item == 0) {
            photons_.index_pass();
            work.build_seconds = steady_seconds() - began;
        } else {
            const DirectBlock& direct = blocks[item - 1];
            const double cpu_began = thread_cpu_seconds();
            gathering[direct.gathering]->layers.add_block(direct.block);
            cpu_of[item - 1] = thread_cpu_seconds() - cpu_began;
        }
    });
    work.seconds = steady_seconds() - began;
    work.build_cpu = process_cpu_seconds() - all_cpu_began - std::accumulate(cpu_of.begin(), cpu_of.end(), 0.0);
    for (std::size_t i = 0; i < blocks.size(); ++i) work.direct_cpu[blocks[i].gathering] += cpu_of[i];
    for (std::size_t i = 0; i < gathering.size(); ++i) gathering[i]->passes_alone += times_alone(work, i);
}

void PassLoop::light(Method& method, std::uint64_t pass) {
    const std::size_t blocks = method.layers.begin_pass(pass, points_of(method));
    parallel_for(blocks, threads_, [&](std::size_t block) { method.layers.add_block(block); });
}

void PassLoop::take(Method& method, std::uint64_t pass) {
    const PhotonMap* map = nullptr;
    if (method.needs.photons == Needs::Photons::OfPass) {
        map = &photons_.pass_map();
        method.state.map_bytes = std::max(method.state.map_bytes, map->bytes());
        method.state.nonfinite_in_maps += map->nonfinite();
    } else {
        method.passes_alone += timed(Stage::Direct, [&] { light(method, pass); });
    }
    method.layers.end_pass();
    std::vector<std::uint32_t> accepted(source_.is_told_of_photons() && map ? map->size() : 0);
    method.passes_alone += timed(stage_of_pass(method.needs), [&] {
        method.integrator->take({pass, points_of(method), map, photons_.paths_of_pass(), accepted});
        if (!photons_.cells_of_pass().empty())
            method.state.paths_seen = source_.learn(pass, *map, accepted, photons_.cells_of_pass());
    });
    method.state.pass = pass;
    std::vector<PassRange>& ranges = method.state.ranges;
    if (ranges.empty() || ranges.back().last + 1 != pass) ranges.push_back({pass, pass});
    ranges.back().last = pass;
    method.state.times = method.passes_alone;
}

StageTimes PassLoop::begin_images(const std::vector<std::size_t>& which) {
    const bool are_wanted = std::any_of(which.begin(), which.end(), [&](std::size_t method) {
        return methods_[method].needs.photons == Needs::Photons::OfAllPasses;
    });
    return are_wanted ? timed(Stage::Build, [&] { photons_.index_all_passes(); }) : StageTimes{};
}

/// What the method holds at hit points, as means over those of each pixel.
void PassLoop::add_gather_states(const Method& method, Image& image) const {
    const std::size_t pixels = pixel_count(hit_points_);
    std::vector<double> points(pixels, 0.0), radii(pixels, 0.0), counts(pixels, 0.0), densities(pixels, 0.0);
    bool has_density = true;
    for (std::size_t i = 0; i < hit_points_.points.size(); ++i) {
        const std::optional<GatherState> state = method.integrator->gather_state(i);
        if (!state) return;
        const std::uint32_t pixel = hit_points_.points[i].pixel;
        points[pixel] += 1.0;
        radii[pixel] += state->radius;
        counts[pixel] += state->photons;
        densities[pixel] += state->density.value_or(0.0);
        has_density = has_density && state->density;
    }
    const auto means_of = [&](const std::vector<double>& sums) {
        std::vector<float> means(pixels);
        for (std::size_t i = 0; i < pixels; ++i) means[i] = static_cast<float>(sums[i] / std::max(1.0, points[i]));
        return means;
    };
    image.radius = means_of(radii);
    if (!method.shows_counts) return;
    image.count = means_of(counts);
    if (has_density) image.density = means_of(densities);
}

Image PassLoop::image(std::size_t index, const StageTimes& indexing) {
    Method& method = methods_[index];
    method.state.times = method.passes_alone;
    std::optional<PhotonsOfAllPasses> all_passes;
    if (method.needs.photons == Needs::Photons::OfAllPasses) {
        all_passes.emplace(photons_.all_passes());
        method.state.times += indexing;
        method.state.map_bytes = photons_.bytes_of_all_passes();
        method.state.nonfinite_in_maps = all_passes->global.nonfinite() + all_passes->caustic.nonfinite();
    }
    std::vector<Color> direct;
    MethodLayers own;
    method.state.times += timed(Stage::Direct, [&] { direct = method.layers.direct(); });
    method.state.times +=
        timed(stage_of(method.needs), [&] { own = method.integrator->image(all_passes ? &*all_passes : nullptr); });
    if (method.needs.direct == Needs::Direct::ByItself) direct = std::move(own.direct);
    const std::vector<Color> more = method.layers.gathered();
    for (std::size_t pixel = 0; pixel < more.size(); ++pixel) own.gathered[pixel] += more[pixel];
    describe(method, method.state);
    Image image{hit_points_.width,
                hit_points_.height,
                {{std::string(emission_layer), method.layers.emission()},
                 {std::string(direct_layer), std::move(direct)},
                 {std::string(gathered_layer), std::move(own.gathered)}},
                std::move(own.estimated_error)};
    add_gather_states(method, image);
    return image;
}

Image PassLoop::image() {
    assert(methods_.size() == 1);
    Image image;
    show({0}, [&](std::size_t, Image shown) { image = std::move(shown); });
    return image;
}

void PassLoop::describe(const Method& method, RunState& state) const {
    state.report = method.integrator->report();
    state.report.inexact_additions += method.layers.inexact_additions();
    state.hit_point_bytes =
        photonlab::hit_point_bytes(hit_points_) + state.report.bytes + method.layers.bytes() + source_.bytes();
}

RunState PassLoop::state_now(std::size_t method) const {
    RunState state = methods_[method].state;
    describe(methods_[method], state);
    state.emission_map = source_.emission_map();
    return state;
}

void PassLoop::freeze_emission(const EmissionMap& learnt) {
    source_.freeze(learnt);
    Needs::Passes& passes = methods_[0].needs.passes;
    if (passes == Needs::Passes::AfterLearning) passes = Needs::Passes::Independent;
}

void PassLoop::exchange(std::size_t index, StateArchive& archive) {
    Method& method = methods_[index];
    RunState& state = method.state;
    archive.exchange_largest(state.pass);
    exchange_ranges(archive, state.ranges);
    archive.exchange_sum(state.paths_emitted);
    archive.exchange_sum(state.paths_traced);
    archive.exchange(state.paths_seen);
    archive.exchange(state.mutations_accepted);
    archive.exchange(state.step_size);
    archive.exchange_sum(state.photons_stored);
    archive.exchange_sum(state.paths_cut);
    archive.exchange_sum(state.power_cut);
    archive.exchange_sum(state.nonfinite_photons);
    archive.exchange_sum(state.nonfinite_in_maps);
    archive.exchange_largest(state.map_bytes);
    archive.exchange_sum(method.passes_alone);
    method.layers.exchange(archive);
    method.integrator->exchange(archive);
    source_.exchange(archive);
}

bool PassLoop::is_due(const Method& method, std::uint64_t pass) const {
    return method.state.pass + 1 == pass ||
           (method.state.pass == 0 && method.needs.passes == Needs::Passes::Independent);
}

bool PassLoop::is_any_due(std::uint64_t pass, Needs::Photons photons) const {
    return std::any_of(methods_.begin(), methods_.end(),
                       [&](const Method& method) { return method.needs.photons == photons && is_due(method, pass); });
}

/// Photons of all passes are kept from the first on, also while a method that was restored waits for its pass.
bool PassLoop::keeps_all_photons() const {
    return std::any_of(methods_.begin(), methods_.end(),
                       [](const Method& method) { return method.needs.photons == Needs::Photons::OfAllPasses; });
}

const HitPoints& PassLoop::points_of(const Method& method) const {
    return method.needs.new_points ? *find_new_points(*method.needs.new_points) : hit_points_;
}

}  // namespace photonlab
