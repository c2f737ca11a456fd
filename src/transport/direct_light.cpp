#include "transport/direct_light.h"

#include "scene/emitter.h"

namespace photonlab {

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

}  // namespace photonlab
