// Progressive photon mapping: gather radii that shrink as photons accumulate, so that bias and variance vanish together
// in bounded memory.
//
// Each pass makes a density estimate of its own at every hit point, with the radius before it shrinks, and the image is
// the running mean of these: the same numbers as the 2008 paper's shrinking flux, to rounding, and stable over millions
// of passes (docs/theory.md, section 1; a test shows it).
//
// [Hachisuka, Ogaki & Jensen 2008, "Progressive Photon Mapping"; Knaus & Zwicker 2011]

#pragma once

#include <memory>

#include "integrators/integrator.h"

namespace photonlab {

std::unique_ptr<Integrator> make_ppm(const MethodSettings& settings, const IntegratorContext& context);

}  // namespace photonlab
