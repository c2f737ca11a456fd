// A polished metal, or a perfect mirror: light is reflected in one direction, by Fresnel's equations for a complex
// index.

#pragma once

#include <string>
#include <vector>

#include "scene/materials/bsdf.h"

namespace photonlab {

/// Reflects only. The index eta + i k is relative to the medium outside; eta = 0 with k = 1 reflects everything.
struct Conductor {
    static constexpr const char* name = "conductor";
    static constexpr bool is_transmissive = false;

    Color eta = Color(0.0f);          ///< at least 0 a channel
    Color k = Color(1.0f);            ///< at least 0 a channel
    Color reflectance = Color(1.0f);  ///< factor on Fresnel's, in [0, 1] a channel

    SpecularBranches branches(const Vector& outgoing, Carried) const;
    bool is_black() const { return false; }

    static Conductor read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;
};

/// Share of unpolarised light that a conductor of relative index eta + i k reflects; cos_theta in [0, 1].
/// [Born and Wolf, "Principles of Optics", section 14.2]
double fresnel_conductor(double cos_theta, double eta, double k);

/// Of a metal in its surroundings.
struct MetalIndex {
    Color eta;
    Color k;
};

/// What a plugin says of it: a name, eta and k, and the medium outside. Throws InputError.
MetalIndex read_metal(MaterialReader& reader);

/// Refuses what is below 0.
void require_metal(const MaterialCheck& check, const Color& eta, const Color& k);

/// A metal by its chemical symbol, or "none" for the perfect mirror, in air.
struct NamedConductor {
    std::string name;
    Color eta;
    Color k;
};
const std::vector<NamedConductor>& named_conductors();

}  // namespace photonlab
