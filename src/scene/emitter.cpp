#include "scene/emitter.h"

#include <algorithm>

namespace photonlab {

std::uint32_t choose_emitter(const Scene& scene, double u) {
    const auto found =
        std::upper_bound(scene.emitters.begin(), scene.emitters.end() - 1, u,
                         [](double value, const Emitter& emitter) { return value < emitter.choice_cdf; });
    return static_cast<std::uint32_t>(found - scene.emitters.begin());
}

EmissionSample sample_emission(const Scene& scene, std::uint32_t emitter_index, const Imath::V2f& u_position,
                               double u_triangle, const Imath::V2f& u_direction) {
    const Emitter& emitter = scene.emitters[emitter_index];
    const EmissionDraw draw{u_position, u_triangle, u_direction};
    Emission emission = std::visit([&](const auto& light) { return light.emit(scene.shapes, draw); }, emitter.kind);
    if (emission.from && is_occluded(scene, {emission.ray.origin, *emission.from}))
        emission.ray.origin = *emission.from;
    return {emission.ray, emitter.photon_power * Color(emission.share)};
}

std::optional<DirectSample> sample_direct(const Scene& scene, std::uint32_t emitter_index, const Vector& receiver,
                                          const Imath::V2f& u, double u_triangle) {
    return std::visit([&](const auto& light) { return light.sample_direct(scene.shapes, receiver, u, u_triangle); },
                      scene.emitters[emitter_index].kind);
}

double direct_density(const Scene& scene, const Vector& receiver, const Vector& direction, const Hit& hit) {
    const Shape& shape = scene.shapes[hit.shape];
    return shape.emitter == no_emitter ? 0.0 : seen_density(shape, receiver, direction, hit);
}

ColorD emitted_radiance(const Scene& scene, const Hit& hit, const Vector& outgoing) {
    const std::uint32_t emitter = scene.shapes[hit.shape].emitter;
    if (emitter == no_emitter || !(hit.geometric_normal.dot(outgoing) > 0.0f)) return ColorD(0.0);
    const Light& light = scene.emitters[emitter].kind;
    if (const auto* plain = std::get_if<AreaLight>(&light)) return plain->radiance;
    return std::get<TexturedAreaLight>(light).radiance_at(hit.texture_coordinate);
}

ColorD escaped_radiance(const Scene& scene, const Vector& direction) {
    if (!scene.environment) return ColorD(0.0);
    return std::visit(
        [&]<typename Kind>(const Kind& light) {
            if constexpr (EnvironmentKind<Kind>)
                return light.radiance_from(direction);
            else
                return ColorD(0.0);
        },
        scene.emitters[*scene.environment].kind);
}

ColorD met_radiance(const Scene& scene, const std::optional<Hit>& hit, const Vector& direction) {
    return hit ? emitted_radiance(scene, *hit, -direction) : escaped_radiance(scene, direction);
}

double escaped_density(const Scene& scene, const Vector& direction) {
    if (!scene.environment) return 0.0;
    return std::visit(
        [&]<typename Kind>(const Kind& light) {
            if constexpr (EnvironmentKind<Kind>)
                return light.density_of(direction);
            else
                return 0.0;
        },
        scene.emitters[*scene.environment].kind);
}

}  // namespace photonlab
