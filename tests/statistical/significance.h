// How a statistical test decides: each claim "the mean of these independent values is x" becomes a p-value of Student's
// test, whose variance comes from the values themselves, and all claims of one test share a significance of 1e-4 by
// Bonferroni: a right program fails one seed in ten thousand a test, and the seeds are fixed.
//
// A test that cannot see an error proves nothing, so every claim also states the largest relative standard error with
// which it counts as having looked.
//
// [Abramowitz & Stegun, 26.7.3 and 26.7.4: Student's distribution for whole degrees of freedom]

#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "core/math.h"

namespace photonlab::test {

inline constexpr double family_significance = 1e-4;

/// Rounding of float32 geometry and pixels that no claim is meant to notice, relative to what is expected.
inline constexpr double rounding_allowance = 2e-5;

/// Probability that |t| of `degrees_of_freedom` degrees (>= 1) is at least this large.
inline double student_p_value(double t, int degrees_of_freedom) {
    const double angle = std::atan(std::abs(t) / std::sqrt(static_cast<double>(degrees_of_freedom)));
    const double cosine = std::cos(angle);
    const bool odd = degrees_of_freedom % 2 != 0;
    double term = odd ? cosine : 1.0;
    double sum = degrees_of_freedom == 1 ? 0.0 : term;
    for (int power = odd ? 3 : 2; power <= degrees_of_freedom - 2; power += 2) {
        term *= cosine * cosine * (power - 1) / power;
        sum += term;
    }
    const double inside = odd ? 2.0 / pi * (angle + std::sin(angle) * sum) : std::sin(angle) * sum;
    return std::max(0.0, 1.0 - inside);
}

/// Mean of independent values, and how well they know it.
struct SampleMean {
    double mean = 0.0;
    double squared_error = 0.0;  ///< of the mean: sample variance / count
    int degrees_of_freedom = 0;

    explicit SampleMean(const std::vector<double>& values) {
        const double count = static_cast<double>(values.size());
        for (const double value : values) mean += value / count;
        for (const double value : values) squared_error += (value - mean) * (value - mean) / (count * (count - 1.0));
        degrees_of_freedom = static_cast<int>(values.size()) - 1;
    }
};

/// Claims of one test; judged together when it ends.
class ClaimFamily {
public:
    ClaimFamily() = default;
    ClaimFamily(const ClaimFamily&) = delete;
    ClaimFamily& operator=(const ClaimFamily&) = delete;

    /// The expectation of the independent `values` is `expected`, but for a difference of at most `bias`, seen with at
    /// most `largest_error` (both relative).
    void mean_is(const std::string& what, const std::vector<double>& values, double expected, double largest_error,
                 double bias = 0.0) {
        const SampleMean sample(values);
        add(what, sample.mean, expected, std::sqrt(sample.squared_error), sample.degrees_of_freedom, largest_error,
            bias);
    }

    /// Like mean_is() for each value's difference from an expectation of its own, or from the value that it is paired
    /// with; errors are relative to their mean.
    void means_are(const std::string& what, const std::vector<double>& values, const std::vector<double>& expected,
                   double largest_error, double bias = 0.0) {
        std::vector<double> shifted(values);
        const double common = SampleMean(expected).mean;
        for (std::size_t i = 0; i < values.size(); ++i) shifted[i] += common - expected[i];
        mean_is(what, shifted, common, largest_error, bias);
    }

    /// Two independent samples have the same expectation, but for a difference of at most `bias` relative to the
    /// second. [Welch 1947, for samples of different variance]
    void means_agree(const std::string& what, const std::vector<double>& first, const std::vector<double>& second,
                     double largest_error, double bias = 0.0) {
        const SampleMean a(first);
        const SampleMean b(second);
        const double squared_error = a.squared_error + b.squared_error;
        const double freedom = squared_error * squared_error /
                               (a.squared_error * a.squared_error / a.degrees_of_freedom +
                                b.squared_error * b.squared_error / b.degrees_of_freedom);
        add(what, a.mean, b.mean, std::sqrt(squared_error),
            std::isfinite(freedom) ? std::max(1, static_cast<int>(freedom)) : a.degrees_of_freedom, largest_error,
            bias);
    }

    ~ClaimFamily() {
        EXPECT_FALSE(claims_.empty());
        for (const Claim& claim : claims_)
            EXPECT_GE(claim.p_value, family_significance / static_cast<double>(claims_.size()))
                << claim.what << " (one of " << claims_.size() << " claims)";
    }

private:
    struct Claim {
        std::string what;
        double p_value;
    };

    void add(const std::string& what, double mean, double expected, double error, int degrees_of_freedom,
             double largest_error, double bias = 0.0) {
        EXPECT_LE(error, largest_error * std::abs(expected)) << what << ": too noisy to say anything";
        const double difference =
            std::max(0.0, std::abs(mean - expected) - (rounding_allowance + bias) * std::abs(expected));
        // NaN must not pass: only a difference that compares as 0 is certain.
        const double t =
            std::abs(mean - expected) <= (rounding_allowance + bias) * std::abs(expected) ? 0.0 : difference / error;
        const std::string numbers = what + ": mean " + std::to_string(mean) + ", expected " + std::to_string(expected) +
                                    ", standard error " + std::to_string(error);
        claims_.push_back({numbers, std::isnan(mean) ? 0.0 : student_p_value(t, degrees_of_freedom)});
    }

    std::vector<Claim> claims_;
};

}  // namespace photonlab::test
