#include "transport/camera/plain_images.h"

#include <algorithm>

namespace photonlab {

std::vector<std::string> why_images_are_plain(const Scene& scene, const HitPoints& hit_points) {
    const auto material_is = [&](const auto& property) {
        return std::all_of(scene.shapes.begin(), scene.shapes.end(),
                           [&](const Shape& shape) { return property(scene.materials[shape.material].bsdf); });
    };
    std::vector<std::string> reasons;
    if (scene.emitters.empty()) reasons.emplace_back("there is no light: every image of this scene is black");
    if (scene.shapes.empty())
        reasons.emplace_back("there is no surface: every image of this scene is black");
    else if (hit_points.points.empty())
        reasons.push_back((material_is(is_specular) ? std::string("every surface is a mirror or glass")
                                                    : std::string("the camera sees no surface to gather at")) +
                          ": nothing is gathered, and images show emission alone");
    return reasons;
}

}  // namespace photonlab
