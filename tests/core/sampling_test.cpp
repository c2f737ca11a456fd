// Warps against their densities, by chi-square and by their Jacobian: the first finds a wrong density, the second a
// warp that folds or leaves gaps finer than the chi-square's cells.
//
// Each chi-square fails by chance with probability 1e-4 (chi_square.h), the seven here together with less than 1e-3;
// seeds are fixed.

#include "core/sampling.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "tests/support/chi_square.h"
#include "tests/support/test_stream.h"

namespace photonlab {
namespace {

double azimuth(const Vector& direction) {
    const double angle = std::atan2(direction.y, direction.x);
    return angle < 0.0 ? angle + 2.0 * pi : angle;
}

TEST(SampleUnitDisc, IsUniformInArea) {
    RandomStream random = test_stream();
    expect_distributed(
        [&] {
            const auto p = sample_unit_disc(random.next_2d());
            return std::pair<double, double>(p.length2(), azimuth({p.x, p.y, 0}));
        },
        [](double, double) { return 1.0 / (2.0 * pi); }, 0.0, 1.0 + 1e-6, 0.0, 2.0 * pi);
}

TEST(SampleCosineHemisphere, FollowsTheCosine) {
    RandomStream random = test_stream();
    expect_distributed(
        [&] {
            const Vector d = sample_cosine_hemisphere(random.next_2d());
            return std::pair<double, double>(d.z, azimuth(d));
        },
        [](double z, double) { return cosine_hemisphere_density(static_cast<float>(z)); }, 0.0, 1.0, 0.0, 2.0 * pi);
}

TEST(SampleUnitSphere, IsUniformInSolidAngle) {
    RandomStream random = test_stream();
    expect_distributed(
        [&] {
            const Vector d = sample_unit_sphere(random.next_2d());
            return std::pair<double, double>(d.z, azimuth(d));
        },
        [](double, double) { return 1.0 / (4.0 * pi); }, -1.0, 1.0, 0.0, 2.0 * pi);
}

TEST(SampleCone, IsUniformInSolidAngleForWideAndNarrowCones) {
    for (const double one_minus_cos : {0.7, 1e-3, 1e-7}) {
        RandomStream random = test_stream();
        expect_distributed(
            [&] {
                const Vector d = sample_cone(random.next_2d(), static_cast<float>(one_minus_cos));
                const double sine_squared = static_cast<double>(d.x) * d.x + static_cast<double>(d.y) * d.y;
                return std::pair<double, double>(sine_squared / (1.0 + std::sqrt(1.0 - sine_squared)) / one_minus_cos,
                                                 azimuth(d));
            },
            [](double, double) { return 1.0 / (2.0 * pi); }, 0.0, 1.0 + 1e-5, 0.0, 2.0 * pi);
    }
}

TEST(SampleTriangle, IsUniformInArea) {
    RandomStream random = test_stream();
    expect_distributed(
        [&] {
            const auto p = sample_triangle(random.next_2d());
            return std::pair<double, double>(p.x, p.x < 1 ? p.y / (1 - p.x) : 0.0);
        },
        [](double x, double) { return 2.0 * (1.0 - x); }, 0.0, 1.0, 0.0, 1.0 + 1e-6);
}

/// Area that a small square around u covers after a warp to the plane or to directions, divided by the square's own.
template <typename Warp>
double stretch(const Warp& warp, const Imath::V2f& u) {
    const float h = 1e-3f;
    const auto at = [&](float x, float y) { return VectorD(warp(Imath::V2f(x, y))); };
    const VectorD along_x = (at(u.x + h, u.y) - at(u.x - h, u.y)) / (2.0 * h);
    const VectorD along_y = (at(u.x, u.y + h) - at(u.x, u.y - h)) / (2.0 * h);
    return along_x.cross(along_y).length();
}

TEST(Warps, StretchAreaByTheInverseOfTheirDensity) {
    for (const Imath::V2f& u :
         {Imath::V2f(0.2f, 0.3f), Imath::V2f(0.7f, 0.4f), Imath::V2f(0.6f, 0.9f), Imath::V2f(0.11f, 0.83f)}) {
        EXPECT_NEAR(stretch(
                        [](const Imath::V2f& v) {
                            const auto p = sample_unit_disc(v);
                            return Vector(p.x, p.y, 0);
                        },
                        u),
                    pi, 0.01);
        const auto cosine = [](const Imath::V2f& v) { return sample_cosine_hemisphere(v); };
        EXPECT_NEAR(stretch(cosine, u) * cosine_hemisphere_density(cosine(u).z), 1.0, 0.01);
        EXPECT_NEAR(stretch([](const Imath::V2f& v) { return sample_unit_sphere(v); }, u), 4.0 * pi, 0.05);
        EXPECT_NEAR(stretch([](const Imath::V2f& v) { return sample_cone(v, 0.3f); }, u), 2.0 * pi * 0.3, 0.01);
        EXPECT_NEAR(stretch(
                        [](const Imath::V2f& v) {
                            const auto p = sample_triangle(v);
                            return Vector(p.x, p.y, 0);
                        },
                        u),
                    0.5, 0.005);
    }
}

}  // namespace
}  // namespace photonlab
