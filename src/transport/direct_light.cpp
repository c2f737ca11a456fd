#include "transport/direct_light.h"

#include "scene/emitter.h"

namespace photonlab {

namespace {

/// Density per steradian with which draw_connection() finds the light that a ray from `position` met; `hit` is empty
/// where it left the scene.
double connection_density(const Scene& scene, const Vector& position, const Vector& direction,
                          const std::optional<Hit>& hit) {
    const std::uint32_t light = hit ? scene.shapes[hit->shape].emitter : *scene.environment;
    const double density = hit ? direct_density(scene, position, direction, *hit) : escaped_density(scene, direction);
    return scene.emitters[light].choice_probability * density;
}

}  // namespace

std::optional<LightConnection> draw_connection(const Scene& scene, const Surface& surface, const Vector& outgoing,
                                               RandomStream& random) {
    if (scene.emitters.empty()) return std::nullopt;
    const std::uint32_t emitter = choose_emitter(scene, random.next_double());
    const Imath::V2f u = random.next_2d();
    const double u_triangle = random.next_double();
    const std::optional<DirectSample> light = sample_direct(scene, emitter, surface.position, u, u_triangle);
    if (!light || !sides_agree(surface, light->direction)) return std::nullopt;

    const Vector local_outgoing = surface.frame.to_local(outgoing);
    const Vector local_incoming = surface.frame.to_local(light->direction);
    const Color f = evaluate(surface.bsdf, local_outgoing, local_incoming);
    if (is_black(f)) return std::nullopt;
    const Vector origin = offset_from_surface(surface.position, surface.geometric_normal, light->direction);

    const double probability = scene.emitters[emitter].choice_probability;
    const double cosine = std::abs(local_incoming.z);
    const ConnectedLight connected{
        .contribution = light->radiance * ColorD(f) * (cosine / (light->density * probability)),
        .light_density = light->is_delta ? 0.0 : light->density * probability,
        .bsdf_density = light->is_delta ? 0.0 : density(surface.bsdf, local_outgoing, local_incoming)};
    return LightConnection{connected, {origin, light->position}};
}

std::optional<ConnectedLight> connect_to_light(const Scene& scene, const Surface& surface, const Vector& outgoing,
                                               RandomStream& random) {
    const std::optional<LightConnection> connection = draw_connection(scene, surface, outgoing, random);
    if (!connection || is_occluded(scene, connection->segment)) return std::nullopt;
    return connection->light;
}

LobeRay follow_lobe(const Scene& scene, const Surface& surface, const Vector& direction, float bsdf_density,
                    const Color& throughput) {
    const auto hit =
        intersect(scene, {offset_from_surface(surface.position, surface.geometric_normal, direction), direction});
    const ColorD emitted = met_radiance(scene, hit, direction);
    if (is_black(emitted)) return {hit, ColorD(0.0)};
    const double weight = weight_of_ray(scene, surface.position, direction, hit, bsdf_density);
    return {hit, ColorD(throughput) * emitted * weight};
}

ColorD light_along_lobe(const Scene& scene, const Surface& surface, const Vector& outgoing, RandomStream& random) {
    const auto drawn = sample(surface.bsdf, surface.frame.to_local(outgoing), Carried::Radiance, random.next_2d());
    if (!drawn || !(drawn->density > 0.0f)) return ColorD(0.0);
    const Vector direction = surface.frame.to_world(drawn->incoming);
    if (!sides_agree(surface, direction)) return ColorD(0.0);
    return follow_lobe(scene, surface, direction, drawn->density, drawn->weight).light;
}

double weight_of_connection(const ConnectedLight& light) {
    return light.light_density > 0.0 ? light.light_density / (light.light_density + light.bsdf_density) : 1.0;
}

double weight_of_ray(const Scene& scene, const Vector& position, const Vector& direction, const std::optional<Hit>& hit,
                     float bsdf_density) {
    if (!(bsdf_density > 0.0f)) return 1.0;
    const double density = static_cast<double>(bsdf_density);
    return density / (density + connection_density(scene, position, direction, hit));
}

}  // namespace photonlab
