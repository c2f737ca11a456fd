// Errors of an image against a reference: on linear radiance, before any tone mapping or clamping, over all pixels
// and channels. Each is one line of the table in metrics.cpp, which has its formula; the records, `photonlab compare`,
// the manual and the figures take it from there.
//
// With a reference of two independent halves A and B, r = (A+B)/2. A non-finite value of the image is counted in
// `nonfinite`, and its pixel left out of the other sums; where no pixel is left, these are NaN, not 0. A reference that
// is not finite judges nothing: InputError.

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/math.h"

namespace photonlab {

/// The epsilon in SMAPE's denominator, in units of radiance.
inline constexpr double smape_epsilon = 1e-6;

/// A reference's pixels: the mean, and the halves when it has two.
struct ReferencePixels {
    std::vector<ColorD> mean;
    std::vector<ColorD> half_a;  ///< empty: a single image without a known floor
    std::vector<ColorD> half_b;
};

/// The pixels of an image that are finite, beside those of the reference.
class ComparedPixels;

/// A measure of error.
struct Metric {
    std::string_view name;     ///< of its column
    std::string_view unit;     ///< empty where it has none
    std::string_view label;    ///< how figures name it
    std::string_view meaning;  ///< for the manual
    bool needs_halves = false;
    double (*of)(const ComparedPixels&);
};

/// In the order of their columns.
const std::vector<Metric>& metrics();

struct ErrorMetrics {
    std::vector<std::optional<double>> values;   ///< in the order of metrics(); empty without the halves it needs
    std::uint64_t nonfinite = 0;                 ///< pixels with a non-finite channel
    std::optional<std::size_t> first_nonfinite;  ///< index of the first such pixel

    /// The metric of this name, which must be in the table.
    std::optional<double> of(std::string_view metric) const;
};

/// Sizes must agree (asserted; files are checked where they are read). Throws InputError when the reference holds a
/// value that is not finite.
ErrorMetrics compare(const std::vector<ColorD>& image, const ReferencePixels& reference);

/// The root mean square error as figures show it: "0.0121 without the reference's noise", the root of `mse_unbiased`;
/// "below what the reference can tell" where that is not above 0; and of a reference without halves the root of `mse`,
/// said to hold its noise.
std::string describe_rmse(const ErrorMetrics& errors);

}  // namespace photonlab
