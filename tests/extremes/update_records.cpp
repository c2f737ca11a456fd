// Writes how far the update's radius, count and estimate are from their closed form: by passes up to a million, by
// alpha after a million passes, and by photons that come one a pass. As the program keeps them, and as the 2008
// paper prints the update, in double and in float. `analysis extremes` draws it.

#include <cstdio>
#include <initializer_list>

#include "tests/extremes/steady_point.h"

namespace photonlab::test {
namespace {

constexpr std::uint64_t million = 1'000'000;

void write_row(const char* axis, double value, const char* update, const PointState& state, const PointState& exact) {
    const PointState error = relative_errors(state, exact);
    std::printf("%s,%.10g,%s,%.3g,%.3g,%.3g\n", axis, value, update, error.radius, error.count, error.estimate);
}

/// The three updates of one point side by side.
struct Updates {
    explicit Updates(const SteadyPoint& steady) : point(steady), program(steady), in_double(steady), in_float(steady) {}

    void take_pass() {
        ++passes;
        program.take_pass();
        in_double.take_pass();
        in_float.take_pass();
    }
    void write(const char* axis, double value) const {
        const PointState exact = closed_form(point, passes);
        write_row(axis, value, "program", program.state(), exact);
        write_row(axis, value, "double", in_double.state(), exact);
        write_row(axis, value, "float", in_float.state(), exact);
    }

    SteadyPoint point;
    ProgramUpdate program;
    PrintedUpdate<double> in_double;
    PrintedUpdate<float> in_float;
    std::uint64_t passes = 0;
};

void write_by_passes() {
    Updates updates({});
    std::uint64_t next = 1;
    while (updates.passes < million) {
        updates.take_pass();
        if (updates.passes != next && updates.passes != million) continue;
        updates.write("passes", static_cast<double>(updates.passes));
        next *= 2;
    }
}

void write_by_alpha() {
    for (const double alpha : {1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.3, 0.5, 0.7, 0.9, 0.99, 1.0 - 1e-9, 1.0}) {
        Updates updates({.alpha = alpha});
        while (updates.passes < million) updates.take_pass();
        updates.write("alpha", alpha);
    }
}

/// One photon a pass, of 7 units of radiance: with alpha a half each pass i multiplies the squared radius by i / (i +
/// 1), so it is 1 / (n + 1) of its first value and the count is n / 2.
void write_by_photons() {
    constexpr double alpha = 0.5;
    const auto rule = make_radius_rule({.alpha = alpha}, 1);
    GatherStatistics statistics{.squared_radius = 1.0};
    float squared_radius = 1.0f;
    float count = 0.0f;
    float estimate = 0.0f;
    std::uint64_t next = 1;
    for (std::uint64_t pass = 1; pass <= std::uint64_t{1} << 27; ++pass) {
        take_pass(statistics, *rule, 0, {.pass = pass, .passes = pass, .found = 1.0, .estimate = ColorD(7.0)}, 0.0);
        squared_radius *= (count + static_cast<float>(alpha)) / (count + 1.0f);
        count += static_cast<float>(alpha);
        estimate += (7.0f - estimate) / static_cast<float>(pass);
        if (pass != next) continue;
        next *= 2;
        const auto n = static_cast<double>(pass);
        const PointState exact{1.0 / std::sqrt(n + 1.0), alpha * n, 7.0};
        write_row("photons", n, "program",
                  {std::sqrt(statistics.squared_radius), statistics.count, statistics.estimate.x}, exact);
        write_row(
            "photons", n, "float",
            {std::sqrt(static_cast<double>(squared_radius)), static_cast<double>(count), static_cast<double>(estimate)},
            exact);
    }
}

}  // namespace
}  // namespace photonlab::test

int main() {
    std::puts("axis,value,update,radius,count,estimate");
    photonlab::test::write_by_passes();
    photonlab::test::write_by_alpha();
    photonlab::test::write_by_photons();
}
