#include "scene/materials/rough_plastic.h"

#include "core/sampling.h"
#include "scene/materials/dielectric.h"
#include "scene/materials/material_reader.h"
#include "scene/materials/plastic.h"

namespace photonlab {

namespace {

/// Shares of the light along `outgoing` that one facet reflects, and lets through; `eta` is index here over beyond.
struct Shares {
    double reflected = 0.0;
    double let_through = 0.0;
};

Shares shares_at(const Microfacets& facets, double cosine, double eta, int side) {
    const Vector outgoing(static_cast<float>(std::sqrt(1.0 - cosine * cosine)), 0.0f, static_cast<float>(cosine));
    Shares sum;
    for (int i = 0; i < side * side; ++i) {
        const Vector normal =
            facets.sample(outgoing, {(static_cast<float>(i % side) + 0.5f) / static_cast<float>(side),
                                     (static_cast<float>(i / side) + 0.5f) / static_cast<float>(side)});
        const double cosine_here = outgoing.dot(normal);
        if (!(cosine_here > 0.0)) continue;
        const FresnelDielectric fresnel = fresnel_dielectric(cosine_here, eta);
        const Vector back = mirrored(outgoing, normal);
        if (back.z > 0.0f) sum.reflected += fresnel.reflected * facets.weight(outgoing, back, normal);
        const Vector through =
            normal * static_cast<float>(eta * cosine_here - fresnel.cos_beyond) - outgoing * static_cast<float>(eta);
        if (through.z < 0.0f && fresnel.reflected < 1.0)
            sum.let_through += (1.0 - fresnel.reflected) * facets.weight(outgoing, through, normal);
    }
    return {sum.reflected / (side * side), sum.let_through / (side * side)};
}

/// What is not let out of the light inside, which is the integral of 2 R(c) c over the cosine c: by steps that resolve
/// the critical angle.
double inner_reflectance_of(const Microfacets& facets, double eta) {
    constexpr int steps = 256;
    double let_out = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double cosine = (i + 0.5) / steps;
        let_out += 2.0 * cosine * shares_at(facets, cosine, eta, 24).let_through / steps;
    }
    return 1.0 - let_out;
}

/// The mean of 2 R(c) c over the steps of the coat, both ends among them.
double mean_inner_reflectance_of(const Microfacets& facets, double eta) {
    double sum = 0.0;
    for (int step = 0; step < RoughCoat::steps; ++step) {
        const double cosine = std::max(1e-6, static_cast<double>(step) / (RoughCoat::steps - 1));
        sum += 2.0 * cosine * shares_at(facets, cosine, eta, 32).reflected;
    }
    return sum / RoughCoat::steps;
}

}  // namespace

float RoughCoat::let_in_at(float cosine) const {
    const float at = std::clamp(cosine, 0.0f, 1.0f) * (steps - 1);
    const int index = std::min(static_cast<int>(at), steps - 2);
    const float share = at - static_cast<float>(index);
    return let_in[static_cast<std::size_t>(index)] * (1.0f - share) +
           let_in[static_cast<std::size_t>(index) + 1] * share;
}

RoughCoat make_rough_coat(const Microfacets& facets, double eta, bool as_mean) {
    RoughCoat coat{};
    for (int step = 0; step < RoughCoat::steps; ++step) {
        const double cosine = std::max(1e-6, static_cast<double>(step) / (RoughCoat::steps - 1));
        coat.let_in[static_cast<std::size_t>(step)] =
            static_cast<float>(shares_at(facets, cosine, 1.0 / eta, 32).let_through);
    }
    coat.inner_reflectance =
        static_cast<float>(as_mean ? mean_inner_reflectance_of(facets, eta) : inner_reflectance_of(facets, eta));
    return coat;
}

Color RoughPlastic::evaluate(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return Color(0.0f);
    const double eta = static_cast<double>(index_outside) / index_inside;
    const Vector normal = (outgoing + incoming).normalized();
    const double reflected = fresnel_dielectric(outgoing.dot(normal), eta).reflected;
    const double shape = facets.reflected(outgoing, incoming, normal);
    const double let_in = static_cast<double>(coat->let_in_at(outgoing.z)) * coat->let_in_at(incoming.z);
    const Color base = reflectance_under_coat(diffuse_reflectance, coat->inner_reflectance, nonlinear);
    return specular_reflectance * static_cast<float>(reflected * shape) +
           base * static_cast<float>(let_in * eta * eta / pi);
}

float RoughPlastic::coat_share(float cosine) const {
    const float let_in = coat->let_in_at(cosine);
    const float of_coat = (1.0f - let_in) * max_channel(specular_reflectance);
    const float of_base = let_in * max_channel(diffuse_reflectance);
    return of_coat + of_base > 0.0f ? of_coat / (of_coat + of_base) : 0.0f;
}

std::optional<BsdfSample> RoughPlastic::sample(const Vector& outgoing, Carried, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    const float share = coat_share(outgoing.z);
    const ShareChoice by_coat = choose_by_share(u.x, share);
    const Imath::V2f rest(by_coat.rest, u.y);
    const Vector incoming = by_coat.is_chosen ? mirrored(outgoing, facets.sample(outgoing, rest)).normalized()
                                              : sample_cosine_hemisphere(rest);
    if (incoming.z <= 0.0f) return std::nullopt;
    const float found = density(outgoing, incoming);
    if (!(found > 0.0f)) return std::nullopt;
    return BsdfSample{incoming, evaluate(outgoing, incoming) * (incoming.z / found), found};
}

float RoughPlastic::density(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return 0.0f;
    const float share = coat_share(outgoing.z);
    const Vector normal = (outgoing + incoming).normalized();
    const double of_coat = facets.density(outgoing, normal) / (4.0 * outgoing.dot(normal));
    return share * static_cast<float>(of_coat) + (1.0f - share) * cosine_hemisphere_density(incoming.z);
}

RoughPlastic RoughPlastic::read(MaterialReader& reader) {
    RoughPlastic plastic{
        .facets = reader.facets<RoughPlastic>(nullptr),
        .index_outside = reader.index("ext_ior", "air"),
        .index_inside = reader.index("int_ior", "polypropylene"),
        .nonlinear = reader.properties.boolean("nonlinear").value_or(false),
        .diffuse_reflectance = reader.factor_or_texture("diffuse_reflectance", 0.5, &RoughPlastic::diffuse_reflectance),
        .specular_reflectance =
            reader.factor_or_texture("specular_reflectance", 1.0, &RoughPlastic::specular_reflectance)};
    if (plastic.index_outside == plastic.index_inside) return plastic;  // which is refused
    const double eta = static_cast<double>(plastic.index_inside) / plastic.index_outside;
    std::shared_ptr<const RoughCoat>& coat =
        reader.source.rough_coats[{static_cast<double>(plastic.facets.slopes), plastic.facets.alpha, eta}];
    if (!coat) coat = std::make_shared<const RoughCoat>(make_rough_coat(plastic.facets, eta, !reader.is_version_06()));
    reader.material.data = coat;
    plastic.coat = coat.get();
    return plastic;
}

void RoughPlastic::check(const MaterialCheck& check) const {
    check.in_unit_range("diffuse_reflectance", diffuse_reflectance);
    check.in_unit_range("specular_reflectance", specular_reflectance);
    check.roughness(facets.alpha);
    check.index(index_outside);
    check.index(index_inside);
    check.require(index_outside != index_inside, "two different indices");
    check.require(check.keeps(coat), "its own coat");
}

}  // namespace photonlab
