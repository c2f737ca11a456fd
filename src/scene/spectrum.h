// Spectra by wavelength to the linear RGB that everything is computed in, as Mitsuba's RGB variants do it: integrated
// against the CIE 1931 observer, reflectances under the illuminant D65, and brought to sRGB's primaries.

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

/// What the surface reflects of D65: a reflectance of 1 everywhere is (1, 1, 1). Colours outside sRGB's gamut are
/// clamped to [0, 1].
ColorD reflectance_to_rgb(const Spectrum& spectrum);

/// What the light emits, in the spectrum's unit: of Y = 1 for a value of 1 everywhere, which is equal-energy white and
/// not sRGB's, so its red is above its blue. Colours outside sRGB's gamut are clamped to at least 0.
ColorD emission_to_rgb(const Spectrum& spectrum);

/// emission_to_rgb of 1 at all wavelengths.
ColorD equal_energy_white();

}  // namespace photonlab
