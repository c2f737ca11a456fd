// Phong's lobe around the mirror direction over a diffuse base, in the form that is reciprocal and can conserve energy.

#pragma once

#include "scene/materials/bsdf.h"

namespace photonlab {

/// f = rho_d / pi + rho_s (n + 2) / (2 pi) max(0, cos a)^n, a the angle to the mirror direction. [Lafortune & Willems
/// 1994, "Using the Modified Phong Reflectance Model for Physically Based Rendering"]
struct Phong {
    static constexpr const char* name = "phong";
    static constexpr bool is_transmissive = false;

    float exponent = 30.0f;                    ///< n, at least 0
    Color diffuse_reflectance = Color(0.5f);   ///< in [0, 1] a channel
    Color specular_reflectance = Color(0.2f);  ///< their sum at most 1 a channel

    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, Carried, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const;
    bool is_black() const {
        return photonlab::is_black(diffuse_reflectance) && photonlab::is_black(specular_reflectance);
    }

    static Phong read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;

private:
    float lobe_share() const;  // of sampling, that goes to the lobe
};

}  // namespace photonlab
