#include "gather/map/photon_groups.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/morton.h"

namespace photonlab {

namespace {

constexpr float level_factor = 4.0f;         // in distance between neighbours, from one level of density to the next
constexpr std::size_t level_limit = 16;      // 4^16: more than what float tells apart in one scene
constexpr std::size_t fewest_in_tier = 256;  // fewer are looked at sooner than a tree of their own

/// Median of the squared diagonals of the boxes of whole groups, were none to end early.
float median_squared_diagonal(const std::vector<Photon>& photons) {
    std::vector<float> found;
    found.reserve(photons.size() / PhotonGroups::capacity);
    for (std::size_t first = 0; first + PhotonGroups::capacity <= photons.size(); first += PhotonGroups::capacity) {
        Box box;
        for (std::size_t i = first; i < first + PhotonGroups::capacity; ++i) box.include(photons[i].position);
        found.push_back(box.squared_diagonal());
    }
    if (found.empty()) return 0.0f;
    const auto median = found.begin() + static_cast<std::ptrdiff_t>(found.size() / 2);
    std::nth_element(found.begin(), median, found.end());
    return *median;
}

}  // namespace

void PhotonGroups::make_groups(const std::vector<Photon>& photons) {
    const float largest_squared_diagonal = median_squared_diagonal(photons);
    list_.reserve(photons.size() / capacity * 5 / 4 + 1);
    for (std::size_t first = 0; first < photons.size();) {
        Box box;
        box.include(photons[first].position);
        std::size_t end = first + 1;
        for (; end < photons.size() && end < first + capacity; ++end) {
            Box wider = box;
            wider.include(photons[end].position);
            if (wider.squared_diagonal() > largest_squared_diagonal) break;
            box = wider;
        }
        const Vector centre = (box.lower + box.upper) * 0.5f;
        double squared_radius = 0.0;
        for (std::size_t i = first; i < end; ++i)
            squared_radius = std::max(squared_radius, (VectorD(photons[i].position) - VectorD(centre)).length2());
        const float radius = std::nextafter(static_cast<float>(std::sqrt(squared_radius)), infinity);
        list_.push_back({centre, radius, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end - first)});
        first = end;
    }
}

void PhotonGroups::make_tiers() {
    // How far apart groups are where this one is: an isolated photon is a group without extent, and not a dense one.
    const auto distance_between = [&](std::size_t a, std::size_t b) {
        return (list_[a].centre - list_[b].centre).length();
    };
    std::vector<float> extents(list_.size());
    float widest = 0.0f;
    for (std::size_t i = 0; i < list_.size(); ++i) {
        const float to_last = i > 0 ? distance_between(i, i - 1) : infinity;
        const float to_next = i + 1 < list_.size() ? distance_between(i, i + 1) : infinity;
        extents[i] = std::max(list_[i].radius, 0.5f * std::min(to_last, to_next));
        widest = std::max(widest, list_[i].radius);
    }

    // Levels are counted from the sparsest, which takes what lies farther apart than the widest group as well.
    std::vector<std::uint8_t> level_of(list_.size());
    std::array<std::size_t, level_limit> counts{};
    for (std::size_t i = 0; i < list_.size(); ++i) {
        std::size_t level = 0;
        for (float bound = widest / level_factor; level + 1 < level_limit && extents[i] <= bound; bound /= level_factor)
            ++level;
        level_of[i] = static_cast<std::uint8_t>(level);
        ++counts[level];
    }

    // From the densest on, a tier takes levels until it has groups enough.
    std::array<std::size_t, level_limit> tier_of{};
    std::size_t tiers = 0;
    std::size_t waiting = 0;
    for (std::size_t level = level_limit; level-- > 0;) {
        tier_of[level] = tiers;
        waiting += counts[level];
        if (waiting >= fewest_in_tier) {
            ++tiers;
            waiting = 0;
        }
    }
    if (waiting > 0) ++tiers;

    std::vector<PhotonGroup> sorted;
    sorted.reserve(list_.size());
    for (std::size_t tier = 0; tier < tiers; ++tier) {
        GroupTier& made = tiers_.emplace_back(GroupTier{sorted.size(), 0, 0.0f});
        for (std::size_t i = 0; i < list_.size(); ++i) {
            if (tier_of[level_of[i]] != tier) continue;
            sorted.push_back(list_[i]);
            made.largest_radius = std::max(made.largest_radius, list_[i].radius);
        }
        made.end = sorted.size();
    }
    list_ = std::move(sorted);
}

PhotonGroups::PhotonGroups(const std::vector<Photon>& photons) {
    make_groups(photons);
    make_tiers();
    for (int axis = 0; axis < 3; ++axis) {
        std::vector<float>& coordinates = axis == 0 ? x_ : axis == 1 ? y_ : z_;
        coordinates.reserve(photons.size() + capacity);
        for (const Photon& photon : photons) coordinates.push_back(photon.position[axis]);
        coordinates.resize(photons.size() + capacity, 0.0f);
    }
}

std::uint64_t PhotonGroups::bytes() const {
    return list_.capacity() * sizeof(PhotonGroup) + (x_.capacity() + y_.capacity() + z_.capacity()) * sizeof(float);
}

}  // namespace photonlab
