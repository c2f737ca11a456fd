// Error metrics against numbers worked out by hand.

#include "image/metrics.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace photonlab {
namespace {

constexpr double nan_value = std::numeric_limits<double>::quiet_NaN();

ReferencePixels single(std::vector<ColorD> mean) {
    return {.mean = std::move(mean), .half_a = {}, .half_b = {}};
}

ReferencePixels halves(std::vector<ColorD> a, std::vector<ColorD> b) {
    ReferencePixels reference{.mean = {}, .half_a = std::move(a), .half_b = std::move(b)};
    for (std::size_t i = 0; i < reference.half_a.size(); ++i)
        reference.mean.push_back((reference.half_a[i] + reference.half_b[i]) * 0.5);
    return reference;
}

// Two pixels, errors 1, -2, 0 and 0, 0, 3.
TEST(Compare, AgreesWithHandComputedValues) {
    const ErrorMetrics metrics = compare({{2, 0, 5}, {0, 1, 4}}, single({{1, 2, 5}, {0, 1, 1}}));
    EXPECT_DOUBLE_EQ(metrics.of("mse").value(), 14.0 / 6.0);
    EXPECT_DOUBLE_EQ(metrics.of("rmse").value(), std::sqrt(14.0 / 6.0));
    EXPECT_DOUBLE_EQ(metrics.of("relmse").value(), (1 / 1.01 + 4 / 4.01 + 9 / 1.01) / 6.0);
    EXPECT_DOUBLE_EQ(metrics.of("smape").value(), (1 / (3 + 1e-6) + 2 / (2 + 1e-6) + 3 / (5 + 1e-6)) / 6.0);
    EXPECT_DOUBLE_EQ(metrics.of("bias").value(), 2.0 / 6.0);
    EXPECT_EQ(metrics.of("max_error").value(), 3.0);
    EXPECT_EQ(metrics.nonfinite, 0u);
    EXPECT_FALSE(metrics.first_nonfinite);
}

TEST(Compare, LeavesWhatNeedsHalvesEmptyWithoutThem) {
    const ErrorMetrics metrics = compare({ColorD(1.0)}, single({ColorD(1.0)}));
    EXPECT_FALSE(metrics.of("mse_unbiased"));
    EXPECT_FALSE(metrics.of("relmse_unbiased"));
    EXPECT_FALSE(metrics.of("reference_floor"));
}

// x = 4, A = 1, B = 2: 3 * 2 beside 1.5^2 + 0.01.
TEST(Compare, RelativeErrorsAreFreeOfTheReferencesNoiseAsWell) {
    const ErrorMetrics metrics = compare({ColorD(4.0)}, halves({ColorD(1.0)}, {ColorD(2.0)}));
    EXPECT_DOUBLE_EQ(metrics.of("relmse_unbiased").value(), 6.0 / 2.26);
    EXPECT_DOUBLE_EQ(metrics.of("relmse").value(), 6.25 / 2.26);
}

// x = 2, A = 1, B = 2: mse (0.5)^2, unbiased 1 * 0, floor 1/4.
TEST(Compare, UsesBothHalvesOfTheReference) {
    const ErrorMetrics metrics = compare({ColorD(2.0)}, halves({ColorD(1.0)}, {ColorD(2.0)}));
    EXPECT_DOUBLE_EQ(metrics.of("mse").value(), 0.25);
    EXPECT_DOUBLE_EQ(metrics.of("mse_unbiased").value(), 0.0);
    EXPECT_DOUBLE_EQ(metrics.of("reference_floor").value(), 0.25);
}

// (x-A)(x-B) = (x-r)^2 - (A-B)^2/4 holds for every pixel, so for the means too.
TEST(Compare, MseIsItsUnbiasedFormPlusTheFloor) {
    const ErrorMetrics metrics =
        compare({{0.3, 1.7, 2.2}, {0.9, 0.1, 5.0}},
                halves({{0.2, 1.5, 2.5}, {1.0, 0.0, 4.0}}, {{0.4, 1.6, 2.4}, {0.7, 0.3, 4.5}}));
    EXPECT_NEAR(metrics.of("mse").value(), metrics.of("mse_unbiased").value() + metrics.of("reference_floor").value(),
                1e-15);
}

TEST(Compare, UnbiasedMseMayBeNegative) {
    const ErrorMetrics metrics = compare({ColorD(1.0)}, halves({ColorD(0.9)}, {ColorD(1.1)}));
    EXPECT_NEAR(metrics.of("mse_unbiased").value(), -0.01, 1e-15);
    EXPECT_NEAR(metrics.of("reference_floor").value(), 0.01, 1e-15);
}

TEST(Compare, CountsLocatesAndLeavesOutPixelsThatAreNotFinite) {
    const double inf = std::numeric_limits<double>::infinity();
    const std::vector<ColorD> image = {{2, 2, 2}, {nan_value, 9, 9}, {1, 1, 1}, {9, -inf, nan_value}};
    const std::vector<ColorD> reference(4, ColorD(1.0));
    const ErrorMetrics metrics = compare(image, halves(reference, reference));
    EXPECT_EQ(metrics.nonfinite, 2u);
    EXPECT_EQ(metrics.first_nonfinite, 1u);
    EXPECT_DOUBLE_EQ(metrics.of("mse").value(), 0.5);  // of the two pixels that are left
    EXPECT_DOUBLE_EQ(metrics.of("mse_unbiased").value(), 0.5);
    EXPECT_DOUBLE_EQ(metrics.of("bias").value(), 0.5);
    EXPECT_EQ(metrics.of("max_error").value(), 1.0);
}

TEST(Compare, ClaimsNothingOfAnImageWithoutOneFinitePixel) {
    const ErrorMetrics metrics = compare({ColorD(nan_value)}, halves({ColorD(1.0)}, {ColorD(1.0)}));
    EXPECT_EQ(metrics.nonfinite, 1u);
    for (const double value : {metrics.of("mse").value(), metrics.of("rmse").value(), metrics.of("relmse").value(),
                               metrics.of("smape").value(), metrics.of("bias").value(), metrics.of("max_error").value(),
                               metrics.of("mse_unbiased").value(), metrics.of("reference_floor").value()})
        EXPECT_TRUE(std::isnan(value));
}

TEST(Compare, RefusesAReferenceThatIsNotFinite) {
    try {
        compare({ColorD(1.0), ColorD(1.0)}, single({ColorD(1.0), {1.0, nan_value, 1.0}}));
        FAIL() << "nothing was thrown";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("the reference is not finite at pixel 1"), std::string::npos);
    }
}

