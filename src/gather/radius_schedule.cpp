#include "gather/radius_schedule.h"

#include <fmt/format.h>

namespace photonlab {

double hachisuka_shrink(double alpha, double count, double found) {
    const double all = count + found;
    return all > 0.0 ? (count + alpha * found) / all : 1.0;
}

double knaus_zwicker_shrink(double alpha, std::uint64_t pass) {
    const double i = static_cast<double>(pass);
    return (i + alpha) / (i + 1.0);
}

void require_alpha(double alpha) {
    if (!(alpha > 0.0 && alpha <= 1.0))
        throw InputError(fmt::format("alpha: expected a number in (0, 1], got {}", alpha));
}

}  // namespace photonlab
