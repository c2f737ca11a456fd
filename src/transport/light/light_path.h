// One light path, whatever its random numbers come from: a stream, or a vector that a Markov chain changes.
//
// `Numbers` answers next(), next_double() and next_2d() as RandomStream does. A path draws them in one order: those of
// its emission, then three a bounce.
//
// [Jensen 2001, "Realistic Image Synthesis Using Photon Mapping", chapter 4; Veach 1996, section 5.3]

#pragma once

#include <algorithm>
#include <optional>

#include "scene/emitter.h"
#include "transport/light/emission_map.h"
#include "transport/light/photons.h"
#include "transport/path_length.h"

namespace photonlab {

/// Asymmetry of the BSDF's adjoint under shading normals, for a photon that arrives against `arriving` and leaves along
/// `leaving`: |arriving.ns leaving.ng| / |arriving.ng leaving.ns|. 1 on a flat surface. [Veach 1996, section 5.3]
inline float adjoint_correction(const Surface& surface, const Vector& arriving, const Vector& leaving) {
    const Vector& shading = surface.frame.normal;
    const Vector& geometric = surface.geometric_normal;
    if (shading == geometric) return 1.0f;
    return std::abs(arriving.dot(shading) * leaving.dot(geometric)) /
           std::abs(arriving.dot(geometric) * leaving.dot(shading));
}

/// What arrives at a surface.
struct Arrival {
    const Vector& from;  ///< unit
    const Color& power;
    std::uint32_t edges;
    bool only_specular;
};

/// Leaves a photon on a surface that spreads light.
inline void store(const std::optional<Surface>& surface, const Arrival& arrival, PhotonPass& result) {
    if (!surface || !is_scattering(surface->bsdf)) return;
    const Vector& normal = surface->frame.normal;
    const Vector& geometric = surface->geometric_normal;
    const Color carried = normal == geometric
                              ? arrival.power
                              : arrival.power * std::abs(arrival.from.dot(normal) / arrival.from.dot(geometric));
    if (is_finite(surface->position) && is_finite(arrival.from) && is_finite(carried))
        result.photons.push_back({.position = surface->position,
                                  .power = carried,
                                  .incoming = PackedDirection(arrival.from),
                                  .normal = CoarseDirection(normal),
                                  .edges = static_cast<std::uint16_t>(arrival.edges & 0x3fffu),
                                  .from_back = surface->from_back,
                                  .caustic = arrival.only_specular && arrival.edges > 1});
    else
        ++result.nonfinite;
}

/// Plain emission: of a light chosen by power, uniform over what it emits.
template <typename Numbers>
EmissionSample draw_emission(const Scene& scene, Numbers& numbers) {
    const std::uint32_t emitter = choose_emitter(scene, numbers.next_double());
    const Imath::V2f u_position = numbers.next_2d();
    const double u_triangle = numbers.next_double();
    const Imath::V2f u_direction = numbers.next_2d();
    return sample_emission(scene, emitter, u_position, u_triangle, u_direction);
}

/// Emission by a learnt density, and the cell that was drawn.
struct LearntEmission {
    EmissionSample emission;
    std::uint32_t cell;
};

template <typename Numbers>
LearntEmission draw_emission(const Scene& scene, const EmissionMap& map, Numbers& numbers) {
    const EmissionMap::Choice choice = map.choose(numbers.next_double());
    Imath::V2f u_position = numbers.next_2d();
    const double u_triangle = numbers.next_double();
    Imath::V2f u_direction = numbers.next_2d();
    Imath::V2f& u_learnt = choice.square == EmissionMap::Square::Direction ? u_direction : u_position;
    u_learnt = EmissionMap::within(choice.cell, u_learnt);
    EmissionSample emission = sample_emission(scene, choice.emitter, u_position, u_triangle, u_direction);
    emission.weight *= static_cast<float>(choice.weight);
    return {emission, choice.cell};
}

/// Follows emitted light from surface to surface and leaves its photons.
template <typename Numbers>
void follow_light(const Scene& scene, const PhotonSettings& settings, const EmissionSample& emission, Numbers& numbers,
                  PhotonPass& result) {
    Ray ray = emission.ray;
    Color power = emission.weight;
    bool only_specular = true;
    // The camera's side of a path has at least one edge, so a photon may have at most max_depth - 1.
    const std::uint32_t edge_limit =
        settings.max_depth < 0 ? largest_path_edges : static_cast<std::uint32_t>(std::max(0, settings.max_depth - 1));
    for (std::uint32_t edges = 1; edges <= edge_limit; ++edges) {
        const std::optional<Hit> hit = intersect(scene, ray);
        if (!hit) return;
        const Vector arriving = -ray.direction;
        const std::optional<Surface> surface = orient(scene, *hit, arriving);
        if (edges > 1 || settings.store_direct) {
            // Where a texture turns the normal, the path may end though a point nearby can gather the photon.
            const bool is_turned = has_turned_normals(scene.materials[scene.shapes[hit->shape].material]);
            const std::optional<Surface> to_gather = is_turned ? orient_to_gather(scene, *hit, arriving) : std::nullopt;
            store(is_turned ? to_gather : surface, {arriving, power, edges, only_specular}, result);
        }
        if (!surface) return;
        if (edges == edge_limit) break;

        const std::optional<BsdfSample> bounce =
            sample(surface->bsdf, surface->frame.to_local(arriving), Carried::Flux, numbers.next_2d());
        const float survival_draw = numbers.next();
        if (!bounce) return;
        only_specular = only_specular && bounce->density == 0.0f;
        const float survival = std::min(max_channel(bounce->weight), highest_survival);
        if (survival_draw >= survival) return;
        const Vector leaving = surface->frame.to_world(bounce->incoming);
        if (!sides_agree(*surface, leaving)) return;
        power *= bounce->weight * (adjoint_correction(*surface, arriving, leaving) / survival);
        ray = {offset_from_surface(surface->position, surface->geometric_normal, leaving), leaving};
    }
    if (settings.max_depth < 0) {
        ++result.paths_cut;
        result.power_cut += mean_channel(ColorD(power));
    }
}

}  // namespace photonlab
