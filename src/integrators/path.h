// Path tracing from the hit points: one path at each in every pass. Unbiased, free of photons and radii, and so the
// independent method by which the others are judged; references are made with it.
//
// At each vertex light is found twice, by a connection to a point on a light and by the direction that continues the
// path, and the two are weighted by the balance heuristic: with densities p and q per steradian, w_p = p / (p + q).
//
// [Kajiya 1986, "The Rendering Equation"; Veach & Guibas 1995, "Optimally Combining Sampling Techniques"]

#pragma once

#include <memory>

#include "integrators/integrator.h"

namespace photonlab {

std::unique_ptr<Integrator> make_path(const MethodSettings& settings, const IntegratorContext& context);

}  // namespace photonlab
