// Materials: a BSDF as a variant of plain structs, and what the scene adds to it. Directions: materials/bsdf.h.
//
// To add a material: a file in materials/ with a struct that has a name and either evaluate(), sample() and density(),
// or, when it is specular, branches(); a line in the variant here; a line in the list of material_reader.cpp; a test.

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>

#include "core/math.h"
#include "scene/materials/conductor.h"
#include "scene/materials/dielectric.h"
#include "scene/materials/diffuse.h"
#include "scene/materials/merl.h"
#include "scene/texture.h"

namespace photonlab {

using Bsdf = std::variant<Diffuse, Conductor, Dielectric, Merl>;

struct Material {
    std::string id;  ///< its id in the scene file, or its plugin's name
    Bsdf bsdf;
    bool two_sided = false;                       ///< false: black from behind, unless light passes through
    std::shared_ptr<const Texture> texture = {};  ///< takes the place of a Diffuse's reflectance
    std::shared_ptr<const MerlTable> table = {};  ///< what a Merl looks up
    std::string place = {};                       ///< "file:line" for messages, or ""
};

/// Mirrors and glass: light goes on in single directions.
template <typename B>
concept Specular = requires(const B& bsdf, const Vector& outgoing) {
    bsdf.branches(outgoing, Carried::Flux);
};

/// f(outgoing, incoming) without the cosine, 1/sr; 0 where either direction is below the surface, and for specular
/// ones.
inline Color evaluate(const Bsdf& bsdf, const Vector& outgoing, const Vector& incoming) {
    return std::visit(
        [&]<typename B>(const B& b) {
            if constexpr (Specular<B>)
                return Color(0.0f);
            else
                return b.evaluate(outgoing, incoming);
        },
        bsdf);
}

/// Draws a branch with the probability of its share of the strongest channel.
std::optional<BsdfSample> choose_branch(const SpecularBranches& branches, float u);

/// A direction by (nearly) the BSDF times the cosine; empty when the path is absorbed. A specular BSDF draws one of its
/// branches.
inline std::optional<BsdfSample> sample(const Bsdf& bsdf, const Vector& outgoing, Carried carried,
                                        const Imath::V2f& u) {
    return std::visit(
        [&]<typename B>(const B& b) -> std::optional<BsdfSample> {
            if constexpr (Specular<B>)
                return choose_branch(b.branches(outgoing, carried), u.x);
            else
                return b.sample(outgoing, u);
        },
        bsdf);
}

/// Density per steradian with which sample() draws `incoming`; 0 for specular BSDFs.
inline float density(const Bsdf& bsdf, const Vector& outgoing, const Vector& incoming) {
    return std::visit(
        [&]<typename B>(const B& b) {
            if constexpr (Specular<B>)
                return 0.0f;
            else
                return b.density(outgoing, incoming);
        },
        bsdf);
}

/// The kind of BSDF, as scene files call it.
const char* material_kind(const Material& material);

/// True for mirrors and glass: light goes on in single directions, nothing is gathered there and no photon stored.
inline bool is_specular(const Bsdf& bsdf) {
    return std::visit([]<typename B>(const B&) { return Specular<B>; }, bsdf);
}

/// Where specular light goes on; none for other BSDFs.
SpecularBranches specular_branches(const Bsdf& bsdf, const Vector& outgoing, Carried carried);

/// True when light passes through: the surface is then lit from both sides.
inline bool is_transmissive(const Bsdf& bsdf) {
    return std::holds_alternative<Dielectric>(bsdf);
}

/// True when no light leaves the surface whatever arrives: nothing is gathered there and no photon stored.
inline bool is_black(const Bsdf& bsdf) {
    const auto* diffuse = std::get_if<Diffuse>(&bsdf);
    return diffuse && is_black(diffuse->reflectance);
}

/// The BSDF at one point, seen from one side: textures looked up, an interface turned over when seen from its back.
inline Bsdf bsdf_at(const Material& material, const Imath::V2f& texture_coordinate, bool from_back) {
    if (material.texture) return Diffuse{material.texture->color_at(texture_coordinate)};
    if (from_back)
        if (const auto* dielectric = std::get_if<Dielectric>(&material.bsdf)) return dielectric->turned_over();
    return material.bsdf;
}

}  // namespace photonlab
