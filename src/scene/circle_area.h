// Area that a circle and a triangle have in common, in closed form.

#pragma once

#include "core/math.h"

namespace photonlab {

/// Signed area of the triangle (0, a, b) within the circle of `radius` around 0: positive when a, b turn
/// counter-clockwise. Along the segment from a to b it is a triangle where the segment is inside the circle, and a
/// sector where it is outside.
inline double area_in_circle(const Imath::V2d& a, const Imath::V2d& b, double radius) {
    const Imath::V2d along = b - a;
    const auto sector = [&](const Imath::V2d& from, const Imath::V2d& to) {
        return 0.5 * radius * radius * std::atan2(from.cross(to), from.dot(to));
    };
    // |a + t along|^2 = radius^2
    const double squared_length = along.length2();
    if (squared_length == 0.0) return 0.0;
    const double half = a.dot(along) / squared_length;
    const double discriminant = half * half - (a.length2() - radius * radius) / squared_length;
    if (discriminant <= 0.0) return sector(a, b);
    const double root = std::sqrt(discriminant);
    const double enters = std::clamp(-half - root, 0.0, 1.0);
    const double leaves = std::clamp(-half + root, 0.0, 1.0);
    if (!(enters < leaves)) return sector(a, b);
    const Imath::V2d first = a + along * enters;
    const Imath::V2d last = a + along * leaves;
    const double inside = 0.5 * first.cross(last);
    return inside + (enters > 0.0 ? sector(a, first) : 0.0) + (leaves < 1.0 ? sector(last, b) : 0.0);
}

/// Area (at least 0) of the triangle within the circle of `radius` around 0.
inline double area_in_circle(const Imath::V2d& a, const Imath::V2d& b, const Imath::V2d& c, double radius) {
    return std::abs(area_in_circle(a, b, radius) + area_in_circle(b, c, radius) + area_in_circle(c, a, radius));
}

}  // namespace photonlab
