// What the program's sizes of numbers buy: statistics in float for double, and photons of 24 and 16 bytes for 32. Only
// here, to justify what the program does.
//
// Statistics: a hit point's running mean, radius and count over many passes of known numbers, against the same in long
// double. Photons: their powers as a shared exponent [Ward 1991, "Real Pixels"] and, for 16 bytes, positions as 16-bit
// integers over the unit box; the error is that of the gathered flux over all hit points, the time that of looking at
// photons one after the other, which is what a gather does once its search has found them.

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>

#include "core/random.h"
#include "work.h"

namespace photonlab::benchmarks {
namespace {

using benchmark::Counter;

template <typename Number>
struct Statistics {
    Number squared_radius = Number(1);
    Number count = Number(0);
    std::array<Number, 3> estimate{};

    /// One pass of Hachisuka et al. 2008, as ppm.cpp has it.
    void update(const std::array<float, 3>& flux, float found, std::uint64_t pass) {
        const Number alpha(0.7);
        for (std::size_t c = 0; c < 3; ++c) {
            const Number radiance = Number(flux[c]) / squared_radius;
            estimate[c] += (radiance - estimate[c]) / static_cast<Number>(pass);
        }
        const Number n(found);
        if (n > 0) squared_radius *= (count + alpha * n) / (count + n);
        count += alpha * n;
    }
};

/// The numbers of a pass: photons that fall as the area does, with noise; the same for every precision.
struct PassNumbers {
    std::array<float, 3> flux;
    float found;
};
PassNumbers numbers_of(std::uint64_t point, std::uint64_t pass) {
    RandomStream random(seed, RandomPurpose::Test, static_cast<std::uint32_t>(pass), point);
    const float area = std::pow(static_cast<float>(pass), -0.3f);
    const float noise = 0.5f + random.next();
    return {{area * noise, 0.5f * area * noise, 0.1f * area * noise}, std::round(40.0f * area * noise)};
}

template <typename Number>
void StatisticsError(benchmark::State& state) {
    constexpr std::uint64_t points = 16;
    const auto passes = static_cast<std::uint64_t>(state.range(0));
    double radiance_error = 0.0;
    double radius_error = 0.0;
    for (auto _ : state)
        for (std::uint64_t point = 0; point < points; ++point) {
            Statistics<Number> statistics;
            Statistics<long double> exact;
            for (std::uint64_t pass = 1; pass <= passes; ++pass) {
                const PassNumbers numbers = numbers_of(point, pass);
                statistics.update(numbers.flux, numbers.found, pass);
                exact.update(numbers.flux, numbers.found, pass);
            }
            const auto relative = [](Number a, long double b) {
                return std::abs(static_cast<double>((static_cast<long double>(a) - b) / b));
            };
            radiance_error = std::max(radiance_error, relative(statistics.estimate[0], exact.estimate[0]));
            radius_error = std::max(radius_error, relative(statistics.squared_radius, exact.squared_radius));
        }
    state.counters["worst_radiance_error"] = radiance_error;
    state.counters["worst_area_error"] = radius_error;
}

template <typename Number>
void StatisticsUpdate(benchmark::State& state) {
    std::vector<Statistics<Number>> statistics(65536);
    const PassNumbers numbers = numbers_of(1, 1);
    std::uint64_t pass = 0;
    for (auto _ : state) {
        ++pass;
        for (Statistics<Number>& one : statistics) one.update(numbers.flux, numbers.found, pass);
        benchmark::ClobberMemory();
    }
    state.counters["updates/s"] = Counter(static_cast<double>(statistics.size()), Counter::kIsIterationInvariantRate);
    state.counters["bytes_a_hit_point"] = sizeof(Statistics<Number>);
}

struct SharedExponent {
    std::array<std::uint8_t, 4> bytes;

