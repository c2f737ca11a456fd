// Mode `relaxed` of photonmapper.

#pragma once

#include <memory>

#include "integrators/integrator.h"

namespace photonlab {

std::unique_ptr<Integrator> make_relaxed_photon_mapping(const MethodSettings& settings,
                                                        const IntegratorContext& context);

/// Throws InputError where the scene has light that such photons cannot hold: they stand for light from all directions,
/// so that surfaces must be diffuse where light is gathered.
void require_relaxable(const Scene& scene, int max_depth);

}  // namespace photonlab