TEST(Compare, BlackAgainstBlackIsNoError) {
    const ErrorMetrics metrics = compare({ColorD(0.0)}, single({ColorD(0.0)}));
    EXPECT_EQ(metrics.of("smape").value(), 0.0);
    EXPECT_EQ(metrics.of("relmse").value(), 0.0);
}

// A pair of fireflies of 1e17 and -1e17 around 30,000 small errors: a plain sum of the differences would lose them.
TEST(Compare, SmallErrorsSurviveFireflies) {
    std::vector<ColorD> image(10'000, ColorD(1.0 + 0x1p-4));
    image.front() = ColorD(1e17);
    image.back() = ColorD(-1e17);
    std::vector<ColorD> reference(10'000, ColorD(1.0));
    reference.front() = reference.back() = ColorD(0.0);
    EXPECT_DOUBLE_EQ(compare(image, single(reference)).of("bias").value(), 0x1p-4 * 9998.0 / 10'000.0);
}

// Powers of two scale exactly: errors do not care whether radiance is counted in small or large units.
TEST(Compare, ScalesExactlyWithPowersOfTwo) {
    const std::vector<ColorD> image = {{0.3, 0.7, 1.1}, {2.5, 0.2, 0.9}};
    const std::vector<ColorD> a = {{0.25, 0.8, 1.0}, {2.0, 0.1, 1.0}};
    const std::vector<ColorD> b = {{0.35, 0.75, 1.05}, {2.25, 0.15, 0.95}};
    const ErrorMetrics unit = compare(image, halves(a, b));
    for (const double scale : {0x1p-100, 0x1p100}) {
        const auto scaled = [&](std::vector<ColorD> pixels) {
            for (ColorD& pixel : pixels) pixel *= scale;
            return pixels;
        };
        const ErrorMetrics metrics = compare(scaled(image), halves(scaled(a), scaled(b)));
        EXPECT_EQ(metrics.of("mse").value(), unit.of("mse").value() * scale * scale);
        EXPECT_EQ(metrics.of("mse_unbiased").value(), unit.of("mse_unbiased").value() * scale * scale);
        EXPECT_EQ(metrics.of("rmse").value(), unit.of("rmse").value() * scale);
        EXPECT_EQ(metrics.of("bias").value(), unit.of("bias").value() * scale);
        EXPECT_EQ(metrics.of("max_error").value(), unit.of("max_error").value() * scale);
    }
}

}  // namespace
}  // namespace photonlab
