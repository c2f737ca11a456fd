// How bias and variance of ppm fall with its passes, against theory, where both are known: at the foot of a point light
// over a plane.
//
// With the radii of Knaus and Zwicker, which do not depend on the photons, a pass's estimate is the number of photons
// in a disc times a constant, and passes are independent. So, after n passes with radii r_i:
//
//     E[L_n]   = rho / pi  mean over i of  2 I (1 - h / sqrt(h^2 + r_i^2)) / r_i^2          (docs/theory.md, section 5)
//     Var[L_n] = n^-2  sum over i of  (rho Phi / (pi^2 r_i^2 N))^2  N p_i (1 - p_i),   p_i = (1 - h / sqrt(...)) / 2
//
// with N paths a pass, Phi = 4 pi I, and p_i the share of the sphere of directions that the disc covers. Claimed are
// means and variances after each of some passes, and the slopes of both on logarithmic axes: for each alpha, all alphas
// on the same photons. All claims of this file share a significance of 1e-3 by Bonferroni.
//
// [Knaus and Zwicker 2011, "Progressive Photon Mapping: A Probabilistic Approach"]

#include <gtest/gtest.h>

#include <array>

#include "render/run_methods.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

constexpr double significance = 1e-3;
constexpr double height = 1.5;
constexpr double intensity = 9.0;
constexpr float reflectance = 0.5f;
constexpr double first_radius = 0.75;
constexpr std::uint64_t paths = 2000;
constexpr std::size_t seeds = 256;
constexpr std::array<double, 7> alphas{0.5, 0.6, 2.0 / 3.0, 0.7, 0.8, 0.9, 1.0};
const std::vector<std::uint64_t> recorded{1, 2, 4, 8, 16, 32, 64};
constexpr std::size_t first_of_window = 2;  // slopes are fitted to passes 4 to 64

struct Moments {
    std::vector<double> mean;      // by recorded pass
    std::vector<double> variance;  // of one run
};

/// The formulas above; radii by the recursion of Knaus and Zwicker, equation 20.
Moments predict(double alpha) {
    Moments result;
    double squared_radius = first_radius * first_radius;
    double mean_sum = 0.0;
    double variance_sum = 0.0;
    for (std::uint64_t pass = 1; pass <= recorded.back(); ++pass) {
        const double q = std::sqrt(height * height + squared_radius);
        const double p = squared_radius / (2.0 * q * (q + height));  // (1 - h / q) / 2 without cancellation
        const double one_photon = reflectance / pi * 4.0 * pi * intensity / (pi * squared_radius * paths);
        mean_sum += one_photon * paths * p;
        variance_sum += one_photon * one_photon * paths * p * (1.0 - p);
        const auto n = static_cast<double>(pass);
        if (std::find(recorded.begin(), recorded.end(), pass) != recorded.end()) {
            result.mean.push_back(mean_sum / n);
            result.variance.push_back(variance_sum / (n * n));
        }
        squared_radius *= (n + alpha) / (n + 1.0);
    }
    return result;
}

/// Radiance at the foot: [alpha][recorded pass][seed].
using Values = std::vector<std::vector<std::vector<double>>>;

Values measure() {
    SceneDescription description;
    description.materials = {diffuse(Color(reflectance))};
    description.shapes = {disk(VectorD(0.0), VectorD(0, 1, 0), 30.0, 0)};
    description.lights = {point_light(VectorD(0.0, height, 0.0), ColorD(intensity))};
    description.camera = look_at(VectorD(0.7, 1.0, 0.2), VectorD(0.0));
    const Scene scene = build_scene(description);
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    Values values(alphas.size(), std::vector<std::vector<double>>(recorded.size()));
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        std::vector<RunSettings> together;
        for (const double alpha : alphas) {
            RunSettings run;
            run.method.schedule = ScheduleName::KnausZwicker;
            run.method.alpha = alpha;
            run.method.radius = first_radius;
            run.method.direct = DirectMode::Photons;
            run.method.max_depth = 2;
            run.method.photons_per_pass = paths;
            run.seed = seed;
            run.passes = recorded.back();
            run.shown = recorded;
            together.push_back(run);
        }
        run_methods(scene, hit_points, together, [&](std::size_t method, const RunState& state, const Image& image) {
            const auto at = std::find(recorded.begin(), recorded.end(), state.pass) - recorded.begin();
            values[method][static_cast<std::size_t>(at)].push_back(image.find(gathered_layer)->at(0).x);
        });
    }
    return values;
}

double mean_of(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value;
    return sum / static_cast<double>(values.size());
}

