// Errors of an image against a reference: on linear radiance, before any tone mapping or clamping, over all pixels
// and channels.
//
// With a reference of two independent halves A and B, r = (A+B)/2 and
//   mse            mean (x-r)^2: has the reference's own variance as its floor
//   mse_unbiased   mean (x-A)(x-B): an unbiased estimate of the true MSE, negative by chance near 0
//   floor          mean (A-B)^2 / 4: the variance of r, the floor under mse
//   relmse         mean (x-r)^2 / (r^2 + 0.01); the 0.01 is in squared units of radiance, so relMSE is not free of
//                  the scene's scale of brightness
//   smape          mean |x-r| / (|x| + |r| + 1e-6)
//   bias           mean (x-r), signed
//   max_error      largest |x-r|
// A non-finite x is counted in `nonfinite`, and its pixel left out of the other sums; where no pixel is left, these are
// NaN, not 0. A reference that is not finite judges nothing: InputError.

#pragma once

#include <cstdint>
#include <optional>
#include <string>
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

struct ErrorMetrics {
    double mse = 0.0;
    std::optional<double> mse_unbiased;  ///< with halves only
    double rmse = 0.0;
    double relmse = 0.0;
    double smape = 0.0;
    double bias = 0.0;
    double max_error = 0.0;
    std::optional<double> reference_floor;       ///< with halves only
    std::uint64_t nonfinite = 0;                 ///< pixels with a non-finite channel
    std::optional<std::size_t> first_nonfinite;  ///< index of the first such pixel
};

/// Sizes must agree (asserted; files are checked where they are read). Throws InputError when the reference holds a
/// value that is not finite.
ErrorMetrics compare(const std::vector<ColorD>& image, const ReferencePixels& reference);

/// The root mean square error as figures show it: "0.0121 without the reference's noise", the root of `mse_unbiased`;
/// "below what the reference can tell" where that is not above 0; and of a reference without halves the root of `mse`,
/// said to hold its noise.
std::string describe_rmse(const ErrorMetrics& metrics);

}  // namespace photonlab
