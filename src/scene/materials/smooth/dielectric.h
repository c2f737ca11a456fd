// A smooth interface between two transparent media, glass or water and air: part of the light is reflected and the rest
// refracted, by Fresnel's equations and Snell's law.

#pragma once

#include "scene/materials/bsdf.h"

namespace photonlab {

/// An interface as seen from one of its sides; turned_over() is the same interface from the other.
struct Dielectric {
    static constexpr const char* name = "dielectric";
    static constexpr bool is_transmissive = true;

    float index_here = 1.0f;            ///< of the medium on the side of the normal, above 0
    float index_beyond = 1.5f;          ///< of the medium behind, above 0
    Color reflectance = Color(1.0f);    ///< factor on what is reflected, in [0, 1] a channel
    Color transmittance = Color(1.0f);  ///< factor on what is refracted, in [0, 1] a channel

    SpecularBranches branches(const Vector& outgoing, Carried carried) const;
    Dielectric turned_over() const { return {index_beyond, index_here, reflectance, transmittance}; }
    bool is_black() const { return false; }

    static Dielectric read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;
};

/// Reflected share of unpolarised light and the cosine on the far side, 0 at total reflection.
struct FresnelDielectric {
    double reflected;
    double cos_beyond;
};

/// cos_here in [0, 1]; eta = index_here / index_beyond.
FresnelDielectric fresnel_dielectric(double cos_here, double eta);

}  // namespace photonlab
