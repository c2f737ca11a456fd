#include "experiment/runner.h"

#include <ctime>

#include <chrono>
#include <numeric>

#include "integrators/registry.h"

namespace photonlab {

namespace {

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double process_cpu_seconds() {
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
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

void StageClock::stop() {
    if (!stage_) return;
    const auto index = static_cast<std::size_t>(*stage_);
    times_.seconds[index] += steady_seconds() - began_;
    times_.cpu_seconds[index] += process_cpu_seconds() - cpu_began_;
    stage_.reset();
}

RunState run_method(const Scene& scene, const HitPoints& hit_points, const RunSettings& settings,
                    const EstimateListener& on_estimate, const PassListener& on_pass) {
    const IntegratorContext context{scene, hit_points, settings.seed, settings.threads, RandomPurpose::CameraPaths};
    const std::unique_ptr<Integrator> integrator = make_integrator(settings.method, context);
    const bool needs_photons = find_integrator_kind(settings.method.integrator).needs_photons;
    const PhotonSettings photon_settings{settings.method.photons_per_pass, settings.seed, settings.method.max_depth,
                                         settings.method.direct == DirectMode::Photons};

    RunState state;
    state.report = integrator->report();
    state.initial_radius = state.report.radius_mean;
    StageTimes passes_alone;
    auto next_estimate = settings.estimated.begin();
    const auto estimate_if_asked = [&] {
        state.report = integrator->report();
        state.times = passes_alone;
        if (next_estimate == settings.estimated.end() || *next_estimate != state.pass) return;
        ++next_estimate;
        StageClock clock;
        const Image image = integrator->estimate([&](Stage stage) { clock.enter(stage); });
        clock.stop();
        state.times += clock.times();
        state.report = integrator->report();
        on_estimate(state, image);
    };

    estimate_if_asked();
    while (state.pass < settings.passes) {
        ++state.pass;
        StageClock clock;
        PhotonPass photons;
        if (needs_photons) {
            clock.enter(Stage::Trace);
            photons = trace_photons(scene, photon_settings, state.pass, settings.threads);
            clock.stop();
            state.paths_emitted += photons.paths_emitted;
            state.photons_stored += photons.photons.size();
            state.paths_cut += photons.paths_cut;
            state.power_cut += photons.power_cut;
            state.nonfinite_photons += photons.nonfinite;
        }
        integrator->run_pass(state.pass, photons, [&](Stage stage) { clock.enter(stage); });
        clock.stop();
        passes_alone += clock.times();
        estimate_if_asked();
        on_pass(state.pass);
    }
    return state;
}

}  // namespace photonlab
