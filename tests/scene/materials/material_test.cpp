// Materials: what they sample against their density, and both against what they evaluate.
//
// The chi-square fails by chance with probability 1e-4; its seed is fixed.

#include "scene/materials/material.h"

#include <gtest/gtest.h>

#include "core/random.h"
#include "tests/support/chi_square.h"
#include "tests/support/test_stream.h"

namespace photonlab {
namespace {

Bsdf diffuse(const Color& reflectance) {
    return Diffuse{reflectance};
}

const Vector slanted(0.6f, 0.0f, 0.8f);

TEST(Diffuse, SamplesByItsDensity) {
    const Bsdf material = diffuse(Color(0.5f));
    RandomStream random = test_stream(0, 13);
    expect_distributed(
        [&] {
            const auto drawn = sample(material, slanted, Carried::Radiance, random.next_2d());
            return std::pair<double, double>(drawn->incoming.z, std::atan2(drawn->incoming.y, drawn->incoming.x));
        },
        [&](double z, double) {
            return density(material, slanted, {0, 0, static_cast<float>(z)});
        },
        0.0, 1.0, -pi, pi);
}

TEST(Diffuse, StretchesSolidAngleByTheInverseOfItsDensity) {
    const Bsdf material = diffuse(Color(0.5f));
    const float h = 1e-3f;
    for (const Imath::V2f& u : {Imath::V2f(0.2f, 0.3f), Imath::V2f(0.7f, 0.4f), Imath::V2f(0.6f, 0.9f)}) {
        const auto at = [&](float x, float y) {
            return VectorD(sample(material, slanted, Carried::Radiance, {x, y})->incoming);
        };
        const VectorD along_x = (at(u.x + h, u.y) - at(u.x - h, u.y)) / (2.0 * h);
        const VectorD along_y = (at(u.x, u.y + h) - at(u.x, u.y - h)) / (2.0 * h);
        EXPECT_NEAR(along_x.cross(along_y).length() * sample(material, slanted, Carried::Radiance, u)->density, 1.0,
                    0.01);
    }
}

TEST(Diffuse, WeighsASampleByValueTimesCosineOverDensity) {
    const Bsdf material = diffuse(Color(0.3f, 0.6f, 0.9f));
    RandomStream random = test_stream(0, 13);
    for (int i = 0; i < 1000; ++i) {
        const auto drawn = sample(material, slanted, Carried::Radiance, random.next_2d());
        ASSERT_TRUE(drawn);
        const Color expected = evaluate(material, slanted, drawn->incoming) *
                               (drawn->incoming.z / density(material, slanted, drawn->incoming));
        for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(expected[channel], drawn->weight[channel], 1e-6);
        EXPECT_FLOAT_EQ(drawn->density, density(material, slanted, drawn->incoming));
    }
}

TEST(Diffuse, ReflectsItsReflectanceOfUniformLight) {
    // The integral of f cos over the hemisphere, by the midpoint rule in z: f does not depend on the azimuth.
    const Bsdf material = diffuse(Color(0.3f, 0.6f, 0.9f));
    ColorD sum(0.0);
    for (int i = 0; i < 1000; ++i) {
        const float z = (static_cast<float>(i) + 0.5f) / 1000.0f;
        sum += ColorD(evaluate(material, slanted, {std::sqrt(1.0f - z * z), 0, z})) * (2.0 * pi * z / 1000.0);
    }
    EXPECT_NEAR(sum.x, 0.3, 1e-5);
    EXPECT_NEAR(sum.y, 0.6, 1e-5);
    EXPECT_NEAR(sum.z, 0.9, 1e-5);
}

TEST(Diffuse, IsReciprocal) {
    const Bsdf material = diffuse(Color(0.3f, 0.6f, 0.9f));
    const Vector incoming(0.0f, 0.28f, 0.96f);
    EXPECT_EQ(evaluate(material, slanted, incoming), evaluate(material, incoming, slanted));
}

TEST(Diffuse, IsBlackBelowTheSurface) {
    const Bsdf material = diffuse(Color(0.5f));
    const Vector below(0.6f, 0.0f, -0.8f);
    EXPECT_TRUE(is_black(evaluate(material, slanted, below)));
    EXPECT_TRUE(is_black(evaluate(material, below, slanted)));
    EXPECT_EQ(density(material, slanted, below), 0.0f);
    EXPECT_EQ(density(material, below, slanted), 0.0f);
    EXPECT_FALSE(sample(material, below, Carried::Radiance, {0.3f, 0.3f}));
}

TEST(IsBlack, MeansThatEveryChannelIsZero) {
    EXPECT_TRUE(is_black(diffuse(Color(0.0f))));
    EXPECT_FALSE(is_black(diffuse(Color(0.0f, 0.0f, 1e-30f))));
}

}  // namespace
}  // namespace photonlab
