#include "gather/radius_schedule.h"

namespace photonlab {

double hachisuka_shrink(double alpha, double count, double found) {
    const double all = count + found;
    return all > 0.0 ? (count + alpha * found) / all : 1.0;
}

double knaus_zwicker_shrink(double alpha, std::uint64_t pass) {
    const double i = static_cast<double>(pass);
    return (i + alpha) / (i + 1.0);
}

void take_pass(GatherStatistics& statistics, ScheduleName schedule, double alpha, const PassGather& gathered,
               double least_squared_radius) {
    statistics.estimate += (gathered.estimate - statistics.estimate) / static_cast<double>(gathered.passes);
    if (schedule == ScheduleName::Hachisuka) {
        statistics.squared_radius *= hachisuka_shrink(alpha, statistics.count, gathered.found);
        statistics.count += alpha * gathered.found;
    } else {
        statistics.squared_radius *= knaus_zwicker_shrink(alpha, gathered.pass);
        statistics.count += gathered.found;
    }
    statistics.squared_radius = std::max(statistics.squared_radius, least_squared_radius);
}

}  // namespace photonlab
