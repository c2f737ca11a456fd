#include "gather/radii/radius_rule.h"

#include <cassert>

#include "gather/radii/adaptive_radius.h"
#include "gather/radii/disc_tests.h"

namespace photonlab {

namespace {

/// Its state is the region's count.
class HachisukaRule : public RadiusRule {
public:
    explicit HachisukaRule(double alpha) : alpha_(alpha) {}

    void take(std::size_t, const PassGather& gathered, GatherStatistics& statistics) override {
        statistics.squared_radius *= hachisuka_shrink(alpha_, statistics.count, gathered.found);
        statistics.count += alpha_ * gathered.found;
    }
    void exchange(StateArchive&) override {}

private:
    const double alpha_;
};

class KnausZwickerRule : public RadiusRule {
public:
    explicit KnausZwickerRule(double alpha) : alpha_(alpha) {}

    void take(std::size_t, const PassGather& gathered, GatherStatistics& statistics) override {
        statistics.squared_radius *= shrink_after(gathered.pass);
        statistics.count += gathered.found;
    }
    double shrink_after(std::uint64_t pass) const override { return knaus_zwicker_shrink(alpha_, pass); }
    void exchange(StateArchive&) override {}

private:
    const double alpha_;
};

}  // namespace

double RadiusRule::shrink_after(std::uint64_t) const {
    assert(false);  // asked of rules that are blind alone
    return 1.0;
}

std::unique_ptr<RadiusRule> make_radius_rule(const RadiusRuleSettings& settings, std::size_t regions) {
    switch (settings.schedule) {
        case ScheduleName::Hachisuka:
            return std::make_unique<HachisukaRule>(settings.alpha);
        case ScheduleName::KnausZwicker:
            return std::make_unique<KnausZwickerRule>(settings.alpha);
        case ScheduleName::Adaptive:
            return std::make_unique<AdaptiveRadius>(settings, regions);
        case ScheduleName::ChiSquare:
            return std::make_unique<ChiSquareRadius>(settings, regions);
        case ScheduleName::FTest:
            return std::make_unique<FTestRadius>(settings, regions);
    }
    return nullptr;
}

double hachisuka_shrink(double alpha, double count, double found) {
    const double all = count + found;
    return all > 0.0 ? (count + alpha * found) / all : 1.0;
}

double knaus_zwicker_shrink(double alpha, std::uint64_t pass) {
    const double i = static_cast<double>(pass);
    return (i + alpha) / (i + 1.0);
}

void take_radius(GatherStatistics& statistics, RadiusRule& rule, std::size_t region, const PassGather& gathered,
                 double least_squared_radius) {
    rule.take(region, gathered, statistics);
    statistics.squared_radius = std::max(statistics.squared_radius, least_squared_radius);
}

void take_pass(GatherStatistics& statistics, RadiusRule& rule, std::size_t region, const PassGather& gathered,
               double least_squared_radius) {
    statistics.estimate += (gathered.estimate - statistics.estimate) / static_cast<double>(gathered.passes);
    take_radius(statistics, rule, region, gathered, least_squared_radius);
}

}  // namespace photonlab
