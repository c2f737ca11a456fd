// Writes the curves of the six deviations of deviations.h: what is shown after passes spread evenly on a logarithmic
// axis, by the right update and by the deviating one, as mean over seeds 1 to 16 with its standard error. `analysis
// deviations` draws it.

#include <cmath>
#include <cstdio>
#include <map>

#include "tests/statistical/radii/deviations.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

constexpr std::uint64_t seeds = 16;

bool is_shown(std::uint64_t pass) {
    for (int half_octave = 0; half_octave < 64; ++half_octave)
        if (pass == static_cast<std::uint64_t>(std::llround(std::pow(2.0, 0.5 * half_octave)))) return true;
    return false;
}

void write_curve(const Deviation& deviation) {
    struct Values {
        std::vector<double> right;
        std::vector<double> deviating;
    };
    std::map<std::uint64_t, Values> by_pass;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed)
        run_deviation(deviation, seed, deviation.passes,
                      [&](std::uint64_t pass, const Estimates& right, const Estimates& deviating) {
                          if (!is_shown(pass)) return;
                          by_pass[pass].right.push_back(deviation.value_right(right));
                          by_pass[pass].deviating.push_back(deviation.value_deviating(deviating));
                      });
    for (const auto& [pass, values] : by_pass) {
        const SampleMean right(values.right);
        const SampleMean deviating(values.deviating);
        std::printf("%s,%s,%llu,%.8g,%.3g,%.8g,%.3g\n", deviation.name.c_str(), deviation.quantity.c_str(),
                    static_cast<unsigned long long>(pass), deviating.mean, std::sqrt(deviating.squared_error),
                    right.mean, std::sqrt(right.squared_error));
        std::fflush(stdout);
    }
}

}  // namespace
}  // namespace photonlab::test

int main() {
    std::puts("deviation,quantity,pass,value,value_error,right,right_error");
    for (const photonlab::test::Deviation& deviation : photonlab::test::deviations())
        photonlab::test::write_curve(deviation);
}
