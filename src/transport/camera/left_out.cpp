#include "transport/camera/left_out.h"

#include <fmt/format.h>

namespace photonlab {

std::vector<std::string> what_is_left_out(const Scene& scene, const HitPoints& hit_points) {
    constexpr std::size_t radius_and_count = sizeof(double) + sizeof(std::uint32_t);
    const std::size_t count = hit_points.points.size();
    const HitPointList::Kept kept = HitPointList::kept_for(scene);
    std::vector<std::string> left_out;
    if (!has_specular_surfaces(scene))
        left_out.push_back(
            fmt::format("no mirror, no glass: no branches of camera paths, no caustic map (photonmapper: {} bytes)",
                        count * radius_and_count));
    if (!kept.texture_coordinates)
        left_out.push_back(fmt::format("no textures: no look-ups, no coordinates of hit points ({} bytes)",
                                       count * sizeof(Imath::V2f)));
    if (!kept.outgoing)
        left_out.push_back(
            fmt::format("light is gathered on diffuse surfaces alone: no direction to the camera ({} bytes), one "
                        "product with the reflectance for all photons of a hit point",
                        count * sizeof(Vector)));
    if (!kept.turns)
        left_out.push_back(fmt::format(
            "no roughness depends on the direction: no turn of hit points' frames ({} bytes)", count * sizeof(float)));
    if (count > 0)
        left_out.push_back(fmt::format("neighbours share normals and weights: {:.1f} bytes a hit point in place of {}",
                                       static_cast<double>(hit_points.points.bytes()) / static_cast<double>(count),
                                       sizeof(HitPoint)));
    return left_out;
}

}  // namespace photonlab
