// What every material's BSDF speaks in, and what it answers. Directions are unit, in the local frame of the shading
// normal (z along it), and all point away from the surface: `outgoing` to where the path came from, `incoming` to where
// it goes on. A BSDF is asked only for outgoing directions with outgoing.z > 0; whoever asks turns it over first
// (orient() in scene.h).

#pragma once

#include <array>
#include <cassert>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "core/math.h"

namespace photonlab {

struct Material;
struct Microfacets;
struct MaterialReader;

/// What a path carries. Camera paths carry radiance, which refraction compresses with the square of the index; photons
/// carry flux, which it leaves alone. [Veach 1997, section 5.2]
enum class Carried { Radiance, Flux };

/// Where a mirror in the surface reflects a direction to.
inline Vector mirror_direction(const Vector& direction) {
    return {-direction.x, -direction.y, direction.z};
}

/// A direction drawn from a BSDF.
struct BsdfSample {
    Vector incoming;       ///< unit, local frame
    Color weight;          ///< f |cos| / density: what the path's throughput is multiplied by
    float density = 0.0f;  ///< per steradian; 0 for a specular direction, which no other technique finds
};

/// One of the directions in which specular light goes on.
struct SpecularBranch {
    Vector incoming;  ///< unit, local frame
    Color weight;     ///< what the path's throughput is multiplied by
};

/// All of them: reflection, refraction or both, and those of everything that a material is made of.
struct SpecularBranches {
    static constexpr int limit = 8;

    std::array<SpecularBranch, limit> branch;
    int count = 0;

    void add(const Vector& incoming, const Color& weight) {
        assert(count < limit);
        branch[static_cast<std::size_t>(count++)] = {incoming, weight};
    }
    const SpecularBranch* begin() const { return branch.data(); }
    const SpecularBranch* end() const { return branch.data() + count; }
};

/// Refuses, by the material's id and place, what cannot be rendered. Each throws InputError.
struct MaterialCheck {
    const Material& material;

    /// What is reflected or let through is no more than what arrived: a colour in [0, 1].
    void in_unit_range(std::string_view what, const Color& color) const;
    void roughness(float alpha) const;
    void facets(const Microfacets& facets) const;
    void anisotropy(bool is_anisotropic) const;  ///< of it, or of what it is made of
    void index(float index) const;               ///< of refraction
    void require(bool holds, const std::string& expected) const;
    void part(const Material* part) const;  ///< of what it is made
    /// True when the material keeps `data`, which its BSDF looks up.
    bool keeps(const void* data) const;
};

// ---------------------------------------------------------------------------------------------------------------------
// What a kind of BSDF is asked. It has one lobe or both; whether light goes on in single directions is asked of the
// lobe.

/// A lobe of single directions, as of mirrors and glass: the camera follows each, nothing is gathered.
template <typename Kind>
concept Specular = requires(const Kind& bsdf, const Vector& outgoing) {
    { bsdf.branches(outgoing, Carried::Flux) } -> std::same_as<SpecularBranches>;
};

/// A lobe that spreads light, at which it is gathered. sample() and density() are those of everything the BSDF does:
/// where it has single directions as well, sample() draws them too, with a density of 0.
template <typename Kind>
concept Scattering = requires(const Kind& bsdf, const Vector& direction, const Imath::V2f& u) {
    { bsdf.evaluate(direction, direction) } -> std::same_as<Color>;
    { bsdf.sample(direction, Carried::Flux, u) } -> std::same_as<std::optional<BsdfSample>>;
    { bsdf.density(direction, direction) } -> std::same_as<float>;
};

/// What sample() answers of a surface that only reflects, once one of its lobes has drawn `incoming`: with the density
/// of them all. Empty below the surface, and where that density rounds to 0.
template <typename Kind>
std::optional<BsdfSample> sample_of_all_lobes(const Kind& bsdf, const Vector& outgoing, const Vector& incoming) {
    if (incoming.z <= 0.0f) return std::nullopt;
    const float density = bsdf.density(outgoing, incoming);
    if (!(density > 0.0f)) return std::nullopt;
    return BsdfSample{incoming, bsdf.evaluate(outgoing, incoming) * (incoming.z / density), density};
}

/// A scattering lobe whose f is the same for all directions above the surface. Hit points on it need not know from
/// where they are seen, which is all that leaving uniform_value() out costs.
template <typename Kind>
concept Uniform = requires(const Kind& bsdf) {
    { bsdf.uniform_value() } -> std::same_as<Color>;
};

/// A scattering lobe as wide as Lambert's, at least nearly: drawing directions to the lights finds its direct light
/// well. Kinds that do not say so may be narrow.
template <typename Kind>
concept Wide = Scattering<Kind> && requires {
    requires Kind::is_wide;
};

/// A scattering lobe that is all there is, and may be narrow: a camera path may go on from it in a drawn direction.
/// roughness() is Mitsuba's alpha.
template <typename Kind>
concept Glossy = Scattering<Kind> && requires(const Kind& bsdf) {
    { bsdf.roughness() } -> std::same_as<float>;
};

/// Light passes through, and the surface is lit from both sides: turned_over() is what is seen from behind.
template <typename Kind>
concept Transmissive = requires(const Kind& bsdf) {
    { bsdf.turned_over() } -> std::same_as<Kind>;
};

/// Materials that another is made of; null where there are fewer.
using PartMaterials = std::array<const Material*, 2>;

/// A kind that is made of other materials answers some of the above for each of them, and so by itself and not by its
/// type. at() is the kind at one point of a surface, seen from one side: only there it knows which lobes it has, and
/// how much of the light goes straight on whatever the normal. Everywhere it knows whether light passes through
/// (`transmits`), whether anything of it can be seen from behind, how many branches it has at most, the materials of
/// which something may be seen somewhere, and whether it has single directions of its own somewhere besides theirs;
/// for both of these it is told whether its own colours and numbers are `textured`.
template <typename Kind>
concept Composite = requires(const Kind& bsdf, const Imath::V2f& uv, bool textured) {
    { bsdf.at(uv, true) } -> std::same_as<Kind>;
    { bsdf.has_specular_lobe() } -> std::same_as<bool>;
    { bsdf.has_scattering_lobe() } -> std::same_as<bool>;
    { bsdf.straight_through() } -> std::same_as<Color>;
    { bsdf.transmits() } -> std::same_as<bool>;
    { bsdf.is_seen_from_behind() } -> std::same_as<bool>;
    { bsdf.most_branches() } -> std::same_as<int>;
    { bsdf.parts(textured) } -> std::same_as<PartMaterials>;
    { bsdf.adds_single_directions(textured) } -> std::same_as<bool>;
};

/// Every kind: its name in scene files, its reader, its checks (that it reflects no more than it gets among them), a
/// lobe, whether light passes through, and whether none leaves it whatever arrives. read() may be a template of its
/// reader: then a kind is one header, which does not include the reader.
template <typename Kind>
concept BsdfKind = (Specular<Kind> || Scattering<Kind>)&&(Composite<Kind> ||
                                                          Transmissive<Kind> == Kind::is_transmissive) &&
                   requires(const Kind& bsdf, MaterialReader& reader, const MaterialCheck& check) {
    { Kind::name } -> std::convertible_to<const char*>;
    { Kind::read(reader) } -> std::same_as<Kind>;
    { bsdf.check(check) } -> std::same_as<void>;
    { bsdf.is_black() } -> std::same_as<bool>;
};

template <BsdfKind... Kinds>
using BsdfOf = std::variant<Kinds...>;

}  // namespace photonlab