    explicit SharedExponent(const Color& power) {
        int exponent = 0;
        std::frexp(std::max({power.x, power.y, power.z}), &exponent);
        for (std::size_t c = 0; c < 3; ++c)
            bytes[c] = static_cast<std::uint8_t>(
                std::min(255.0f, std::round(std::ldexp(power[static_cast<int>(c)], 8 - exponent))));
        bytes[3] = static_cast<std::uint8_t>(exponent + 128);
    }
    Color power() const {
        const float unit = std::ldexp(1.0f, bytes[3] - 136);
        return {bytes[0] * unit, bytes[1] * unit, bytes[2] * unit};
    }
};

struct Photon24 {
    Vector place;
    SharedExponent shared;
    PackedDirection incoming;
    CoarseDirection normal;
    std::uint16_t edges;
    explicit Photon24(const Photon& photon)
        : place(photon.position),
          shared(photon.power),
          incoming(photon.incoming),
          normal(photon.normal),
          edges(photon.edges) {}
    Vector position() const { return place; }
    Color power() const { return shared.power(); }
};
static_assert(sizeof(Photon24) == 24);

struct Photon16 {
    std::array<std::uint16_t, 3> place;
    SharedExponent shared;
    PackedDirection incoming;
    CoarseDirection normal;
    explicit Photon16(const Photon& photon) : shared(photon.power), incoming(photon.incoming), normal(photon.normal) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            place[axis] = static_cast<std::uint16_t>(
                std::lround((photon.position[static_cast<int>(axis)] + 1.0f) * (0.5f * 65535.0f)));
    }
    Vector position() const {
        const auto at = [&](std::size_t axis) { return place[axis] * (2.0f / 65535.0f) - 1.0f; };
        return {at(0), at(1), at(2)};
    }
    Color power() const { return shared.power(); }
};
static_assert(sizeof(Photon16) == 16);

struct Photon32 {
    Photon photon;
    explicit Photon32(const Photon& whole) : photon(whole) {}
    Vector position() const { return photon.position; }
    Color power() const { return photon.power; }
};

template <typename Record>
void PhotonRecord(benchmark::State& state) {
    const std::size_t late = 1;
    const std::vector<Photon>& photons = work().photons[late];
    const std::vector<GatherQuery>& queries = work().queries[late];
    const std::vector<Record> records(photons.begin(), photons.end());

    // The photons as the small record gives them back.
    std::vector<Photon> decoded = photons;
    for (std::size_t i = 0; i < decoded.size(); ++i) {
        decoded[i].position = records[i].position();
        decoded[i].power = records[i].power();
    }
    const auto gathered = [&](const std::vector<Photon>& list) {
        std::vector<Found> found(queries.size());
        PhotonMap(list).within_each(queries,
                                    [&](std::size_t i, const Photon& photon, double) { found[i].add(photon); });
        return found;
    };
    const std::vector<Found> exact = gathered(photons);
    const std::vector<Found> small = gathered(decoded);
    double squared_error = 0.0;
    double squared = 0.0;
    double error = 0.0;
    double sum = 0.0;
    for (std::size_t i = 0; i < exact.size(); ++i) {
        const ColorD off = small[i].power - exact[i].power;
        squared_error += off.length2();
        squared += exact[i].power.length2();
        error += mean_channel(off);
        sum += mean_channel(exact[i].power);
    }
    Color total(0.0f);
    Vector places(0.0f);
    for (auto _ : state) {
        for (const Record& record : records) {
            total += record.power();
            places += record.position();
        }
        benchmark::DoNotOptimize(total);
        benchmark::DoNotOptimize(places);
    }
    state.counters["photons/s"] = Counter(static_cast<double>(records.size()), Counter::kIsIterationInvariantRate);
    state.counters["bytes_a_photon"] = sizeof(Record);
    state.counters["rms_error"] = std::sqrt(squared_error / squared);
    state.counters["bias"] = error / sum;
}

BENCHMARK_TEMPLATE(StatisticsError, float)
    ->ArgName("passes")
    ->Arg(64)
    ->Arg(10'000)
    ->Arg(1'000'000)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK_TEMPLATE(StatisticsError, double)
    ->ArgName("passes")
    ->Arg(64)
    ->Arg(10'000)
    ->Arg(1'000'000)
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1);
BENCHMARK_TEMPLATE(StatisticsUpdate, float)->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(StatisticsUpdate, double)->Unit(benchmark::kMillisecond);
BENCHMARK_TEMPLATE(PhotonRecord, Photon32)->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(PhotonRecord, Photon24)->Unit(benchmark::kMicrosecond);
BENCHMARK_TEMPLATE(PhotonRecord, Photon16)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace photonlab::benchmarks
