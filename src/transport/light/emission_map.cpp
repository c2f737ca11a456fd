#include "transport/light/emission_map.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace photonlab {

namespace {

EmissionMap::Square square_of(const Emitter& emitter) {
    return std::holds_alternative<Directional>(emitter.kind) ? EmissionMap::Square::Position
                                                             : EmissionMap::Square::Direction;
}

}  // namespace

EmissionMap::EmissionMap(const Scene& scene) {
    for (const Emitter& emitter : scene.emitters) lights_.push_back({emitter.choice_probability, square_of(emitter)});
    paths_.assign(lights_.size() * cells_per_light, 0);
    acceptances_.assign(paths_.size(), 0);
    set_density();
}

double EmissionMap::plain_probability(std::size_t cell) const {
    return lights_[cell / cells_per_light].plain / cells_per_light;
}

EmissionMap::Choice EmissionMap::choose(double u) const {
    const auto found = std::upper_bound(cdf_.begin(), cdf_.end() - 1, u);
    const auto cell = static_cast<std::uint32_t>(found - cdf_.begin());
    const std::uint32_t emitter = cell / cells_per_light;
    return {emitter, cell, lights_[emitter].square, plain_probability(cell) / probability_[cell]};
}

Imath::V2f EmissionMap::within(std::uint32_t cell, const Imath::V2f& u) {
    constexpr float below_one = 0x1.fffffep-1f;  // where rounding would reach 1
    const std::uint32_t place = cell % cells_per_light;
    const auto at = [&](std::uint32_t index, float offset) {
        constexpr float width = 1.0f / static_cast<float>(cells_per_side);
        return std::min(static_cast<float>(index) * width + offset * width, below_one);
    };
    return {at(place % cells_per_side, u.x), at(place / cells_per_side, u.y)};
}

void EmissionMap::learn(const PathsSeen& seen) {
    assert(seen.cell.size() == seen.acceptances.size());
    for (std::size_t path = 0; path < seen.cell.size(); ++path) {
        ++paths_[seen.cell[path]];
        acceptances_[seen.cell[path]] += seen.acceptances[path];
    }
    set_density();
}

void EmissionMap::set_density() {
    std::vector<double> learnt(cell_count(), 0.0);
    double sum = 0.0;
    for (std::size_t cell = 0; cell < learnt.size(); ++cell) {
        if (paths_[cell] > 0)
            learnt[cell] = plain_probability(cell) *
                           std::sqrt(static_cast<double>(acceptances_[cell]) / static_cast<double>(paths_[cell]));
        sum += learnt[cell];
    }
    probability_.resize(learnt.size());
    cdf_.resize(learnt.size());
    double all = 0.0;
    for (std::size_t cell = 0; cell < learnt.size(); ++cell) {
        const double plain = plain_probability(cell);
        probability_[cell] = sum > 0.0 ? (1.0 - plain_share) * (learnt[cell] / sum) + plain_share * plain : plain;
        all += probability_[cell];
        cdf_[cell] = all;
    }
    for (double& share : cdf_) share /= all;
    if (!cdf_.empty()) cdf_.back() = 1.0;
}

void EmissionMap::exchange(StateArchive& archive) {
    archive.exchange_as_many(paths_);
    archive.exchange_as_many(acceptances_);
    set_density();
}

}  // namespace photonlab
