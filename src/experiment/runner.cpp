#include "experiment/runner.h"

#include <ctime>

#include <algorithm>
#include <cassert>
#include <chrono>
#include <numeric>

#include "core/parallel.h"
#include "integrators/registry.h"

namespace photonlab {

namespace {

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double cpu_seconds(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double process_cpu_seconds() {
    return cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
}

double thread_cpu_seconds() {
    return cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
}

}  // namespace

double StageTimes::total() const {
    return std::accumulate(seconds.begin(), seconds.end(), 0.0);
}

double StageTimes::cpu_total() const {
    return std::accumulate(cpu_seconds.begin(), cpu_seconds.end(), 0.0);
}

StageTimes& StageTimes::operator+=(const StageTimes& other) {
    for (std::size_t stage = 0; stage < stage_count; ++stage) {
        seconds[stage] += other.seconds[stage];
        cpu_seconds[stage] += other.cpu_seconds[stage];
    }
    return *this;
}

void StageClock::enter(Stage stage) {
    stop();
    stage_ = stage;
    began_ = steady_seconds();
    cpu_began_ = process_cpu_seconds();
}

StageTimes times_alone(const OverlappedWork& work, std::size_t method) {
    const double direct_cpu = work.direct_cpu[method];
    const double own_cpu = work.build_cpu + direct_cpu;
    const double all_cpu = std::accumulate(work.direct_cpu.begin(), work.direct_cpu.end(), work.build_cpu);
    StageTimes times;
    if (!(own_cpu > 0.0)) return times;
    const double seconds = std::max(work.build_seconds, work.seconds * (own_cpu / all_cpu));
    const auto build = static_cast<std::size_t>(Stage::Build);
    const auto direct = static_cast<std::size_t>(Stage::Direct);
    times.seconds[build] = seconds * (work.build_cpu / own_cpu);
    times.seconds[direct] = seconds * (direct_cpu / own_cpu);
    times.cpu_seconds[build] = work.build_cpu;
    times.cpu_seconds[direct] = direct_cpu;
    return times;
}

void StageClock::stop() {
    if (!stage_) return;
    const auto index = static_cast<std::size_t>(*stage_);
    times_.seconds[index] += steady_seconds() - began_;
    times_.cpu_seconds[index] += process_cpu_seconds() - cpu_began_;
    stage_.reset();
}

namespace {

/// One of the methods that run side by side.
struct RunningMethod {
    std::unique_ptr<Integrator> integrator;
    PhotonNeed needs;
    RunState state;
    StageTimes passes_alone;      // without estimates
    std::uint64_t next_pass = 0;  // 0: its first image is still to be shown

