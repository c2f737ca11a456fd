// A diffuse base under a smooth transparent coat: the coat reflects like glass, and what it lets in is scattered below,
// some of it several times between the base and the coat's inner side.

#pragma once

#include "scene/materials/bsdf.h"

namespace photonlab {

/// The coat reflects F of what arrives; the base scatters T(o) T(i) / n^2 of rho / (1 - rho' R), with T = 1 - F, R the
/// share of diffuse light that the coat throws back, and rho' the base's own rho where `nonlinear`, else 1.
struct Plastic {
    static constexpr const char* name = "plastic";
    static constexpr bool is_transmissive = false;
    static constexpr bool is_wide = true;

    float index_outside = 1.0f;                ///< above 0
    float index_inside = 1.49f;                ///< of the coat, above 0
    float inner_reflectance = 0.0f;            ///< R, of inner_reflectance_of()
    bool nonlinear = false;                    ///< light that returns to the base is coloured by it again
    Color diffuse_reflectance = Color(0.5f);   ///< rho, in [0, 1] a channel
    Color specular_reflectance = Color(1.0f);  ///< factor on what the coat reflects, in [0, 1] a channel

    SpecularBranches branches(const Vector& outgoing, Carried) const;
    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, Carried, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const;
    bool is_black() const { return false; }

    static Plastic read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;

private:
    float coat_share(float cosine) const;  // of sampling, that goes to the coat
};

/// What leaves a base of reflectance `rho` for light that the coat lets in once, before it lets it out.
Color reflectance_under_coat(Color rho, float inner_reflectance, bool nonlinear);

/// The share of diffuse light inside a medium of relative index `eta` (its own over the one outside) that its smooth
/// boundary throws back: 2 times the integral of F(c) c over the cosine c. Exact, as in Mitsuba 0.6.
double inner_reflectance_of(double eta);

/// The same by the fits that Mitsuba 3 has for it: within 0.6% for eta up to 2. [Egan & Hilgeman 1973 for media denser
/// than what is outside; d'Eon & Irving 2011 for the others]
double fitted_inner_reflectance_of(double eta);

}  // namespace photonlab
