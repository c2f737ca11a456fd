// A rough metal: facets that are polished metal each.

#pragma once

#include "scene/materials/bsdf.h"
#include "scene/materials/rough/microfacet.h"

namespace photonlab {

/// f = F D G / (4 cos cos), with Fresnel's F of the index eta + i k, relative to the medium outside.
/// [Walter et al. 2007, equation 20]
struct RoughConductor {
    static constexpr const char* name = "roughconductor";
    static constexpr bool is_transmissive = false;

    Microfacets facets;
    Color eta = Color(0.0f);          ///< at least 0 a channel
    Color k = Color(1.0f);            ///< at least 0 a channel
    Color reflectance = Color(1.0f);  ///< factor on Fresnel's, in [0, 1] a channel

    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, Carried, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const;
    float roughness() const { return facets.mean_alpha(); }
    bool is_black() const { return false; }

    static RoughConductor read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;
};

}  // namespace photonlab
