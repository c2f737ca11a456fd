// Spectra by wavelength to the linear RGB that everything is computed in, as Mitsuba's RGB variants do it: integrated
// against the CIE 1931 observer and brought to sRGB's primaries. What a surface reflects or refracts is weighted with
// the illuminant D65 by Mitsuba 3, and not by 0.6; what a light emits by neither.

#pragma once

#include <string>
#include <vector>

#include "core/math.h"

namespace photonlab {

/// Values at wavelengths: linear in between, zero outside.
struct Spectrum {
    std::vector<double> wavelengths;  ///< nm, rising
    std::vector<double> values;
};

/// "400:0.1, 500:0.3": pairs of wavelength and value. Throws InputError at `place`.
Spectrum parse_spectrum(const std::string& text, const std::string& place);

/// Under D65: 1 everywhere is (1, 1, 1). Colours outside sRGB's gamut are clamped to at least 0.
ColorD rgb_under_d65(const Spectrum& spectrum);

/// As it is: of Y = 1 for a value of 1 everywhere, which is equal-energy white and not sRGB's, so its red is above its
/// blue. Colours outside sRGB's gamut are clamped to at least 0.
ColorD rgb_under_equal_energy(const Spectrum& spectrum);

/// rgb_under_equal_energy of 1 at all wavelengths.
ColorD equal_energy_white();

}  // namespace photonlab
