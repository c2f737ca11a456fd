// Photon mapping, directly visualised: all photons of all passes so far, gathered at the hit points without final
// gathering. The baseline whose bias progressive photon mapping removes. Caustic photons, which came from the light by
// mirrors and glass alone, have a map and settings of their own.
//
// Mode `radius` averages over a fixed disc: with more photons its variance vanishes and its bias stays. Mode `nearest`
// averages over the k nearest photons: with more photons the disc and with it the bias shrink, and the variance stays
// near 1/k. Its memory grows with the passes.
//
// [Jensen 1996, "Global Illumination using Photon Maps"; Jensen 2001, chapter 7]

#pragma once

#include <memory>

#include "integrators/integrator.h"

namespace photonlab {

std::unique_ptr<Integrator> make_photonmapper(const MethodSettings& settings, const IntegratorContext& context);

}  // namespace photonlab
