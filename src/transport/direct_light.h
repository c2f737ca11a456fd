// Direct light at a surface: a light chosen by power, a point on it, a shadow ray. Surfaces of glass block shadow rays;
// what reaches a point through them is the photons' to bring.

#pragma once

#include <optional>

#include "core/math.h"
#include "core/random.h"
#include "scene/scene.h"

namespace photonlab {

/// One unoccluded connection of a surface to a light.
struct ConnectedLight {
    ColorD contribution;   ///< radiance reflected towards the viewer, divided by the density of the connection:
                           ///< unbiased, its noise is that of the choice of light and of the point on it
    double light_density;  ///< per steradian, with which this direction was drawn, the choice of light included;
                           ///< 0 for a point light, which no other technique can find
    double bsdf_density;   ///< per steradian, with which the material would have drawn it; 0 for a point light
};

/// A connection before its shadow ray.
struct LightConnection {
    ConnectedLight light;
    Segment segment;  ///< from the surface to the light, whose occlusion is still to be asked for
};

/// Draws a connection of `surface` to one point on one light; empty when no light comes from there, whatever lies
/// between. Always draws the same number of random numbers.
std::optional<LightConnection> draw_connection(const Scene& scene, const Surface& surface, const Vector& outgoing,
                                               RandomStream& random);

/// draw_connection() and its shadow ray; empty when it is blocked.
std::optional<ConnectedLight> connect_to_light(const Scene& scene, const Surface& surface, const Vector& outgoing,
                                               RandomStream& random);

/// What the ray in a direction drawn from a surface's BSDF meets.
struct LobeRay {
    std::optional<Hit> hit;  ///< empty where it leaves the scene
    ColorD light;            ///< that it brings, times weight_of_ray()
};

/// Follows the ray along `direction`, which was drawn with `bsdf_density`; light that it meets is multiplied by
/// `throughput`.
LobeRay follow_lobe(const Scene& scene, const Surface& surface, const Vector& direction, float bsdf_density,
                    const Color& throughput);

/// Light that the surface reflects from a direction drawn from its BSDF, times weight_of_ray(): with draw_connection()
/// and weight_of_connection(), direct light by both techniques. Nothing from single directions, which the camera pass
/// follows. Always draws the same number of random numbers.
ColorD light_along_lobe(const Scene& scene, const Surface& surface, const Vector& outgoing, RandomStream& random);

/// Weights of the balance heuristic for light that is found twice, by a connection and by the ray that goes on, which
/// was drawn from the BSDF with `bsdf_density` per steradian; 0: in a single direction, which no connection finds.
/// [Veach & Guibas 1995, "Optimally Combining Sampling Techniques"]
double weight_of_connection(const ConnectedLight& light);
double weight_of_ray(const Scene& scene, const Vector& position, const Vector& direction, const std::optional<Hit>& hit,
                     float bsdf_density);

}  // namespace photonlab
