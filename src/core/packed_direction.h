// Unit vectors in 32 or 16 bits, by their place on an octahedron that is unfolded into a square. The six axes come back
// exactly.
//
// [Cigolle et al. 2014, "A Survey of Efficient Representations for Independent Unit Vectors": oct]

#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "core/math.h"

namespace photonlab {

/// Two coordinates of `Integer`, signed and symmetric. Off by at most sqrt(18)/2 of their smallest step: 6.5e-5 radians
/// with 16 bits each, 0.017 (one degree) with 8.
template <typename Integer>
struct PackedUnitVector {
    Integer u = 0;
    Integer v = 0;

    PackedUnitVector() = default;
    explicit PackedUnitVector(const Vector& direction) {
        const float scale = 1.0f / (std::abs(direction.x) + std::abs(direction.y) + std::abs(direction.z));
        const float x = direction.x * scale;
        const float y = direction.y * scale;
        const float folded_x = (1.0f - std::abs(y)) * std::copysign(1.0f, x);
        const float folded_y = (1.0f - std::abs(x)) * std::copysign(1.0f, y);
        u = round(direction.z < 0.0f ? folded_x : x);
        v = round(direction.z < 0.0f ? folded_y : y);
    }

    /// Along the direction, of length 0.57 to 1: what needs only signs or ratios saves the square root.
    Vector unnormalized() const {
        float x = static_cast<float>(u) * (1.0f / largest);
        float y = static_cast<float>(v) * (1.0f / largest);
        const float z = 1.0f - std::abs(x) - std::abs(y);
        const float fold = std::max(-z, 0.0f);
        x -= std::copysign(fold, x);
        y -= std::copysign(fold, y);
        return {x, y, z};
    }
    Vector unit() const {
        const Vector direction = unnormalized();
        return direction * (1.0f / std::sqrt(direction.length2()));
    }

    bool operator==(const PackedUnitVector&) const = default;

private:
    static constexpr float largest = std::numeric_limits<Integer>::max();
    static Integer round(float x) { return static_cast<Integer>(std::lrint(x * largest)); }
};

using PackedDirection = PackedUnitVector<std::int16_t>;
using CoarseDirection = PackedUnitVector<std::int8_t>;

}  // namespace photonlab
