// Phong's lobe around the mirror direction over a diffuse base, in the form that is reciprocal and can conserve energy.

#pragma once

#include "scene/materials/lobes/base_and_lobe.h"

namespace photonlab {

/// f = rho_d / pi + rho_s (n + 2) / (2 pi) max(0, cos a)^n, a the angle to the mirror direction. [Lafortune & Willems
/// 1994, "Using the Modified Phong Reflectance Model for Physically Based Rendering"]
struct Phong {
    static constexpr const char* name = "phong";
    static constexpr bool is_transmissive = false;

    float exponent = 30.0f;  ///< n, at least 0
    BaseAndLobe colors = {};

    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, Carried, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const;
    bool is_black() const { return colors.is_black(); }

    static Phong read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;
};

}  // namespace photonlab
