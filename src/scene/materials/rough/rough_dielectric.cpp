#include "scene/materials/rough/rough_dielectric.h"

#include <bit>
#include <cstdint>

#include "scene/materials/material_reader.h"
#include "scene/materials/smooth/dielectric.h"

namespace photonlab {

namespace {

/// A third number in [0, 1): the facet takes the two, and which way to go is known only then. Theirs are hashed, all
/// bits of them, so that it hangs together with neither, however few bits another choice has left of one. [Steele, Lea
/// & Flood 2014, "Fast Splittable Pseudorandom Number Generators"; its mix is Stafford's thirteenth]
double third_number(const Imath::V2f& u) {
    std::uint64_t bits = std::uint64_t{std::bit_cast<std::uint32_t>(u.x)} << 32 | std::bit_cast<std::uint32_t>(u.y);
    bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9u;
    bits = (bits ^ bits >> 27) * 0x94d049bb133111ebu;
    bits ^= bits >> 31;
    return static_cast<double>(bits >> 11) * 0x1p-53;
}

}  // namespace

/// The facet that takes one direction to the other.
struct RoughDielectric::Facet {
    Vector normal;       // above the surface
    double reflected;    // Fresnel's share
    double compression;  // normals per steradian of incoming directions: their density is that of normals times this
    bool exists;         // it sees both directions, from the sides on which they are
};

/// Refraction turns normals around -(n outgoing + n' incoming). [Walter et al. 2007, equations 13 to 17]
RoughDielectric::Facet RoughDielectric::facet_between(const Vector& outgoing, const Vector& incoming) const {
    const bool reflects = incoming.z > 0.0f;
    const double here = index_here;
    const double beyond = reflects ? index_here : index_beyond;
    VectorD sum =
        reflects ? VectorD(outgoing) + VectorD(incoming) : VectorD(outgoing) * here + VectorD(incoming) * beyond;
    if (sum.z < 0.0) sum = -sum;
    const VectorD normal = sum.normalized();
    const double cosine = normal.dot(VectorD(outgoing));
    const double cosine_beyond = normal.dot(VectorD(incoming));
    Facet facet{Vector(normal), 0.0, 0.0, cosine > 0.0 && (cosine_beyond > 0.0) == reflects};
    if (!facet.exists) return facet;
    facet.reflected = fresnel_dielectric(cosine, here / static_cast<double>(index_beyond)).reflected;
    if (reflects) {
        facet.compression = 0.25 / cosine;
    } else {
        const double both = here * cosine + beyond * cosine_beyond;
        facet.compression = beyond * beyond * std::abs(cosine_beyond) / (both * both);
    }
    return facet;
}

Color RoughDielectric::evaluate(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z == 0.0f) return Color(0.0f);
    const Facet facet = facet_between(outgoing, incoming);
    if (!facet.exists) return Color(0.0f);
    const double shape = facets.distribution(facet.normal) * facets.unhidden(outgoing, facet.normal) *
                         facets.unhidden(incoming, facet.normal) * facet.compression *
                         std::abs(static_cast<double>(outgoing.dot(facet.normal))) /
                         std::abs(static_cast<double>(outgoing.z) * incoming.z);
    if (incoming.z > 0.0f) return reflectance * static_cast<float>(shape * facet.reflected);
    const double eta = static_cast<double>(index_here) / index_beyond;
    return transmittance * static_cast<float>(shape * (1.0 - facet.reflected) * eta * eta);
}

std::optional<BsdfSample> RoughDielectric::sample(const Vector& outgoing, Carried carried, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    const Vector normal = facets.sample(outgoing, u);
    const double cosine = outgoing.dot(normal);
    if (!(cosine > 0.0)) return std::nullopt;
    const double eta = static_cast<double>(index_here) / index_beyond;
    const FresnelDielectric fresnel = fresnel_dielectric(cosine, eta);
    const bool reflects = third_number(u) < fresnel.reflected;
    const VectorD refracted = VectorD(normal) * (eta * cosine - fresnel.cos_beyond) - VectorD(outgoing) * eta;
    const Vector incoming = reflects ? mirrored(outgoing, normal).normalized() : Vector(refracted.normalized());
    if ((incoming.z > 0.0f) != reflects || incoming.z == 0.0f) return std::nullopt;
    const float found = density(outgoing, incoming);
    if (!(found > 0.0f)) return std::nullopt;
    const double radiance_factor = carried == Carried::Radiance ? eta * eta : 1.0;
    const double weight = facets.weight(outgoing, incoming, normal) * (reflects ? 1.0 : radiance_factor);
    return BsdfSample{incoming, (reflects ? reflectance : transmittance) * static_cast<float>(weight), found};
}

float RoughDielectric::density(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z == 0.0f) return 0.0f;
    const Facet facet = facet_between(outgoing, incoming);
    if (!facet.exists) return 0.0f;
    const double share = incoming.z > 0.0f ? facet.reflected : 1.0 - facet.reflected;
    return static_cast<float>(facets.density(outgoing, facet.normal) * facet.compression * share);
}

RoughDielectric RoughDielectric::read(MaterialReader& reader) {
    return {.facets = reader.facets(&RoughDielectric::facets),
            .index_here = reader.index("ext_ior", "air"),
            .index_beyond = reader.index("int_ior", "bk7"),
            .reflectance = reader.factor_or_texture("specular_reflectance", 1.0, &RoughDielectric::reflectance),
            .transmittance = reader.factor_or_texture("specular_transmittance", 1.0, &RoughDielectric::transmittance)};
}

void RoughDielectric::check(const MaterialCheck& check) const {
    check.in_unit_range("reflectance", reflectance);
    check.in_unit_range("transmittance", transmittance);
    check.facets(facets);
    check.index(index_here);
    check.index(index_beyond);
    check.require(index_here != index_beyond, "two different indices");
}

}  // namespace photonlab
