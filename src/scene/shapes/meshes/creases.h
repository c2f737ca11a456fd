// A mesh whose normals are to be smooth but for its creases: Mitsuba 0.6's maxSmoothAngle.

#pragma once

#include "scene/shapes/mesh.h"

namespace photonlab {

/// Forgets normals, and gives each bundle of faces that meet at a point at no more than `largest_angle` (degrees) a
/// vertex of its own there, which those with other texture coordinates or of another group do not share: normals that
/// are then computed are smooth within a bundle. A bundle is what lies within the angle of its first face. `groups` has
/// one for each triangle; empty: all are of one. Throws InputError, said of `place`, where so many faces of so many
/// directions meet that it would take hours.
void split_at_creases(MeshDescription& mesh, double largest_angle, const std::vector<std::uint32_t>& groups,
                      const std::string& place);

}  // namespace photonlab
