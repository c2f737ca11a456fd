// Materials: a BSDF as a variant of plain structs, and what the scene adds to it. Which kinds there are is listed in
// src/scene/CMakeLists.txt. To add one: a file with a struct that answers what BsdfKind in bsdf.h asks, its name in the
// list, and a test.

#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/math.h"
#include "scene/materials/bsdf_list.h"
#include "scene/textures/texture.h"

namespace photonlab {

/// A texture that gives one of a BSDF's colours or numbers.
struct TexturedColor {
    std::shared_ptr<const Texture> texture;
    std::function<void(Bsdf&, const Color&)> put;  ///< the colour, into its place
    bool may_be_black = true;                      ///< somewhere
};

/// `texture` gives the colour `member` of a `Kind`.
template <typename Kind>
TexturedColor textured(Color Kind::*member, std::shared_ptr<const Texture> texture) {
    const bool may_be_black = !(range_of(*texture).darkest > 0.0f);
    return {std::move(texture), [member](Bsdf& bsdf, const Color& color) { std::get<Kind>(bsdf).*member = color; },
            may_be_black};
}

/// What turns the shading normal from point to point: heights above the surface, or normals in the frame of the
/// surface's texture coordinates.
struct NormalTexture {
    std::shared_ptr<const Texture> texture;
    bool is_height = true;     ///< else its colours are normals, as 2 c - 1
    double scale = 1.0;        ///< of heights: scene units, and in a Scene those of the unit box
    bool is_mirrored = false;  ///< the normal from behind is that of the front, mirrored in the surface; else its
                               ///< opposite
};

struct Material {
    std::string id;  ///< its id in the scene file, or its plugin's name
    Bsdf bsdf;
    bool two_sided = false;                     ///< false: black from behind, unless light passes through
    std::vector<TexturedColor> textures = {};   ///< of `bsdf`
    std::shared_ptr<const void> data = {};      ///< what `bsdf` looks up, kept for it
    std::string place = {};                     ///< "file:line" for messages, or ""
    std::shared_ptr<const Material> back = {};  ///< what is seen from behind, where that is another
    std::optional<NormalTexture> normals = {};  ///< of the front
    std::optional<NormalTexture> normals_behind = {};
    bool parts_look_up_textures = false;  ///< those that it is made of
    bool is_anisotropic = false;  ///< it, its back or a part of it has a roughness that depends on the direction: its
                                  ///< frame then has its tangent along u
};

/// Throws InputError for what cannot be rendered.
void require_valid(const Material& material);

/// std::visit among all kinds, as a call of its own so that what calls it stays small.
template <typename Visitor>
[[gnu::noinline]] auto visit_any_bsdf(const Visitor& visitor, const Bsdf& bsdf) {
    return std::visit(visitor, bsdf);
}

/// std::visit, with Lambert's law first: of as many kinds as these the standard library makes a table of functions,
/// none of which is inlined, and most surfaces are diffuse.
template <typename Visitor>
[[gnu::always_inline]] inline auto visit_bsdf(const Visitor& visitor, const Bsdf& bsdf) {
    if (const auto* diffuse = std::get_if<Diffuse>(&bsdf)) return visitor(*diffuse);
    return visit_any_bsdf(visitor, bsdf);
}

/// f(outgoing, incoming) without the cosine, 1/sr; 0 where a direction is on a side from which nothing comes, and for
/// single directions.
inline Color evaluate(const Bsdf& bsdf, const Vector& outgoing, const Vector& incoming) {
    return visit_bsdf(
        [&]<typename B>(const B& b) {
            if constexpr (Scattering<B>)
                return b.evaluate(outgoing, incoming);
            else
                return Color(0.0f);
        },
        bsdf);
}

/// Draws a branch with the probability of its share of the strongest channel.
std::optional<BsdfSample> choose_branch(const SpecularBranches& branches, float u);

/// A direction by (nearly) the BSDF times the cosine; empty when the path is absorbed. Of a BSDF that only goes on in
/// single directions, one of these.
inline std::optional<BsdfSample> sample(const Bsdf& bsdf, const Vector& outgoing, Carried carried,
                                        const Imath::V2f& u) {
    return visit_bsdf(
        [&]<typename B>(const B& b) -> std::optional<BsdfSample> {
            if constexpr (Scattering<B>)
                return b.sample(outgoing, carried, u);
            else
                return choose_branch(b.branches(outgoing, carried), u.x);
        },
        bsdf);
}

/// Density per steradian with which sample() draws `incoming`; 0 for single directions.
inline float density(const Bsdf& bsdf, const Vector& outgoing, const Vector& incoming) {
    return visit_bsdf(
        [&]<typename B>(const B& b) {
            if constexpr (Scattering<B>)
                return b.density(outgoing, incoming);
            else
                return 0.0f;
        },
        bsdf);
}

/// The kind of BSDF, as scene files call it.
const char* material_kind(const Material& material);

/// True when light goes on in single directions, as by mirrors and glass.
inline bool is_specular(const Bsdf& bsdf) {
    return visit_bsdf(
        []<typename B>(const B& b) {
            if constexpr (Composite<B>)
                return b.has_specular_lobe();
            else
                return Specular<B>;
        },
        bsdf);
}

/// True when light is spread: it is gathered there, and photons are stored.
inline bool is_scattering(const Bsdf& bsdf) {
    return visit_bsdf(
        []<typename B>(const B& b) {
            if constexpr (Composite<B>)
                return b.has_scattering_lobe();
            else
                return Scattering<B>;
        },
        bsdf);
}

/// True where the light that is spread may be spread little.
inline bool may_be_narrow(const Bsdf& bsdf) {
    return visit_bsdf([]<typename B>(const B&) { return Scattering<B> && !Wide<B>; }, bsdf);
}

/// f, where it is the same for all directions above the surface.
inline std::optional<Color> uniform_value(const Bsdf& bsdf) {
    return visit_bsdf(
        []<typename B>(const B& b) -> std::optional<Color> {
            if constexpr (Uniform<B>)
                return b.uniform_value();
            else
                return std::nullopt;
        },
        bsdf);
}

/// Of a surface that is glossy and nothing else.
inline std::optional<float> roughness(const Bsdf& bsdf) {
    return visit_bsdf(
        []<typename B>(const B& b) -> std::optional<float> {
            if constexpr (Glossy<B>)
                return b.roughness();
            else
                return std::nullopt;
        },
        bsdf);
}

/// Where specular light goes on; none for other BSDFs.
SpecularBranches specular_branches(const Bsdf& bsdf, const Vector& outgoing, Carried carried);

/// The largest number of them.
int most_branches(const Bsdf& bsdf);

/// True when light passes through: the surface is then lit from both sides.
inline bool is_transmissive(const Bsdf& bsdf) {
    return visit_bsdf(
        []<typename B>(const B& b) {
            if constexpr (Composite<B>)
                return b.transmits();
            else
                return B::is_transmissive;
        },
        bsdf);
}

/// What light that goes straight on, as through a hole, is multiplied by: whatever the normal.
inline Color straight_through(const Bsdf& bsdf) {
    return visit_bsdf(
        []<typename B>(const B& b) {
            if constexpr (Composite<B>)
                return b.straight_through();
            else
                return Color(0.0f);
        },
        bsdf);
}

/// True when no light leaves the surface whatever arrives: nothing is gathered there and no photon stored.
inline bool is_black(const Bsdf& bsdf) {
    return visit_bsdf([](const auto& b) { return b.is_black(); }, bsdf);
}

/// Puts the BSDF at one point, seen from one side, into `there`: textures looked up, an interface turned over when seen
/// from its back, and the material that is there. In place, since to copy a variant is to ask which kind it is.
inline void put_bsdf_at(Bsdf& there, const Material& material, const Imath::V2f& texture_coordinate, bool from_back) {
    const bool has_back = from_back && material.back;
    const Material& seen = has_back ? *material.back : material;
    const bool from_behind = from_back && !has_back;
    const auto put = [&]<typename B>(const B& b) {
        if constexpr (Composite<B>)
            there = b.at(texture_coordinate, from_behind && !seen.two_sided);
        else if constexpr (Transmissive<B>)
            there = from_behind ? b.turned_over() : b;
        else
            there.emplace<B>(b);
    };
    if (seen.textures.empty()) return visit_bsdf(put, seen.bsdf);
    Bsdf looked_up = seen.bsdf;
    for (const TexturedColor& color : seen.textures) color.put(looked_up, color_at(*color.texture, texture_coordinate));
    visit_bsdf(put, looked_up);
}

inline Bsdf bsdf_at(const Material& material, const Imath::V2f& texture_coordinate, bool from_back) {
    Bsdf bsdf;
    put_bsdf_at(bsdf, material, texture_coordinate, from_back);
    return bsdf;
}

/// bsdf_at() of what another material is made of: black from behind where it is black there.
Bsdf part_at(const Material& part, const Imath::V2f& texture_coordinate, bool from_back);

// What a material may do somewhere on a surface, seen from either side. It is asked without a place, and true where
// that depends on a texture.

bool needs_texture_coordinates(const Material& material);
void remember_part(Material& whole, const Material& part);  ///< what the whole must know of it
bool is_seen_from_behind(const Material& material);         ///< else it is black from there
bool may_be_specular(const Material& material);
bool may_scatter(const Material& material);
bool may_be_black_by_texture(const Material& material);            ///< it, or a part of it
bool may_look_different_from_elsewhere(const Material& material);  ///< its f, where it scatters

/// True where `asked` is of anything that a composite kind may show.
template <Composite Kind>
bool is_true_of_a_part(const Kind& kind, const Material& material, bool (*asked)(const Material&)) {
    for (const Material* part : kind.parts(!material.textures.empty()))
        if (part && asked(*part)) return true;
    return false;
}

/// True when light that arrives on the other side may be spread to this one, as by rough glass.
inline bool may_scatter_through(const Material& material) {
    return visit_bsdf(
        [&]<typename B>(const B& b) {
            if constexpr (Composite<B>)
                return is_true_of_a_part(b, material, may_scatter_through);
            else
                return Scattering<B> && B::is_transmissive;
        },
        material.bsdf);
}

/// Whether a texture turns its normals.
inline bool has_turned_normals(const Material& material) {
    return material.normals || material.normals_behind;
}

}  // namespace photonlab
