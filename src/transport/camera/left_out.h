// What a scene lets the program leave out: what is stored and which code runs follow from what the scene holds.

#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "transport/camera/camera_pass.h"

namespace photonlab {

/// One sentence for each thing that is left out, with the bytes that it saves at these hit points.
std::vector<std::string> what_is_left_out(const Scene& scene, const HitPoints& hit_points);

}  // namespace photonlab
