#include "scene/material.h"

namespace photonlab {

std::optional<BsdfSample> choose_branch(const SpecularBranches& branches, float u) {
    float total = 0.0f;
    for (const SpecularBranch& branch : branches) total += max_channel(branch.weight);
    if (!(total > 0.0f)) return std::nullopt;
    const bool first = branches.count == 1 || u * total < max_channel(branches.branch[0].weight);
    const SpecularBranch& chosen = branches.branch[first ? 0 : 1];
    const float strength = max_channel(chosen.weight);
    if (!(strength > 0.0f)) return std::nullopt;
    return BsdfSample{chosen.incoming, chosen.weight * (total / strength), 0.0f};
}

const char* material_kind(const Material& material) {
    return std::visit([]<typename B>(const B&) { return B::name; }, material.bsdf);
}

SpecularBranches specular_branches(const Bsdf& bsdf, const Vector& outgoing, Carried carried) {
    return std::visit(
        [&]<typename B>(const B& b) {
            if constexpr (Specular<B>)
                return b.branches(outgoing, carried);
            else
                return SpecularBranches{};
        },
        bsdf);
}

}  // namespace photonlab
