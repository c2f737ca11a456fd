#include "render/estimates/coarse_view.h"

#include <algorithm>

namespace photonlab {

namespace {

constexpr int side = 64;  // pixels, at most

}  // namespace

CoarseView trace_coarse_view(const Scene& scene, int samples_per_pixel, int threads, double branch_cutoff) {
    Camera coarse = scene.camera;
    coarse.width = std::min(coarse.width, side);
    coarse.height = std::min(coarse.height, side);
    CoarseView view{.hit_points = trace_hit_points(scene, coarse, 1, threads, branch_cutoff)};
    view.pixel_scale = static_cast<double>(scene.camera.width) * static_cast<double>(scene.camera.height) /
                       static_cast<double>(pixel_count(view.hit_points));
    view.scale = static_cast<double>(samples_per_pixel) * view.pixel_scale;
    return view;
}

}  // namespace photonlab
