// A diffuse base and a lobe above it, each with its colour: what of that is the same whatever the lobe.

#pragma once

#include "core/sampling.h"
#include "scene/materials/bsdf.h"

namespace photonlab {

/// f = rho_d / pi + rho_s l, where l is the lobe's.
struct BaseAndLobe {
    Color diffuse_reflectance = Color(0.5f);   ///< rho_d, in [0, 1] a channel
    Color specular_reflectance = Color(0.2f);  ///< rho_s; their sum at most 1 a channel

    Color evaluate(double lobe) const {
        return diffuse_reflectance * static_cast<float>(1.0 / pi) + specular_reflectance * static_cast<float>(lobe);
    }

    /// Of sampling, that goes to the lobe.
    float lobe_share() const {
        return share_beside(max_channel(specular_reflectance), max_channel(diffuse_reflectance));
    }

    /// Of both together, per steradian, where the lobe alone has `of_lobe`.
    float density(double of_lobe, const Vector& incoming) const {
        const float share = lobe_share();
        return share * static_cast<float>(of_lobe) + (1.0f - share) * cosine_hemisphere_density(incoming.z);
    }

    bool is_black() const {
        return photonlab::is_black(diffuse_reflectance) && photonlab::is_black(specular_reflectance);
    }

    void check(const MaterialCheck& check) const {
        check.in_unit_range("diffuse_reflectance", diffuse_reflectance);
        check.in_unit_range("specular_reflectance", specular_reflectance);
    }
};

}  // namespace photonlab
