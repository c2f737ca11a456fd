// Materials: a BSDF as a variant of plain structs, each with evaluate, sample and density.
//
// Directions are unit, in the local frame of the shading normal (z along it), and both point away from the surface:
// `outgoing` to where the path came from, `incoming` to where it goes on. A material is asked only for outgoing
// directions with outgoing.z > 0; a two-sided one is turned over by its caller (orient() in scene.h).
//
// To add a material: a struct with these three functions in a file of its own, a line in the variant, a test.

#pragma once

#include <optional>
#include <string>
#include <variant>

#include "core/math.h"

namespace photonlab {

/// A direction drawn from a BSDF.
struct BsdfSample {
    Vector incoming;       ///< unit, local frame
    Color weight;          ///< f |cos| / density: what the path's throughput is multiplied by
    float density = 0.0f;  ///< per steradian; 0 for a specular direction, which no other technique finds
};

/// Lambert's: f = reflectance / pi above the surface, nothing below.
struct Diffuse {
    Color reflectance = Color(0.5f);  ///< in [0, 1] a channel

    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const;
};

using Bsdf = std::variant<Diffuse>;

struct Material {
    std::string id;  ///< its id in the scene file, or its plugin's name
    Bsdf bsdf;
    bool two_sided = false;  ///< false: black from behind, as Mitsuba's materials are
};

/// f(outgoing, incoming) without the cosine, 1/sr; 0 where either direction is below the surface.
Color evaluate(const Material& material, const Vector& outgoing, const Vector& incoming);

/// A direction by (nearly) the BSDF times the cosine; empty when the path is absorbed.
std::optional<BsdfSample> sample(const Material& material, const Vector& outgoing, const Imath::V2f& u);

/// Density per steradian with which sample() draws `incoming`.
float density(const Material& material, const Vector& outgoing, const Vector& incoming);

/// True when no light leaves the surface whatever arrives: nothing is gathered there and no photon stored.
bool is_black(const Material& material);

}  // namespace photonlab
