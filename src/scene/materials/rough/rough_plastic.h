// A diffuse base under a rough transparent coat: plastic.h with facets for its coat.

#pragma once

#include <array>
#include <memory>
#include <vector>

#include "scene/materials/bsdf.h"
#include "scene/materials/rough/microfacet.h"

namespace photonlab {

/// What a rough interface lets through.
struct RoughCoat {
    static constexpr int steps = 64;  ///< as in Mitsuba 3

    std::array<float, steps> let_in;  ///< share of the light from outside, at equal steps of the cosine from 0 to 1
    float inner_reflectance;          ///< share of diffuse light from inside that comes back

    float let_in_at(float cosine) const;  ///< linear in between
};

/// Coats of one to many roughnesses, where a texture says which.
struct RoughCoats {
    float least_alpha = 0.0f;
    float most_alpha = 0.0f;       ///< the same, where there is one coat
    std::vector<RoughCoat> coats;  ///< from the least to the most, closer where it is smoother

    float alpha_of(std::size_t coat) const;

    // Linear in between.
    float let_in_at(float alpha, float cosine) const;
    float inner_reflectance_at(float alpha) const;

private:
    struct Between;
    Between between(float alpha) const;
};

/// Of light that is scattered by one facet; `eta` is the index inside over the one outside, not 1. With `as_mean` the
/// inner reflectance is the mean over the steps that Mitsuba 3 takes, which is 1 to 2% below the integral for it.
RoughCoat make_rough_coat(const Microfacets& facets, double eta, bool as_mean);

/// The same for facets of every alpha from the least to the most. What is let in is within 0.004 of that of each alpha,
/// and within 0.012 at cosines below 0.1.
RoughCoats make_rough_coats(FacetSlopes slopes, const Imath::V2f& alphas, double eta, bool as_mean);

/// f = F D G / (4 cos cos) + T(o) T(i) / n^2 rho / (pi (1 - rho' R)), as of Plastic, with T and R of the rough coat.
struct RoughPlastic {
    static constexpr const char* name = "roughplastic";
    static constexpr bool is_transmissive = false;

    Microfacets facets;
    float index_outside = 1.0f;                ///< above 0
    float index_inside = 1.49f;                ///< above 0, not the same
    Color diffuse_reflectance = Color(0.5f);   ///< in [0, 1] a channel
    const RoughCoats* coats = nullptr;         ///< kept by the material
    bool nonlinear = false;                    ///< light that returns to the base is coloured by it again
    Color specular_reflectance = Color(1.0f);  ///< factor on what the coat reflects, in [0, 1] a channel

    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, Carried, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const;
    bool is_black() const { return false; }

    static RoughPlastic read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;

private:
    float let_in_at(float cosine) const { return coats->let_in_at(facets.alpha_u, cosine); }
    float coat_share(float cosine) const;  // of sampling, that goes to the coat
};

}  // namespace photonlab
