// Directions and normals that tests of scenes ask for.

#pragma once

#include <gtest/gtest.h>

#include "core/math.h"
#include "scene/description.h"

namespace photonlab {

inline void expect_near(const VectorD& a, const VectorD& b, double tolerance = 1e-12) {
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], tolerance) << i;
}

inline VectorD normal_of(const MeshDescription& mesh, std::size_t triangle = 0) {
    const auto& t = mesh.triangles.at(triangle);
    return (mesh.positions[t.y] - mesh.positions[t.x]).cross(mesh.positions[t.z] - mesh.positions[t.x]).normalized();
}

/// Unit, so far from the normal in the local frame.
inline Vector at_angle(double degrees, double azimuth = 0.0) {
    const double angle = degrees * pi / 180.0;
    return Vector(VectorD(std::sin(angle) * std::cos(azimuth), std::sin(angle) * std::sin(azimuth), std::cos(angle)));
}

}  // namespace photonlab
