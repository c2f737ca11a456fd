// The order in which hit points are searched: in each block of those that a thread takes at a time, along a Morton
// curve through them. Neighbours in the image are neighbours in space only where no edge or mirror is between, and
// queries that follow each other in space are answered together.

#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "transport/camera/hit_point_list.h"

namespace photonlab {

class SearchOrder {
public:
    explicit SearchOrder(const HitPointList& points);

    /// Places in a block of hit_points_per_block points, [range.begin, range.end) of the list, in the order of search:
    /// each once, the block's first point being 0.
    std::span<const std::uint8_t> of_block(BlockRange range) const {
        return {&places_[range.begin], range.end - range.begin};
    }

    std::uint64_t bytes() const { return places_.size(); }

private:
    std::vector<std::uint8_t> places_;
};

}  // namespace photonlab
