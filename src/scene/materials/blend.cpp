#include "scene/materials/blend.h"

#include <fmt/format.h>

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

std::optional<BsdfSample> Blend::sample(const Vector& outgoing, Carried carried, const Imath::V2f& u) const {
    const bool is_second = u.x < weight;
    const float rest = std::min(is_second ? u.x / weight : (u.x - weight) / (1.0f - weight), 0x1.fffffep-1f);
    auto drawn = (is_second ? second : first).sample(outgoing, carried, {rest, u.y});
    if (drawn && drawn->density > 0.0f) drawn->density = density(outgoing, drawn->incoming);
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
