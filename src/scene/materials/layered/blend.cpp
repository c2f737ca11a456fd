#include "scene/materials/layered/blend.h"

#include <fmt/format.h>

#include "core/sampling.h"
#include "scene/materials/material_reader.h"

namespace photonlab {

SpecularBranches Blend::branches(const Vector& outgoing, Carried carried) const {
    SpecularBranches result;
    const auto add = [&](const Part& part, float share) {
        if (!(share > 0.0f)) return;
        for (const SpecularBranch& branch : part.branches(outgoing, carried))
            result.add(branch.incoming, branch.weight * share);
    };
    add(first, 1.0f - weight);
    add(second, weight);
    return result;
}

Color Blend::evaluate(const Vector& outgoing, const Vector& incoming) const {
    return first.evaluate(outgoing, incoming) * (1.0f - weight) + second.evaluate(outgoing, incoming) * weight;
}

/// What both bring in the direction over the density of both, which is less noisy than what the drawn one brings. Of
/// flux that is refracted the drawn one alone knows what it brings: evaluate() is for radiance. (Both are unbiased, and
/// which is taken depends on the direction alone.)
std::optional<BsdfSample> Blend::sample(const Vector& outgoing, Carried carried, const Imath::V2f& u) const {
    const ShareChoice second_or_first = choose_by_share(u.x, weight);
    auto drawn = (second_or_first.is_chosen ? second : first).sample(outgoing, carried, {second_or_first.rest, u.y});
    if (!drawn || !(drawn->density > 0.0f)) return drawn;
    drawn->density = density(outgoing, drawn->incoming);
    if (carried == Carried::Radiance || drawn->incoming.z > 0.0f)
        drawn->weight = evaluate(outgoing, drawn->incoming) * (std::abs(drawn->incoming.z) / drawn->density);
    return drawn;
}

float Blend::density(const Vector& outgoing, const Vector& incoming) const {
    return first.density(outgoing, incoming) * (1.0f - weight) + second.density(outgoing, incoming) * weight;
}

bool Blend::has_specular_lobe() const {
    return (weight < 1.0f && first.has_specular_lobe()) || (weight > 0.0f && second.has_specular_lobe());
}

bool Blend::has_scattering_lobe() const {
    return (weight < 1.0f && first.has_scattering_lobe()) || (weight > 0.0f && second.has_scattering_lobe());
}

Color Blend::straight_through() const {
    Color result(0.0f);
    if (weight < 1.0f) result += first.straight_through() * (1.0f - weight);
    if (weight > 0.0f) result += second.straight_through() * weight;
    return result;
}

Blend Blend::read(MaterialReader& reader) {
    Blend blend;
    blend.weight = reader.share_or_texture("weight", 0.5f, &Blend::weight);
    const std::vector<Material>& parts = reader.parts(2);
    blend.first.material = &parts[0];
    blend.second.material = &parts[1];
    return blend;
}

void Blend::check(const MaterialCheck& check) const {
    check.require(weight >= 0.0f && weight <= 1.0f, fmt::format("a weight in [0, 1], got {}", weight));
    check.part(first.material);
    check.part(second.material);
}

}  // namespace photonlab
