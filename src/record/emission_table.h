// What emission that learns has learnt, as a table: a row a cell of a light's square (transport/light/emission_map.h).
// It is what the figure of it is drawn from, and with seed and settings all that later passes need.

#pragma once

#include <string>

#include "scene/scene.h"
#include "transport/light/emission_map.h"

namespace photonlab {

/// CSV with a header: light, kind, square, row, column, plain, probability, paths, acceptances.
std::string emission_table(const Scene& scene, const EmissionMap& map);

}  // namespace photonlab
