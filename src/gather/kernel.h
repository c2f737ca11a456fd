// Kernels of density estimation: how a photon at distance d from the centre of a disc of radius r counts, with
// s = d / r. Each is normalised over the disc; docs/theory.md's table (bias constant, variance relative to the constant
// disc) stands in the tests.
//
// [Silverman 1986, "Density Estimation for Statistics and Data Analysis", section 4.2]

#pragma once

#include <array>

#include "core/math.h"
#include "core/text/names.h"

namespace photonlab {

enum class Kernel { Disc, Cone, Epanechnikov, Biweight };

inline constexpr std::array kernel_names{
    ChoiceName<Kernel>{Kernel::Disc, "disc"}, ChoiceName<Kernel>{Kernel::Cone, "cone"},
    ChoiceName<Kernel>{Kernel::Epanechnikov, "epanechnikov"}, ChoiceName<Kernel>{Kernel::Biweight, "biweight"}};
constexpr const auto& choice_names(Kernel) {
    return kernel_names;
}

/// The kernel's value times pi r^2, at the squared relative distance s^2 = d^2 / r^2 in [0, 1]: 1 for the constant
/// disc.
inline double kernel_weight(Kernel kernel, double s_squared) {
    switch (kernel) {
        case Kernel::Disc:
            return 1.0;
        case Kernel::Cone:
            return 3.0 * (1.0 - std::sqrt(s_squared));
        case Kernel::Epanechnikov:
            return 2.0 * (1.0 - s_squared);
        case Kernel::Biweight:
            return 3.0 * (1.0 - s_squared) * (1.0 - s_squared);
    }
    return 0.0;
}

/// c: where the light has Laplacian Delta, the estimate's bias is c r^2 Delta. A quarter of the kernel's mean squared
/// relative distance; docs/theory.md, section 4.
inline double bias_constant(Kernel kernel) {
    switch (kernel) {
        case Kernel::Disc:
            return 1.0 / 8.0;
        case Kernel::Cone:
            return 3.0 / 40.0;
        case Kernel::Epanechnikov:
            return 1.0 / 12.0;
        case Kernel::Biweight:
            return 1.0 / 16.0;
    }
    return 0.0;
}

}  // namespace photonlab
