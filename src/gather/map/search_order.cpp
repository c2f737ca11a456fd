#include "gather/map/search_order.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "core/morton.h"

namespace photonlab {

SearchOrder::SearchOrder(const HitPointList& points) {
    static_assert(hit_points_per_block - 1 <= std::numeric_limits<std::uint8_t>::max());
    places_.reserve(points.size());
    std::vector<std::pair<std::uint32_t, std::uint8_t>> block_places;
    for (std::size_t block = 0; block < block_count(points.size(), hit_points_per_block); ++block) {
        const BlockRange range = block_range(block, points.size(), hit_points_per_block);
        Box box;
        for (std::size_t i = range.begin; i < range.end; ++i) box.include(points[i].position);
        const MortonCurve curve(box);
        block_places.clear();
        for (std::size_t i = range.begin; i < range.end; ++i)
            block_places.emplace_back(curve.place_of(points[i].position), static_cast<std::uint8_t>(i - range.begin));
        std::sort(block_places.begin(), block_places.end());
        for (const auto& [along_curve, place] : block_places) places_.push_back(place);
    }
}

}  // namespace photonlab
