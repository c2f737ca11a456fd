#include "gather/areas/accepting_discs.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "transport/path_length.h"

namespace photonlab {

namespace {

/// Around the ball of the disc, a hair wider than float rounds.
Box box_of(const GatherQuery& query) {
    const double reach = std::max(query.radius, PhotonMap::minimum_radius);
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        const double at = query.position[axis];
        box.lower[axis] = std::nextafter(static_cast<float>(at - reach), -infinity);
        box.upper[axis] = std::nextafter(static_cast<float>(at + reach), infinity);
    }
    return box;
}

bool holds(const Box& box, const Vector& point) {
    return point.x >= box.lower.x && point.x <= box.upper.x && point.y >= box.lower.y && point.y <= box.upper.y &&
           point.z >= box.lower.z && point.z <= box.upper.z;
}

/// Indices of the discs whose points are finite, along a curve through these.
std::vector<std::uint32_t> order_along_curve(const std::vector<AcceptingDisc>& discs) {
    Box box;
    std::vector<std::uint32_t> order;
    for (std::uint32_t i = 0; i < discs.size(); ++i) {
        if (!is_squarable(discs[i].query.position)) continue;
        box.include(discs[i].query.position);
        order.push_back(i);
    }
    const MortonCurve curve(box);
    std::vector<std::uint32_t> places(discs.size());
    for (const std::uint32_t i : order) places[i] = curve.place_of(discs[i].query.position);
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return places[a] < places[b]; });
    return order;
}

}  // namespace

AcceptingDiscs::AcceptingDiscs(const Scene& scene, int max_depth, std::vector<AcceptingDisc> discs,
                               std::vector<GatherArea> areas)
    : scene_(&scene), max_depth_(max_depth), areas_(std::move(areas)), order_(order_along_curve(discs)) {
    discs_.reserve(order_.size());
    std::vector<Box> below;
    below.reserve(order_.size());
    for (const std::uint32_t index : order_) {
        discs_.push_back(discs[index]);
        below.push_back(box_of(discs[index].query));
    }
    while (levels_.empty() || below.size() > 1) {
        std::vector<Box> level(block_count(below.size(), children));
        for (std::size_t i = 0; i < below.size(); ++i) {
            level[i / children].include(below[i].lower);
            level[i / children].include(below[i].upper);
        }
        levels_.push_back(level);
        below = std::move(level);
    }
}

bool AcceptingDiscs::accepts(const AcceptingDisc& disc, std::size_t index, const Photon& photon,
                             const PhotonSide& side) const {
    const double radius = std::max(disc.query.radius, PhotonMap::minimum_radius);
    if (!(squared_distance_between(photon.position, disc.query.position) <= radius * radius)) return false;
    if (!side.is_accepted_at(disc.query)) return false;
    if (!depth_allows(max_depth_, photon.edges + std::uint32_t{disc.camera_edges})) return false;
    return areas_.empty() || areas_[index].is_whole() || areas_[index].weight(*scene_, photon);
}

bool AcceptingDiscs::is_accepted_below(std::size_t level, std::size_t node, const Photon& photon,
                                       const PhotonSide& side) const {
    if (!holds(levels_[level][node], photon.position)) return false;
    const std::size_t count = level == 0 ? discs_.size() : levels_[level - 1].size();
    const BlockRange range = block_range(node, count, children);
    for (std::size_t child = range.begin; child < range.end; ++child)
        if (level == 0 ? accepts(discs_[child], order_[child], photon, side)
                       : is_accepted_below(level - 1, child, photon, side))
            return true;
    return false;
}

bool AcceptingDiscs::accept(const Photon& photon) const {
    if (discs_.empty()) return false;
    return is_accepted_below(levels_.size() - 1, 0, photon, PhotonSide(photon));
}

std::uint64_t AcceptingDiscs::bytes() const {
    std::uint64_t bytes = discs_.size() * sizeof(AcceptingDisc) + areas_.size() * sizeof(GatherArea) +
                          order_.size() * sizeof(std::uint32_t);
    for (const std::vector<Box>& level : levels_) bytes += level.size() * sizeof(Box);
    return bytes;
}

}  // namespace photonlab
