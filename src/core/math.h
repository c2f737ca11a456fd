// The vocabulary of every other file: vectors, colours, frames and the ray offset.
//
// Geometry is float32 inside a scene that was moved and scaled to a unit box around the origin, so one float
// has the same relative precision whether the scene was measured in microns or kilometres. Radiance and
// everything summed over photons or passes is double.

#pragma once

#include <Imath/ImathColor.h>
#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace photonlab {

using Vector = Imath::V3f;             ///< position in the unit box, or direction
using VectorD = Imath::V3d;            ///< position in scene units
using Matrix = Imath::M44d;            ///< row-vector convention (Imath's): p' = p * M
using Color = Imath::Color3<float>;    ///< reflectance, photon power, linear RGB
using ColorD = Imath::Color3<double>;  ///< radiance or a sum of such, linear RGB

inline constexpr double pi = 3.14159265358979323846;
inline constexpr float infinity = std::numeric_limits<float>::infinity();

inline float max_channel(const Color& color) {
    return std::max({color.x, color.y, color.z});
}
inline double mean_channel(const ColorD& color) {
    return (color.x + color.y + color.z) / 3.0;
}

template <typename T>
bool is_finite(const Imath::Vec3<T>& v) {
    return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

/// The farthest coordinate, and the largest length, in the unit box: floats square it with room to spare.
inline constexpr double largest_length = 1e18;

/// False for what float cannot square, and for NaN.
inline bool is_squarable(const Vector& v) {
    const auto fits = [](float x) { return std::abs(x) <= static_cast<float>(largest_length); };
    return fits(v.x) && fits(v.y) && fits(v.z);
}

template <typename T>
bool is_black(const Imath::Color3<T>& color) {
    return color.x == 0 && color.y == 0 && color.z == 0;
}

/// Orthonormal frame around a unit normal. Local directions have z along the normal.
struct Frame {
    Vector tangent;
    Vector bitangent;
    Vector normal;

    Vector to_local(const Vector& world) const { return {world.dot(tangent), world.dot(bitangent), world.dot(normal)}; }
    Vector to_world(const Vector& local) const { return tangent * local.x + bitangent * local.y + normal * local.z; }
};

/// Frame around `normal` (unit length), without branches or a preferred axis.
/// [Duff et al. 2017, "Building an Orthonormal Basis, Revisited"]
inline Frame make_frame(const Vector& normal) {
    const float sign = std::copysign(1.0f, normal.z);
    const float a = -1.0f / (sign + normal.z);
    const float b = normal.x * normal.y * a;
    return {Vector(1.0f + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
            Vector(b, sign + normal.y * normal.y * a, -normal.y), normal};
}

/// Frame around `normal` whose tangent is as near to `tangent` as it can be; both are unit, and not parallel.
inline Frame frame_with_tangent(const Vector& normal, const Vector& tangent) {
    const Vector along = (tangent - normal * normal.dot(tangent)).normalized();
    return {along, normal.cross(along), normal};
}

/// The same as make_frame(), turned by an angle about the normal; radians, from tangent to bitangent.
inline Frame make_frame(const Vector& normal, float turn) {
    const Frame frame = make_frame(normal);
    if (turn == 0.0f) return frame;
    const float cosine = std::cos(turn);
    const float sine = std::sin(turn);
    return {frame.tangent * cosine + frame.bitangent * sine, frame.bitangent * cosine - frame.tangent * sine, normal};
}

/// The turn that makes `frame`, which is right-handed.
inline float turn_of(const Frame& frame) {
    const Vector tangent = make_frame(frame.normal).to_local(frame.tangent);
    return std::atan2(tangent.y, tangent.x);
}

/// Moves a surface point off its surface, to the side of `direction`, so that a ray from there does not find the
/// surface again. The step is some thirty roundings of the largest coordinate of the unit box (or of the point,
/// where that is larger): relative to the scene, whatever its units.
inline Vector offset_from_surface(const Vector& position, const Vector& geometric_normal, const Vector& direction) {
    const float largest = std::max({0.5f, std::abs(position.x), std::abs(position.y), std::abs(position.z)});
    const float step = 32.0f * std::numeric_limits<float>::epsilon() * largest;
    return position + geometric_normal * std::copysign(step, geometric_normal.dot(direction));
}

}  // namespace photonlab