double variance_of(const std::vector<double>& values) {
    const double mean = mean_of(values);
    double sum = 0.0;
    for (const double value : values) sum += (value - mean) * (value - mean);
    return sum / static_cast<double>(values.size() - 1);
}

/// Slope of log(value) against log(pass), least squares over the window.
double slope_of(const std::vector<double>& values) {
    double x_mean = 0.0;
    double y_mean = 0.0;
    const auto count = static_cast<double>(values.size() - first_of_window);
    for (std::size_t i = first_of_window; i < values.size(); ++i) {
        x_mean += std::log(static_cast<double>(recorded[i])) / count;
        y_mean += std::log(values[i]) / count;
    }
    double product = 0.0;
    double square = 0.0;
    for (std::size_t i = first_of_window; i < values.size(); ++i) {
        const double x = std::log(static_cast<double>(recorded[i])) - x_mean;
        product += x * (std::log(values[i]) - y_mean);
        square += x * x;
    }
    return product / square;
}

struct Slopes {
    double variance;
    double squared_bias;
};

/// Of the runs but `left_out` (seeds: of all). The squared bias of their mean is free of its variance.
Slopes slopes_of(const std::vector<std::vector<double>>& by_pass, double truth, std::size_t left_out) {
    std::vector<double> variances;
    std::vector<double> squared_biases;
    for (std::vector<double> values : by_pass) {
        if (left_out < values.size()) values.erase(values.begin() + static_cast<std::ptrdiff_t>(left_out));
        const double bias = mean_of(values) - truth;
        variances.push_back(variance_of(values));
        squared_biases.push_back(bias * bias - variances.back() / static_cast<double>(values.size()));
    }
    return {slope_of(variances), slope_of(squared_biases)};
}

TEST(KnausZwicker, BiasAndVarianceFallAsPredicted) {
    const Values values = measure();
    const double truth = reflectance / pi * intensity / (height * height);
    struct Claim {
        std::string what;
        double difference, error;
        int degrees;
    };
    std::vector<Claim> claims;
    for (std::size_t a = 0; a < alphas.size(); ++a) {
        const std::string alpha = "alpha " + std::to_string(alphas[a]);
        const Moments predicted = predict(alphas[a]);
        for (std::size_t i = 0; i < recorded.size(); ++i) {
            const std::string what = alpha + ", pass " + std::to_string(recorded[i]);
            const double variance = variance_of(values[a][i]);
            claims.push_back({what + ", mean", mean_of(values[a][i]) - predicted.mean[i],
                              std::sqrt(variance / static_cast<double>(seeds)), static_cast<int>(seeds) - 1});
            // Counts are near 100 photons and more, so estimates are nearly normal: the variance of a variance.
            claims.push_back({what + ", variance", variance - predicted.variance[i],
                              predicted.variance[i] * std::sqrt(2.0 / static_cast<double>(seeds - 1)), 1000});
        }
        std::vector<double> predicted_bias;
        for (const double mean : predicted.mean) predicted_bias.push_back((mean - truth) * (mean - truth));
        const Slopes all = slopes_of(values[a], truth, seeds);
        Slopes sum{0.0, 0.0};
        Slopes squares{0.0, 0.0};
        for (std::size_t seed = 0; seed < seeds; ++seed) {
            const Slopes one = slopes_of(values[a], truth, seed);
            sum = {sum.variance + one.variance, sum.squared_bias + one.squared_bias};
            squares = {squares.variance + one.variance * one.variance,
                       squares.squared_bias + one.squared_bias * one.squared_bias};
        }
        const auto jackknife = [&](double s, double s2) {
            const auto n = static_cast<double>(seeds);
            return std::sqrt((n - 1.0) / n * (s2 - s * s / n));
        };
        const double variance_error = jackknife(sum.variance, squares.variance);
        const double bias_error = jackknife(sum.squared_bias, squares.squared_bias);
        EXPECT_LT(variance_error, 0.06) << alpha << ": too noisy to say anything";
        EXPECT_LT(bias_error, 0.06) << alpha << ": too noisy to say anything";
        claims.push_back({alpha + ", slope of variance", all.variance - slope_of(predicted.variance), variance_error,
                          static_cast<int>(seeds) - 1});
        claims.push_back({alpha + ", slope of squared bias", all.squared_bias - slope_of(predicted_bias), bias_error,
                          static_cast<int>(seeds) - 1});
    }
    for (const Claim& claim : claims)
        EXPECT_GE(student_p_value(claim.difference / claim.error, claim.degrees),
                  significance / static_cast<double>(claims.size()))
            << claim.what << ": off by " << claim.difference << ", standard error " << claim.error << " (one of "
            << claims.size() << " claims)";
}

}  // namespace
}  // namespace photonlab::test
