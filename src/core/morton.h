// Places along a Morton curve through a box: neighbours along it are mostly neighbours in space, so what is sorted by
// them is read in a coherent order.

#pragma once

#include <cstdint>

#include "core/math.h"

namespace photonlab {

/// The smallest box around what was included.
struct Box {
    Vector lower = Vector(infinity);
    Vector upper = Vector(-infinity);

    void include(const Vector& point) {
        for (int axis = 0; axis < 3; ++axis) {
            lower[axis] = std::min(lower[axis], point[axis]);
            upper[axis] = std::max(upper[axis], point[axis]);
        }
    }
    float squared_diagonal() const { return (upper - lower).length2(); }
};

/// Its cells are cubes, whatever the shape of the box: an axis with nothing but rounding along it does not count.
class MortonCurve {
public:
    static constexpr unsigned bits_per_axis = 10;

    explicit MortonCurve(const Box& box) : lower_(box.lower) {
        constexpr double cells = (1u << bits_per_axis) - 1.0;
        double extent = 0.0;
        for (int axis = 0; axis < 3; ++axis)
            extent = std::max(extent, static_cast<double>(box.upper[axis]) - box.lower[axis]);
        if (extent > 0.0) scale_ = cells / extent;
    }

    /// Of a finite point in the box, in 3 * bits_per_axis bits.
    std::uint32_t place_of(const Vector& point) const {
        const auto cell = [&](int axis) {
            const double offset = static_cast<double>(point[axis]) - lower_[axis];
            return static_cast<std::uint32_t>(offset * scale_);
        };
        return spread_bits(cell(0)) | spread_bits(cell(1)) << 1 | spread_bits(cell(2)) << 2;
    }

private:
    /// Spreads the low 10 bits of `x` so that two zero bits follow each.
    static std::uint32_t spread_bits(std::uint32_t x) {
        x = (x | x << 16) & 0x30000ff;
        x = (x | x << 8) & 0x300f00f;
        x = (x | x << 4) & 0x30c30c3;
        x = (x | x << 2) & 0x9249249;
        return x;
    }

    Vector lower_;
    double scale_ = 0.0;
};

}  // namespace photonlab
