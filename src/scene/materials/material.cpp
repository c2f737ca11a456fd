#include "scene/materials/material.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "scene/materials/rough/microfacet.h"

namespace photonlab {

namespace {

/// A material that a program describes without a file has no place.
[[noreturn]] void fail(const Material& material, const std::string& message) {
    const std::string sentence = fmt::format("material \"{}\": {}", material.id, message);
    if (material.place.empty()) throw InputError(sentence);
    throw InputError(material.place, sentence);
}

}  // namespace

void MaterialCheck::in_unit_range(std::string_view what, const Color& color) const {
    if (!is_finite(color) || std::min({color.x, color.y, color.z}) < 0.0f || max_channel(color) > 1.0f)
        fail(material, fmt::format("{}: expected values in [0, 1], got {} {} {}", what, color.x, color.y, color.z));
}

void MaterialCheck::require(bool holds, const std::string& expected) const {
    if (!holds) fail(material, "expected " + expected);
}

void MaterialCheck::roughness(float alpha) const {
    require(std::isfinite(alpha) && alpha >= smallest_roughness, fmt::format("a roughness above 0, got {}", alpha));
}

void MaterialCheck::facets(const Microfacets& facets) const {
    roughness(facets.alpha_u);
    roughness(facets.alpha_v);
    anisotropy(facets.is_anisotropic());
}

void MaterialCheck::anisotropy(bool is_anisotropic) const {
    require(!is_anisotropic || material.is_anisotropic, "the same roughness in all directions, or is_anisotropic");
}

void MaterialCheck::index(float index) const {
    require(std::isfinite(index) && index > 0.0f, fmt::format("an index above 0, got {}", index));
}

void MaterialCheck::part(const Material* part) const {
    require(part != nullptr, "a nested material");
    require_valid(*part);
    anisotropy(part->is_anisotropic);
    // What a mask lets through goes straight on in any frame: it takes over what turns the normals of its part.
    require(!has_turned_normals(*part) || std::holds_alternative<Mask>(material.bsdf),
            "nested materials whose normals are not turned by a texture");
}

bool MaterialCheck::keeps(const void* data) const {
    return data && data == material.data.get();
}

void require_valid(const Material& material) {
    std::visit([&](const auto& bsdf) { bsdf.check(MaterialCheck{material}); }, material.bsdf);
    if (most_branches(material.bsdf) > SpecularBranches::limit)
        fail(material, fmt::format("expected at most {} single directions in which light goes on, got {}",
                                   SpecularBranches::limit, most_branches(material.bsdf)));
    if (!material.back) return;
    require_valid(*material.back);
    MaterialCheck{material}.anisotropy(material.back->is_anisotropic);
}

std::optional<BsdfSample> choose_branch(const SpecularBranches& branches, float u) {
    float total = 0.0f;
    for (const SpecularBranch& branch : branches) total += max_channel(branch.weight);
    if (!(total > 0.0f)) return std::nullopt;
    float before = 0.0f;
    const SpecularBranch* chosen = nullptr;
    for (const SpecularBranch& branch : branches) {
        const float strength = max_channel(branch.weight);
        if (!(strength > 0.0f)) continue;
        chosen = &branch;
        before += strength;
        if (u * total < before) break;
    }
    return BsdfSample{chosen->incoming, chosen->weight * (total / max_channel(chosen->weight)), 0.0f};
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

int most_branches(const Bsdf& bsdf) {
    return std::visit(
        []<typename B>(const B& b) {
            if constexpr (Composite<B>)
                return b.most_branches();
            else
                return !Specular<B> ? 0 : B::is_transmissive ? 2 : 1;
        },
        bsdf);
}

Bsdf part_at(const Material& part, const Imath::V2f& texture_coordinate, bool from_back) {
    if (from_back && !is_seen_from_behind(part)) return Diffuse{Color(0.0f)};
    return bsdf_at(part, texture_coordinate, from_back);
}

bool needs_texture_coordinates(const Material& material) {
    return !material.textures.empty() || material.parts_look_up_textures || has_turned_normals(material) ||
           (material.back && needs_texture_coordinates(*material.back));
}

void remember_part(Material& whole, const Material& part) {
    whole.parts_look_up_textures = whole.parts_look_up_textures || needs_texture_coordinates(part);
    whole.is_anisotropic = whole.is_anisotropic || part.is_anisotropic;
}

bool is_seen_from_behind(const Material& material) {
    if (material.two_sided || is_transmissive(material.bsdf)) return true;
    return std::visit(
        []<typename B>(const B& b) {
            if constexpr (Composite<B>)
                return b.is_seen_from_behind();
            else
                return false;
        },
        material.bsdf);
}

bool may_be_specular(const Material& material) {
    const bool in_front = std::visit(
        [&]<typename B>(const B& b) {
            if constexpr (Composite<B>)
                return b.adds_single_directions(!material.textures.empty()) ||
                       is_true_of_a_part(b, material, may_be_specular);
            else
                return Specular<B>;
        },
        material.bsdf);
    return in_front || (material.back && may_be_specular(*material.back));
}

bool may_scatter(const Material& material) {
    const bool in_front = std::visit(
        [&]<typename B>(const B& b) {
            if constexpr (Composite<B>)
                return is_true_of_a_part(b, material, may_scatter);
            else
                return Scattering<B> && !(material.textures.empty() && b.is_black());
        },
        material.bsdf);
    return in_front || (material.back && may_scatter(*material.back));
}

bool may_be_black_by_texture(const Material& material) {
    return material.parts_look_up_textures || (material.back && may_be_black_by_texture(*material.back)) ||
           std::any_of(material.textures.begin(), material.textures.end(),
                       [](const TexturedColor& color) { return color.may_be_black; });
}

bool may_look_different_from_elsewhere(const Material& material) {
    const bool in_front = std::visit(
        [&]<typename B>(const B& b) {
            if constexpr (Composite<B>)
                return is_true_of_a_part(b, material, may_scatter);
            else
                return Scattering<B> && !Uniform<B>;
        },
        material.bsdf);
    return in_front || (material.back && may_look_different_from_elsewhere(*material.back));
}

}  // namespace photonlab
