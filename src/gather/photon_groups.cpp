#include "gather/photon_groups.h"

#include <algorithm>
#include <cmath>

#include "core/morton.h"

namespace photonlab {

namespace {

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

PhotonGroups::PhotonGroups(const std::vector<Photon>& photons) {
    const float widest = median_squared_diagonal(photons);
    list_.reserve(photons.size() / capacity * 5 / 4 + 1);
    for (std::size_t first = 0; first < photons.size();) {
        Box box;
        box.include(photons[first].position);
        std::size_t end = first + 1;
        for (; end < photons.size() && end < first + capacity; ++end) {
            Box wider = box;
            wider.include(photons[end].position);
            if (wider.squared_diagonal() > widest) break;
            box = wider;
        }
        const Vector centre = (box.lower + box.upper) * 0.5f;
        double squared_radius = 0.0;
        for (std::size_t i = first; i < end; ++i)
            squared_radius = std::max(squared_radius, (VectorD(photons[i].position) - VectorD(centre)).length2());
        const float radius = std::nextafter(static_cast<float>(std::sqrt(squared_radius)), infinity);
        largest_radius_ = std::max(largest_radius_, radius);
        list_.push_back({centre, radius, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(end - first)});
        first = end;
    }

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
