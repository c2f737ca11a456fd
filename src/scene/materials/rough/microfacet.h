// Rough surfaces as many small facets: how their normals are distributed, how they hide each other, and drawing one of
// those that are seen.
//
// Directions and normals are unit, in the local frame (z along the shading normal). Facets hide each other without
// regard to where they are (Smith), which gives the share that is seen in closed form. Heights of neighbouring facets
// are taken as independent on the way in and out: G(a, b) = G1(a) G1(b), as Mitsuba has it.
//
// [Walter, Marschner, Li & Torrance 2007, "Microfacet Models for Refraction through Rough Surfaces"; Heitz 2014,
// "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs"]

#pragma once

#include <cmath>

#include "core/math.h"

namespace photonlab {

/// How slopes are distributed. Beckmann: normally. Ggx: with long tails. Phong: a power of the cosine.
enum class FacetSlopes { Beckmann, Ggx, Phong };

/// Roughness is that along the two axes of the frame, at least smallest_roughness; in between slopes are as on a
/// surface of one roughness that is stretched (of Phong's facets the exponent is interpolated instead).
/// [Heitz 2014, section 5.3; Ashikhmin & Shirley 2000, "An Anisotropic Phong BRDF Model"]
struct Microfacets {
    FacetSlopes slopes = FacetSlopes::Beckmann;
    float alpha_u = 0.1f;     ///< Beckmann: root mean square slope along the tangent, times sqrt(2)
    float alpha_v = alpha_u;  ///< along the bitangent

    bool is_anisotropic() const { return alpha_u != alpha_v; }

    /// One number for both: lobes of the same solid angle.
    float mean_alpha() const { return is_anisotropic() ? std::sqrt(alpha_u * alpha_v) : alpha_u; }

    /// D: area of the facets with this normal, per steradian and area of the surface; 0 below it. D(n) cos integrates
    /// to 1.
    double distribution(const Vector& normal) const;

    /// G1: the share of facets with `normal` seen from `direction` that no other hides.
    double unhidden(const Vector& direction, const Vector& normal) const;

    /// D G / (4 cos cos), 1/sr, for directions above the surface and the `normal` half way between: f of facets that
    /// reflect everything. [Walter et al. 2007, equation 20]
    double reflected(const Vector& outgoing, const Vector& incoming, const Vector& normal) const;

    /// Per steradian, with which sample() draws a normal for `direction`, which is above the surface.
    double density(const Vector& direction, const Vector& normal) const;

    /// A facet's normal: of Beckmann and Ggx by the area that is seen from `direction`, density G1 D |d.m| / |cos d|;
    /// of Phong by D cos.
    Vector sample(const Vector& direction, const Imath::V2f& u) const;

    /// What a facet drawn for `outgoing` brings to a path that goes on along `incoming`, without the reflectance:
    /// D G |outgoing.m| / (|cos outgoing| density) = G1(incoming), but for Phong.
    double weight(const Vector& outgoing, const Vector& incoming, const Vector& normal) const;
};

inline constexpr float smallest_roughness = 1e-4f;  ///< as in Mitsuba, which raises what is below

/// `direction` mirrored at a facet.
inline Vector mirrored(const Vector& direction, const Vector& normal) {
    return normal * (2.0f * direction.dot(normal)) - direction;
}

}  // namespace photonlab
