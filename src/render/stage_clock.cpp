#include "render/stage_clock.h"

#include <ctime>

#include <algorithm>
#include <chrono>
#include <numeric>

namespace photonlab {

namespace {

double cpu_seconds(clockid_t clock) {
    timespec time{};
    clock_gettime(clock, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double thread_cpu_seconds() {
    return cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
}

double process_cpu_seconds() {
    return cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
}

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

StageTimes times_alone(const OverlappedWork& work, std::size_t method) {
    const double direct_cpu = work.direct_cpu[method];
    const double own_cpu = work.build_cpu + direct_cpu;
    const double all_cpu = std::accumulate(work.direct_cpu.begin(), work.direct_cpu.end(), work.build_cpu);
    StageTimes times;
    if (!(own_cpu > 0.0)) return times;
    // Beside methods with much direct light to sample, threads come late or never to take part in sorting, which they
    // would have done sooner for this one alone: it is charged too much, at most what they would have taken off
    // sorting, half of it with two threads. How long sorting took, and on which threads, is not measured.
    const double seconds = std::max(work.build_seconds, work.seconds * (own_cpu / all_cpu));
    const auto build = static_cast<std::size_t>(Stage::Build);
    const auto direct = static_cast<std::size_t>(Stage::Direct);
    times.seconds[build] = seconds * (work.build_cpu / own_cpu);
    times.seconds[direct] = seconds * (direct_cpu / own_cpu);
    times.cpu_seconds[build] = work.build_cpu;
    times.cpu_seconds[direct] = direct_cpu;
    return times;
}

}  // namespace photonlab
