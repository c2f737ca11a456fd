// Why a scene's images will be plain: black all over, or nothing but lights seen by the camera. Such a scene is no
// error, and its image is right; but whoever forgot a light wants to be told.

#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"
#include "transport/camera/camera_pass.h"

namespace photonlab {

/// A sentence a reason; empty for a scene with a light and a surface to gather at in the picture.
std::vector<std::string> why_images_are_plain(const Scene& scene, const HitPoints& hit_points);

}  // namespace photonlab
