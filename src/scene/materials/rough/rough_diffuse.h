// Rough plaster or cloth: facets that are diffuse each, which flattens the shading and brightens grazing views.

#pragma once

#include "core/sampling.h"
#include "scene/materials/bsdf.h"

namespace photonlab {

/// Oren and Nayar's qualitative and full models. [Oren & Nayar 1994, "Generalization of Lambert's Reflectance Model",
/// equations 27 to 30]
struct RoughDiffuse {
    static constexpr const char* name = "roughdiffuse";
    static constexpr bool is_transmissive = false;
    static constexpr bool is_wide = true;

    Color reflectance = Color(0.5f);  ///< of a facet, in [0, 1] a channel
    float alpha = 0.2f;               ///< roughness as Mitsuba's, at least 0: sqrt(2) times the standard deviation of
                                      ///< the angles, in radians, by which facets are tilted
    bool is_qualitative = false;      ///< without light that is reflected twice

    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, Carried, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const {
        return outgoing.z > 0.0f ? cosine_hemisphere_density(incoming.z) : 0.0f;
    }
    bool is_black() const { return photonlab::is_black(reflectance); }

    static RoughDiffuse read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;
};

}  // namespace photonlab
