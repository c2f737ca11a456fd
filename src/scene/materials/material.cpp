#include "scene/materials/material.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

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

bool MaterialCheck::keeps(const void* data) const {
    return data && data == material.data.get();
}

void require_valid(const Material& material) {
    std::visit([&](const auto& bsdf) { bsdf.check(MaterialCheck{material}); }, material.bsdf);
}

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
