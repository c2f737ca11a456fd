// What a method says of its own error (integrators/error_estimate.h), in few numbers: how large it says it is, how
// often it is right where a reference knows, and whether it is small enough to stop.
//
// With bias B, deviation sigma and nu = passes - 1 degrees of freedom, image - truth is claimed to lie within B +- t
// sigma in a share q of the pixels, t being Student's quantile of (1 + q) / 2. After Hachisuka, Jarosz & Jensen 2010.

#pragma once

#include <optional>
#include <vector>

#include "image/image.h"
#include "image/metrics.h"

namespace photonlab {

/// Over the pixels whose noise is known: those that photons ever reached, from the second pass on.
struct JudgedEstimate {
    double bias = 0.0;                               ///< root mean square
    double deviation = 0.0;                          ///< likewise
    std::optional<double> within_50 = std::nullopt;  ///< share of pixels whose true error is within the bound of 50%;
                                                     ///< empty without a reference
    std::optional<double> within_90 = std::nullopt;
};

/// `gathered`: the pixels that the estimate is of; `truth`: those of the reference, or empty. Empty when no pixel's
/// noise is known.
std::optional<JudgedEstimate> judge_estimate(const EstimatedError& estimate, const std::vector<Color>& gathered,
                                             const std::vector<ColorD>& truth);

/// Share of the lit pixels whose value is within `relative_error` of the truth with probability `confidence`, as far as
/// the estimate knows: |B| + t sigma, of the value less B. 0 when no pixel's noise is known.
double share_within(const EstimatedError& estimate, const std::vector<Color>& gathered, double relative_error,
                    double confidence);

}  // namespace photonlab
