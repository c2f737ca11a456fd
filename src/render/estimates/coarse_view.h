// A scene's hit points as a camera of few pixels with the same view finds them: what mirrors and glass split is among
// them, and their footprints are those of the scene's own pixels. From them it is known what all of them will take,
// before they are there.

#pragma once

#include "scene/scene.h"
#include "transport/camera/camera_pass.h"

namespace photonlab {

struct CoarseView {
    HitPoints hit_points;
    double pixel_scale = 1.0;  ///< pixels of the scene's camera to those of this one
    double scale = 1.0;        ///< hit points of the scene's camera, at all sample positions, to those of this one
};

CoarseView trace_coarse_view(const Scene& scene, int samples_per_pixel, int threads, double branch_cutoff);

}  // namespace photonlab
