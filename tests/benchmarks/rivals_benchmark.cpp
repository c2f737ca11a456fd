// The gather layer beside a uniform grid and nanoflann, on the photons and radii of real passes: early, when radii are
// alike, and late, when they have spread. Before anything is timed the answers are compared, photon by photon; where
// they differ the benchmark is an error.

#include <benchmark/benchmark.h>

#include "rivals.h"
#include "work.h"

namespace photonlab::benchmarks {
namespace {

using benchmark::Counter;

double mean_radius(const std::vector<GatherQuery>& queries) {
    double sum = 0.0;
    for (const GatherQuery& query : queries) sum += query.radius;
    return sum / static_cast<double>(queries.size());
}

/// The three searchers: made from the photons and queries of a pass, and asked all queries at once.
struct Ours {
    PhotonMap map;
    Ours(const std::vector<Photon>& photons, const std::vector<GatherQuery>&) : map(photons) {}
    std::uint64_t bytes() const { return map.bytes(); }
    void gather(const std::vector<GatherQuery>& queries, std::vector<Found>& found) const {
        map.within_each(queries, [&](std::size_t i, const Photon& photon, double) { found[i].add(photon); });
    }
};

struct Nanoflann {
    NanoflannMap map;
    Nanoflann(const std::vector<Photon>& photons, const std::vector<GatherQuery>&) : map(photons) {}
    std::uint64_t bytes() const { return map.bytes(); }
    void gather(const std::vector<GatherQuery>& queries, std::vector<Found>& found) const {
        for (std::size_t i = 0; i < queries.size(); ++i)
            map.within(queries[i], [&](const Photon& photon) { found[i].add(photon); });
    }
};

struct Grid {
    UniformGrid map;
    Grid(const std::vector<Photon>& photons, const std::vector<GatherQuery>& queries)
        : map(photons, 2.0 * mean_radius(queries)) {}
    std::uint64_t bytes() const { return map.bytes(); }
    void gather(const std::vector<GatherQuery>& queries, std::vector<Found>& found) const {
        for (std::size_t i = 0; i < queries.size(); ++i)
            map.within(queries[i], [&](const Photon& photon) { found[i].add(photon); });
    }
};

template <typename Searcher>
std::vector<Found> answers(const Searcher& searcher, const std::vector<GatherQuery>& queries) {
    std::vector<Found> found(queries.size());
    searcher.gather(queries, found);
    return found;
}

template <typename Searcher>
void Build(benchmark::State& state) {
    const auto which = static_cast<std::size_t>(state.range(0));
    const std::vector<Photon>& photons = work().photons[which];
    for (auto _ : state) benchmark::DoNotOptimize(Searcher(photons, work().queries[which]));
    state.counters["photons/s"] = Counter(static_cast<double>(photons.size()), Counter::kIsIterationInvariantRate);
}

template <typename Searcher>
void Gather(benchmark::State& state) {
    const auto which = static_cast<std::size_t>(state.range(0));
    const std::vector<GatherQuery>& queries = work().queries[which];
    const Searcher searcher(work().photons[which], queries);
    if (const auto wrong =
            difference(answers(Ours(work().photons[which], queries), queries), answers(searcher, queries)))
        state.SkipWithError(wrong->c_str());
    for (auto _ : state) benchmark::DoNotOptimize(answers(searcher, queries));
    state.counters["queries/s"] = Counter(static_cast<double>(queries.size()), Counter::kIsIterationInvariantRate);
    state.counters["bytes_a_photon"] =
        static_cast<double>(searcher.bytes()) / static_cast<double>(work().photons[which].size());
}

BENCHMARK_TEMPLATE(Build, Ours)->ArgName("late")->Arg(0)->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(Build, Nanoflann)->ArgName("late")->Arg(0)->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(Build, Grid)->ArgName("late")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(Gather, Ours)->ArgName("late")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(Gather, Nanoflann)->ArgName("late")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(Gather, Grid)->ArgName("late")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace photonlab::benchmarks
