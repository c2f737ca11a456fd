// The settings of a method as JSON: in run.json, in the keys of runs and references, in checkpoints.

#pragma once

#include "core/files/json.h"
#include "integrators/settings/settings.h"

namespace photonlab {

/// Every setting by name; null where the method does not use it.
Json settings_json(const MethodSettings& settings);

}  // namespace photonlab
