// Neighbouring queries that one search answers: the tree is asked once for all that any of them can reach, and each
// photon found there is tested against all of them at a time.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/morton.h"
#include "gather/map/photon_map.h"

namespace photonlab {

/// At most 16 queries, in a box whose half-diagonal is at most four of the largest radius, and with radii that differ
/// by a factor of two at most. Wider and narrower ones were slower, early and late.
class QueryCluster {
public:
    static constexpr std::size_t capacity = 16;

    /// The longest cluster from query `first` on, of at most `most` queries (1 to capacity).
    QueryCluster(const std::vector<GatherQuery>& queries, std::size_t first, std::size_t most) : first_(first) {
        Box box;
        double smallest = queries[first].radius;
        double largest = smallest;
        for (std::size_t i = first; i < queries.size() && count_ < most; ++i) {
            const GatherQuery& query = queries[i];
            box.include(query.position);
            smallest = std::min(smallest, query.radius);
            largest = std::max(largest, query.radius);
            const float squared_diagonal = box.squared_diagonal();
            const bool is_compact = std::isfinite(squared_diagonal) && squared_diagonal <= 64.0 * largest * largest &&
                                    largest <= 2.0 * smallest;
            if (count_ > 0 && !is_compact) break;
            x_[count_] = query.position.x;
            y_[count_] = query.position.y;
            z_[count_] = query.position.z;
            const double radius = std::max(query.radius, PhotonMap::minimum_radius);
            squared_radius_[count_] = radius * radius;
            ++count_;
            centre_ = (box.lower + box.upper) * 0.5f;
        }
        for (std::size_t i = count_; i < capacity; ++i) {
            x_[i] = y_[i] = z_[i] = 0.0;
            squared_radius_[i] = -1.0;
        }
        for (std::size_t i = 0; i < count_; ++i) {
            const double distance = (VectorD(x_[i], y_[i], z_[i]) - VectorD(centre_)).length();
            reach_ = std::max(reach_, distance + std::sqrt(squared_radius_[i]));
        }
    }

    std::size_t first() const { return first_; }
    std::size_t end() const { return first_ + count_; }
    const Vector& centre() const { return centre_; }
    double reach() const { return reach_; }  ///< from the centre, of the ball that holds all of theirs

    /// A bit for each query whose ball holds the position, the first query's lowest; fills their squared distances.
    std::uint64_t holding(const Vector& position, std::array<double, capacity>& squared_distance) const {
        // Straight-line code over all slots, so that the compiler does several at once.
        std::uint64_t inside = 0;  // as wide as a double: the compiler's vectors have lanes of one width
        for (std::size_t i = 0; i < capacity; ++i) {
            const double x = x_[i] - position.x;
            const double y = y_[i] - position.y;
            const double z = z_[i] - position.z;
            squared_distance[i] = x * x + y * y + z * z;
        }
        for (std::size_t i = 0; i < capacity; ++i)
            inside |= squared_distance[i] <= squared_radius_[i] ? std::uint64_t{1} << i : 0u;
        return inside;
    }

private:
    std::size_t first_;
    std::size_t count_ = 0;
    std::array<double, capacity> x_;
    std::array<double, capacity> y_;
    std::array<double, capacity> z_;
    std::array<double, capacity> squared_radius_;  // negative in a slot without query
    Vector centre_;
    double reach_ = 0.0;
};

}  // namespace photonlab
