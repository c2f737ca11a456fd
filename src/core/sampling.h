// Warps from the unit square to the shapes that light transport samples, each with its density.
//
// Every warp takes u in [0,1)^2 and every density is with respect to the measure its comment names.

#pragma once

#include "core/math.h"

namespace photonlab {

/// One of two things, and the number that is left to draw from it: uniform in [0, 1) again.
struct ShareChoice {
    bool is_chosen;  ///< the one that has the share; else the other
    float rest;
};

/// The share of one that gets this much where another gets `other`, neither negative; 0 where both are 0.
inline float share_beside(float one, float other) {
    return one + other > 0.0f ? one / (one + other) : 0.0f;
}

/// `share` in [0, 1].
inline ShareChoice choose_by_share(float u, float share) {
    constexpr float below_one = 0x1.fffffep-1f;
    if (u < share) return {true, std::min(u / share, below_one)};
    return {false, std::min((u - share) / (1.0f - share), below_one)};
}

/// Unit disc, uniform in area: density 1/pi. Concentric, so neighbouring u stay neighbours.
/// [Shirley & Chiu 1997, "A Low Distortion Map Between Disk and Square"]
inline Imath::V2f sample_unit_disc(const Imath::V2f& u) {
    const float x = 2.0f * u.x - 1.0f;
    const float y = 2.0f * u.y - 1.0f;
    if (x == 0.0f && y == 0.0f) return {0.0f, 0.0f};
    const bool horizontal = std::abs(x) > std::abs(y);
    const float radius = horizontal ? x : y;
    const float quarter_pi = static_cast<float>(pi / 4.0);
    // Which of the two is a coin's toss: chosen between, not branched on.
    const float part = quarter_pi * ((horizontal ? y : x) / radius);
    const float angle = horizontal ? part : 2.0f * quarter_pi - part;
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

/// Hemisphere around +z with density cos(theta)/pi per steradian.
inline Vector sample_cosine_hemisphere(const Imath::V2f& u) {
    const Imath::V2f disc = sample_unit_disc(u);
    return {disc.x, disc.y, std::sqrt(std::max(0.0f, 1.0f - disc.x * disc.x - disc.y * disc.y))};
}

inline float cosine_hemisphere_density(float cos_theta) {
    return std::max(0.0f, cos_theta) * static_cast<float>(1.0 / pi);
}

/// Whole sphere of directions, density 1/(4 pi) per steradian.
inline Vector sample_unit_sphere(const Imath::V2f& u) {
    const float z = 1.0f - 2.0f * u.x;
    const float sine = std::sqrt(std::max(0.0f, 1.0f - z * z));
    const float angle = static_cast<float>(2.0 * pi) * u.y;
    return {sine * std::cos(angle), sine * std::sin(angle), z};
}

/// Cone around +z whose half-angle has `1 - cos = one_minus_cos_max`; density 1/(2 pi one_minus_cos_max) per
/// steradian. Takes 1 - cos, not cos: a small cone keeps its precision.
inline Vector sample_cone(const Imath::V2f& u, float one_minus_cos_max) {
    const float one_minus_cos = u.x * one_minus_cos_max;
    const float sine = std::sqrt(std::max(0.0f, one_minus_cos * (2.0f - one_minus_cos)));
    const float angle = static_cast<float>(2.0 * pi) * u.y;
    return {sine * std::cos(angle), sine * std::sin(angle), 1.0f - one_minus_cos};
}

/// Barycentric coordinates (weights of the second and third corner), uniform in a triangle's area.
inline Imath::V2f sample_triangle(const Imath::V2f& u) {
    const float root = std::sqrt(u.x);
    return {root * (1.0f - u.y), root * u.y};
}

}  // namespace photonlab
