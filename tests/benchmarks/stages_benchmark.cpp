// The stages of a pass, each alone, on one thread: photons, map, gather within radii and of the k nearest, and all of a
// pass of PPM. `./benchmark` runs them and leaves results/benchmarks.json.

#include <benchmark/benchmark.h>

#include "render/pass_loop.h"
#include "work.h"

namespace photonlab::benchmarks {
namespace {

using benchmark::Counter;

const char* label(std::int64_t which) {
    return which == 0 ? "early" : "late";
}

void PhotonPassStage(benchmark::State& state) {
    work();
    std::uint64_t photons = 0;
    std::uint64_t paths = 0;
    for (auto _ : state) {
        const PhotonPass pass = trace_pass(1);
        photons += pass.photons.size();
        paths += pass.paths_emitted;
    }
    state.counters["photons/s"] = Counter(static_cast<double>(photons), Counter::kIsRate);
    state.counters["paths/s"] = Counter(static_cast<double>(paths), Counter::kIsRate);
    state.counters["bytes_a_photon"] = sizeof(Photon);
}

void MapBuild(benchmark::State& state) {
    const std::vector<Photon>& photons = work().photons[0];
    std::uint64_t bytes = 0;
    for (auto _ : state) bytes = PhotonMap(photons).bytes();
    state.counters["photons/s"] = Counter(static_cast<double>(photons.size()), Counter::kIsIterationInvariantRate);
    state.counters["bytes"] = static_cast<double>(bytes);
    state.counters["bytes_a_photon"] = static_cast<double>(bytes) / static_cast<double>(photons.size());
}

void RadiusGather(benchmark::State& state) {
    const auto which = static_cast<std::size_t>(state.range(0));
    const std::vector<GatherQuery>& queries = work().queries[which];
    const PhotonMap map(work().photons[which]);
    const double eps = static_cast<double>(state.range(1)) / 10.0;
    std::uint64_t photons = 0;
    for (auto _ : state) {
        photons = 0;
        map.within_each(
            queries, [&](std::size_t, const Photon&, double) { ++photons; }, eps);
    }
    state.SetLabel(label(state.range(0)));
    state.counters["eps"] = eps;
    state.counters["queries/s"] = Counter(static_cast<double>(queries.size()), Counter::kIsIterationInvariantRate);
    state.counters["photons/s"] = Counter(static_cast<double>(photons), Counter::kIsIterationInvariantRate);
    state.counters["photons_a_query"] = static_cast<double>(photons) / static_cast<double>(queries.size());
    state.counters["bytes"] = static_cast<double>(map.bytes());
}

void NearestGather(benchmark::State& state) {
    const std::vector<GatherQuery>& queries = work().queries[0];
    const PhotonMap map(work().photons[0]);
    const auto k = static_cast<std::size_t>(state.range(0));
    const double eps = static_cast<double>(state.range(1)) / 10.0;
    constexpr std::size_t stride = 8;  // an eighth of the hit points: all of them take seconds
    std::uint64_t photons = 0;
    std::uint64_t asked = 0;
    for (auto _ : state) {
        photons = asked = 0;
        for (std::size_t i = 0; i < queries.size(); i += stride, ++asked)
            photons += map.nearest(
                              queries[i].position, queries[i].normal, k, 0.1, [](const Photon&, double, double) {}, eps)
                           .found;
    }
    state.counters["k"] = static_cast<double>(k);
    state.counters["eps"] = eps;
    state.counters["queries/s"] = Counter(static_cast<double>(asked), Counter::kIsIterationInvariantRate);
    state.counters["photons/s"] = Counter(static_cast<double>(photons), Counter::kIsIterationInvariantRate);
    state.counters["bytes"] = static_cast<double>(map.bytes());
}

void WholePass(benchmark::State& state) {
    PassLoop ppm(work().scene, work().hit_points, {{.method = work().method, .seed = seed}});
    std::uint64_t pass = 0;
    for (auto _ : state) ppm.take(++pass);
    const double hit_points = static_cast<double>(work().hit_points.points.size());
    const RunState run = ppm.state_now(0);
    state.counters["paths/s"] =
        Counter(static_cast<double>(work().method.photons_per_pass), Counter::kIsIterationInvariantRate);
    state.counters["queries/s"] = Counter(hit_points, Counter::kIsIterationInvariantRate);
    state.counters["bytes"] = static_cast<double>(run.map_bytes + run.hit_point_bytes);
    state.counters["bytes_a_hit_point"] = static_cast<double>(run.hit_point_bytes) / hit_points;
}

BENCHMARK(PhotonPassStage)->Unit(benchmark::kMillisecond);
BENCHMARK(MapBuild)->Unit(benchmark::kMillisecond);
BENCHMARK(RadiusGather)
    ->ArgNames({"late", "eps_tenths"})
    ->ArgsProduct({{0, 1}, {0, 5, 10, 40}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(NearestGather)
    ->ArgNames({"k", "eps_tenths"})
    ->ArgsProduct({{30, 120, 480}, {0, 10, 40}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(WholePass)->Unit(benchmark::kMillisecond)->Iterations(16);

}  // namespace
}  // namespace photonlab::benchmarks
