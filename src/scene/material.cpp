#include "scene/material.h"

namespace photonlab {

namespace {

template <typename B>
concept Specular = requires(const B& bsdf, const Vector& outgoing) {
    bsdf.branches(outgoing, Carried::Flux);
};

/// Draws a branch with the probability of its share of the strongest channel.
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

}  // namespace

Color evaluate(const Bsdf& bsdf, const Vector& outgoing, const Vector& incoming) {
    return std::visit(
        [&]<typename B>(const B& b) {
            if constexpr (Specular<B>)
                return Color(0.0f);
            else
                return b.evaluate(outgoing, incoming);
        },
        bsdf);
}

std::optional<BsdfSample> sample(const Bsdf& bsdf, const Vector& outgoing, Carried carried, const Imath::V2f& u) {
    return std::visit(
        [&]<typename B>(const B& b) -> std::optional<BsdfSample> {
            if constexpr (Specular<B>)
                return choose_branch(b.branches(outgoing, carried), u.x);
            else
                return b.sample(outgoing, u);
        },
        bsdf);
}

float density(const Bsdf& bsdf, const Vector& outgoing, const Vector& incoming) {
    return std::visit(
        [&]<typename B>(const B& b) {
            if constexpr (Specular<B>)
                return 0.0f;
            else
                return b.density(outgoing, incoming);
        },
        bsdf);
}

const char* material_kind(const Material& material) {
    return std::visit([]<typename B>(const B&) { return B::name; }, material.bsdf);
}

bool is_specular(const Bsdf& bsdf) {
    return std::visit([]<typename B>(const B&) { return Specular<B>; }, bsdf);
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

bool is_transmissive(const Bsdf& bsdf) {
    return std::holds_alternative<Dielectric>(bsdf);
}

bool is_black(const Bsdf& bsdf) {
    const auto* diffuse = std::get_if<Diffuse>(&bsdf);
    return diffuse && is_black(diffuse->reflectance);
}

Bsdf bsdf_at(const Material& material, const Imath::V2f& texture_coordinate, bool from_back) {
    if (material.texture) return Diffuse{material.texture->color_at(texture_coordinate)};
    if (const auto* dielectric = std::get_if<Dielectric>(&material.bsdf); dielectric && from_back)
        return dielectric->turned_over();
    return material.bsdf;
}

}  // namespace photonlab
