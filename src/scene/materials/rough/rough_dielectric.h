// Frosted glass: facets that are smooth interfaces between two media each.

#pragma once

#include "scene/materials/bsdf.h"
#include "scene/materials/rough/microfacet.h"

namespace photonlab {

/// An interface as seen from one of its sides; turned_over() is the same from the other. evaluate() is for radiance,
/// which refraction compresses with the square of the index. [Walter et al. 2007, equations 20 and 21]
struct RoughDielectric {
    static constexpr const char* name = "roughdielectric";
    static constexpr bool is_transmissive = true;

    Microfacets facets;
    float index_here = 1.0f;            ///< of the medium on the side of the normal, above 0
    float index_beyond = 1.5f;          ///< of the medium behind, above 0, not the same
    Color reflectance = Color(1.0f);    ///< factor on what is reflected, in [0, 1] a channel
    Color transmittance = Color(1.0f);  ///< factor on what is refracted, in [0, 1] a channel

    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, Carried carried, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const;
    RoughDielectric turned_over() const { return {facets, index_beyond, index_here, reflectance, transmittance}; }
    float roughness() const { return facets.mean_alpha(); }
    bool is_black() const { return false; }

    static RoughDielectric read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;

private:
    struct Facet;
    Facet facet_between(const Vector& outgoing, const Vector& incoming) const;
};

}  // namespace photonlab
