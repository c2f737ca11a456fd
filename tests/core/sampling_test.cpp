// Warps against their densities, by chi-square and by their Jacobian, and the random streams against published numbers.

#include "core/sampling.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "tests/support/chi_square.h"

namespace photonlab {
namespace {

RandomStream test_stream(std::uint64_t index = 0) { return RandomStream(7, RandomPurpose::Test, 1, index); }

double azimuth(const Vector& direction) {
    const double angle = std::atan2(direction.y, direction.x);
    return angle < 0.0 ? angle + 2.0 * pi : angle;
}

TEST(SampleUnitDisc, IsUniformInArea) {
    RandomStream random = test_stream();
    expect_distributed([&] { const auto p = sample_unit_disc(random.next_2d()); return std::pair<double, double>(p.length2(), azimuth({p.x, p.y, 0})); },
                       [](double, double) { return 1.0 / (2.0 * pi); }, 0.0, 1.0 + 1e-6, 0.0, 2.0 * pi);
}

TEST(SampleCosineHemisphere, FollowsTheCosine) {
    RandomStream random = test_stream();
    expect_distributed([&] { const Vector d = sample_cosine_hemisphere(random.next_2d()); return std::pair<double, double>(d.z, azimuth(d)); },
                       [](double z, double) { return cosine_hemisphere_density(static_cast<float>(z)); }, 0.0, 1.0, 0.0, 2.0 * pi);
}

TEST(SampleUnitSphere, IsUniformInSolidAngle) {
    RandomStream random = test_stream();
    expect_distributed([&] { const Vector d = sample_unit_sphere(random.next_2d()); return std::pair<double, double>(d.z, azimuth(d)); },
                       [](double, double) { return 1.0 / (4.0 * pi); }, -1.0, 1.0, 0.0, 2.0 * pi);
}

TEST(SampleCone, IsUniformInSolidAngleForWideAndNarrowCones) {
    for (const double one_minus_cos : {0.7, 1e-3, 1e-7}) {
        RandomStream random = test_stream();
        expect_distributed(
            [&] {
                const Vector d = sample_cone(random.next_2d(), static_cast<float>(one_minus_cos));
                const double sine_squared = static_cast<double>(d.x) * d.x + static_cast<double>(d.y) * d.y;
                return std::pair<double, double>(sine_squared / (1.0 + std::sqrt(1.0 - sine_squared)) / one_minus_cos, azimuth(d));
            },
            [](double, double) { return 1.0 / (2.0 * pi); }, 0.0, 1.0 + 1e-5, 0.0, 2.0 * pi);
    }
}

TEST(SampleTriangle, IsUniformInArea) {
    RandomStream random = test_stream();
    expect_distributed([&] { const auto p = sample_triangle(random.next_2d()); return std::pair<double, double>(p.x, p.x < 1 ? p.y / (1 - p.x) : 0.0); },
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
    for (const Imath::V2f& u : {Imath::V2f(0.2f, 0.3f), Imath::V2f(0.7f, 0.4f), Imath::V2f(0.6f, 0.9f), Imath::V2f(0.11f, 0.83f)}) {
        EXPECT_NEAR(stretch([](const Imath::V2f& v) { const auto p = sample_unit_disc(v); return Vector(p.x, p.y, 0); }, u), pi, 0.01);
        const auto cosine = [](const Imath::V2f& v) { return sample_cosine_hemisphere(v); };
        EXPECT_NEAR(stretch(cosine, u) * cosine_hemisphere_density(cosine(u).z), 1.0, 0.01);
        EXPECT_NEAR(stretch([](const Imath::V2f& v) { return sample_unit_sphere(v); }, u), 4.0 * pi, 0.05);
        EXPECT_NEAR(stretch([](const Imath::V2f& v) { return sample_cone(v, 0.3f); }, u), 2.0 * pi * 0.3, 0.01);
        EXPECT_NEAR(stretch([](const Imath::V2f& v) { const auto p = sample_triangle(v); return Vector(p.x, p.y, 0); }, u), 0.5, 0.005);
    }
}

TEST(MakeFrame, IsOrthonormalAroundEveryNormal) {
    RandomStream random = test_stream();
    std::vector<Vector> normals{{0, 0, 1}, {0, 0, -1}, {0, 0, -0.0f}, {1, 0, 0}, {0, 1, 0}};
    normals[2] = Vector(1e-5f, 0, -1).normalized();
    for (int i = 0; i < 1000; ++i) normals.push_back(sample_unit_sphere(random.next_2d()).normalized());
    for (const Vector& normal : normals) {
        const Frame frame = make_frame(normal);
        EXPECT_NEAR(frame.tangent.length(), 1.0, 1e-5);
        EXPECT_NEAR(frame.bitangent.length(), 1.0, 1e-5);
        EXPECT_NEAR(frame.tangent.dot(frame.bitangent), 0.0, 1e-5);
        EXPECT_LT((frame.tangent.cross(frame.bitangent) - normal).length(), 1e-5);
        const Vector direction = sample_unit_sphere(random.next_2d());
        EXPECT_LT((frame.to_world(frame.to_local(direction)) - direction).length(), 1e-5);
    }
}

TEST(RandomStream, IsPhilox4x32With10Rounds) {
    // The answer that Random123 publishes for counter 0 and key 0.
    const auto block = r123::Philox4x32()({{0, 0, 0, 0}}, {{0, 0}});
    EXPECT_EQ(block[0], 0x6627e8d5u);
    EXPECT_EQ(block[1], 0xe169c58du);
    EXPECT_EQ(block[2], 0xbc57ac4cu);
    EXPECT_EQ(block[3], 0x9b00dbd8u);
}

TEST(RandomStream, DependsOnEveryPartOfItsName) {
    const auto first = [](std::uint64_t seed, RandomPurpose purpose, std::uint64_t pass, std::uint64_t index) {
        RandomStream random(seed, purpose, pass, index);
        const std::uint64_t high = random.next_bits();
        return high << 32 | random.next_bits();
    };
    const std::uint64_t base = first(1, RandomPurpose::Test, 1, 1);
    EXPECT_EQ(base, first(1, RandomPurpose::Test, 1, 1));
    EXPECT_NE(base, first(2, RandomPurpose::Test, 1, 1));
    EXPECT_NE(base, first(1 + (std::uint64_t{1} << 32), RandomPurpose::Test, 1, 1));
    EXPECT_NE(base, first(1, RandomPurpose::PhotonPaths, 1, 1));
    EXPECT_NE(base, first(1, RandomPurpose::Test, 2, 1));
    EXPECT_NE(base, first(1, RandomPurpose::Test, 1, 2));
    EXPECT_NE(base, first(1, RandomPurpose::Test, 1, 1 + (std::uint64_t{1} << 32)));
}

TEST(RandomStream, IsUniformBelowOne) {
    expect_distributed(
        [index = std::uint64_t{0}]() mutable {
            RandomStream random = test_stream(index++);
            const double x = random.next();
            return std::pair<double, double>(x, random.next_double());
        },
        [](double, double) { return 1.0; }, 0.0, 1.0, 0.0, 1.0);
}

TEST(OffsetFromSurface, GoesToTheSideOfTheDirectionAndScalesWithTheCoordinate) {
    const Vector normal(0, 1, 0);
    EXPECT_GT(offset_from_surface({0, 0.25f, 0}, normal, {0.9f, 0.1f, 0}).y, 0.25f);
    EXPECT_LT(offset_from_surface({0, 0.25f, 0}, normal, {0.9f, -0.1f, 0}).y, 0.25f);
    EXPECT_GT(offset_from_surface({0, 1000.0f, 0}, normal, {0, 1, 0}).y, 1000.0f);
}

}  // namespace
}  // namespace photonlab