    /// See Continuation. The initial radius is that of the integrator as it was made.
    void exchange(StateArchive& archive) {
        archive.exchange(state.pass);
        archive.exchange(state.paths_emitted);
        archive.exchange(state.photons_stored);
        archive.exchange(state.paths_cut);
        archive.exchange(state.power_cut);
        archive.exchange(state.nonfinite_photons);
        archive.exchange(passes_alone);
        integrator->exchange(archive);
        if (archive.reads()) next_pass = state.pass + 1;
    }
};

/// Times one step of the supply.
template <typename Step>
StageTimes timed(Stage stage, const Step& step) {
    StageClock clock;
    clock.enter(stage);
    step();
    clock.stop();
    return clock.times();
}

/// Adds what a shared step of a pass took to each method that takes the pass and needs the step, as if it were alone.
void charge(std::vector<RunningMethod>& methods, std::uint64_t pass, PhotonNeed need, const StageTimes& times) {
    for (RunningMethod& method : methods)
        if (method.needs == need && method.next_pass == pass) method.passes_alone += times;
}

/// Indexes the photons of the pass and samples the direct light of the methods that gather them, which needs no
/// photons: FLANN builds on one thread, and the others would wait for it.
void index_and_light(PhotonSupply& photons, std::vector<RunningMethod>& methods, std::uint64_t pass, int threads) {
    struct DirectBlock {
        std::size_t method;
        std::size_t block;
    };
    std::vector<std::size_t> gathering;
    std::vector<DirectBlock> blocks;
    for (std::size_t i = 0; i < methods.size(); ++i) {
        if (methods[i].needs != PhotonNeed::PassMap || methods[i].next_pass != pass) continue;
        const std::size_t count = methods[i].integrator->begin_direct(pass);
        for (std::size_t block = 0; block < count; ++block) blocks.push_back({gathering.size(), block});
        gathering.push_back(i);
    }

    OverlappedWork work;
    work.direct_cpu.assign(gathering.size(), 0.0);
    std::vector<double> cpu_of(blocks.size());
    const double began = steady_seconds();
    parallel_for(1 + blocks.size(), threads, [&](std::size_t item) {
        const double cpu_began = thread_cpu_seconds();
        if (item == 0) {
            photons.index_pass();
            work.build_seconds = steady_seconds() - began;
            work.build_cpu = thread_cpu_seconds() - cpu_began;
        } else {
            const DirectBlock& direct = blocks[item - 1];
            methods[gathering[direct.method]].integrator->add_direct(direct.block);
            cpu_of[item - 1] = thread_cpu_seconds() - cpu_began;
        }
    });
    work.seconds = steady_seconds() - began;
    for (std::size_t i = 0; i < blocks.size(); ++i) work.direct_cpu[blocks[i].method] += cpu_of[i];
    for (std::size_t i = 0; i < gathering.size(); ++i) methods[gathering[i]].passes_alone += times_alone(work, i);
}

PhotonSettings photons_of(const RunSettings& settings) {
    return {.paths = settings.method.photons_per_pass,
            .seed = settings.seed,
            .max_depth = settings.method.max_depth,
            .store_direct = settings.method.direct == DirectMode::Photons};
}

}  // namespace

bool can_run_together(const RunSettings& a, const RunSettings& b) {
    const auto traces = [](const RunSettings& settings) {
        return find_integrator_kind(settings.method.integrator).needs != PhotonNeed::None;
    };
    return traces(a) && traces(b) && photons_of(a) == photons_of(b) && a.passes == b.passes && a.threads == b.threads &&
           a.estimated == b.estimated && a.method.branch_cutoff == b.method.branch_cutoff;
}

std::vector<RunState> run_methods(const Scene& scene, const HitPoints& hit_points,
                                  const std::vector<RunSettings>& settings, const EstimateListener& on_estimate,
                                  const PassListener& on_pass, const GatherListener& on_gather,
                                  const Continuation& continuation) {
    const RunSettings& common = settings.at(0);
    std::vector<RunningMethod> methods;
    for (const RunSettings& one : settings) {
        assert(settings.size() == 1 || can_run_together(common, one));
        RunningMethod method;
        method.integrator = make_integrator(one.method, {scene, hit_points, one.seed, one.threads});
        method.needs = find_integrator_kind(one.method.integrator).needs;
        method.state.report = method.integrator->report();
        method.state.initial_radius = method.state.report.radius_mean;
        methods.push_back(std::move(method));
    }
    std::vector<StateExchange> states;
    for (RunningMethod& method : methods)
        states.push_back([&method](StateArchive& archive) { method.exchange(archive); });
    if (continuation.restore)
        for (std::size_t i = 0; i < methods.size(); ++i) continuation.restore(i, states[i]);

    const auto is_any = [&](const auto& holds) { return std::any_of(methods.begin(), methods.end(), holds); };
    const bool needs_all_passes = is_any([](const auto& method) { return method.needs == PhotonNeed::AllPassesMaps; });
    const PhotonSettings photon_settings = photons_of(common);
    PhotonSupply photons;

    const auto end_pass = [&](std::uint64_t pass) {
        const bool is_asked = std::binary_search(common.estimated.begin(), common.estimated.end(), pass);
        const bool needs_maps = is_asked && is_any([&](const RunningMethod& method) {
                                    return method.needs == PhotonNeed::AllPassesMaps && method.next_pass == pass;
                                });
        StageTimes shared;
        if (needs_maps) shared = timed(Stage::Build, [&] { photons.index_all_passes(); });
        for (std::size_t i = 0; i < methods.size(); ++i) {
            RunningMethod& method = methods[i];
            if (method.next_pass != pass) continue;
            ++method.next_pass;
            method.state.times = method.passes_alone;
            if (!is_asked) continue;
            StageClock clock;
            const Image image = method.integrator->estimate(photons, [&](Stage stage) { clock.enter(stage); });
            clock.stop();
            method.state.times += clock.times();
            if (method.needs == PhotonNeed::AllPassesMaps) {
                method.state.times += shared;
                on_gather(i, pass, *method.integrator);
            }
            method.state.report = method.integrator->report();
            on_estimate(i, method.state, image);
        }
        photons.drop_maps_of_all_passes();
    };

    end_pass(0);
    for (std::uint64_t pass = 1; pass <= common.passes; ++pass) {
        const bool is_new = is_any([&](const RunningMethod& method) { return method.next_pass == pass; });
        const bool needs_pass_map = is_any([&](const RunningMethod& method) {
            return method.needs == PhotonNeed::PassMap && method.next_pass == pass;
        });
        if (needs_pass_map || needs_all_passes) {
            PhotonPass traced;
            const StageTimes tracing =
                timed(Stage::Trace, [&] { traced = trace_photons(scene, photon_settings, pass, common.threads); });
            for (RunningMethod& method : methods) {
                if (method.next_pass != pass) continue;
                method.passes_alone += tracing;
                method.state.paths_emitted += traced.paths_emitted;
                method.state.photons_stored += traced.photons.size();
                method.state.paths_cut += traced.paths_cut;
                method.state.power_cut += traced.power_cut;
                method.state.nonfinite_photons += traced.nonfinite;
            }
            photons.begin_pass(std::move(traced));
        }
        if (needs_all_passes)
            charge(methods, pass, PhotonNeed::AllPassesMaps, timed(Stage::Build, [&] { photons.add_pass(); }));
        if (needs_pass_map) index_and_light(photons, methods, pass, common.threads);
        for (std::size_t i = 0; i < methods.size(); ++i) {
            RunningMethod& method = methods[i];
            if (method.next_pass != pass) continue;
            StageClock clock;
            method.integrator->run_pass(pass, photons, [&](Stage stage) { clock.enter(stage); });
            clock.stop();
            method.passes_alone += clock.times();
            method.state.pass = pass;
            if (method.needs == PhotonNeed::PassMap) on_gather(i, pass, *method.integrator);
        }
        photons.end_pass();
        end_pass(pass);
        on_pass(pass, is_new);
        if (continuation.goes_on && !continuation.goes_on(pass, states)) break;
    }
    std::vector<RunState> last;
    for (RunningMethod& method : methods) {
        method.state.report = method.integrator->report();
        last.push_back(method.state);
    }
    return last;
}

}  // namespace photonlab
