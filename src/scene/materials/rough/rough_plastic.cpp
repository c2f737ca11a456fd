#include "scene/materials/rough/rough_plastic.h"

#include <cmath>

#include "core/error.h"
#include "core/sampling.h"
#include "scene/materials/material_reader.h"
#include "scene/materials/smooth/dielectric.h"
#include "scene/materials/smooth/plastic.h"

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

/// The two coats around a roughness, and the share of the second.
struct RoughCoats::Between {
    const RoughCoat& first;
    const RoughCoat& second;
    float share;
};

float RoughCoats::alpha_of(std::size_t coat) const {
    if (coats.size() == 1) return least_alpha;
    const float share = static_cast<float>(coat) / static_cast<float>(coats.size() - 1);
    return least_alpha + (most_alpha - least_alpha) * share * share;
}

RoughCoats::Between RoughCoats::between(float alpha) const {
    if (coats.size() == 1) return {coats[0], coats[0], 0.0f};
    const float share = std::clamp((alpha - least_alpha) / (most_alpha - least_alpha), 0.0f, 1.0f);
    const float at = std::sqrt(share) * static_cast<float>(coats.size() - 1);
    const std::size_t index = std::min(static_cast<std::size_t>(at), coats.size() - 2);
    const float from = alpha_of(index);
    const float to = alpha_of(index + 1);
    return {coats[index], coats[index + 1], std::clamp((alpha - from) / (to - from), 0.0f, 1.0f)};
}

float RoughCoats::let_in_at(float alpha, float cosine) const {
    const Between coat = between(alpha);
    if (coat.share == 0.0f) return coat.first.let_in_at(cosine);
    return coat.first.let_in_at(cosine) * (1.0f - coat.share) + coat.second.let_in_at(cosine) * coat.share;
}

float RoughCoats::inner_reflectance_at(float alpha) const {
    const Between coat = between(alpha);
    return coat.first.inner_reflectance * (1.0f - coat.share) + coat.second.inner_reflectance * coat.share;
}

RoughCoats make_rough_coats(FacetSlopes slopes, const Imath::V2f& alphas, double eta, bool as_mean) {
    const auto steps = static_cast<std::size_t>(std::ceil(16.0f * std::sqrt(alphas.y - alphas.x)));
    RoughCoats made{.least_alpha = alphas.x, .most_alpha = alphas.y, .coats = std::vector<RoughCoat>(steps + 1)};
    for (std::size_t i = 0; i < made.coats.size(); ++i)
        made.coats[i] = make_rough_coat({slopes, made.alpha_of(i)}, eta, as_mean);
    return made;
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
    const double let_in = static_cast<double>(let_in_at(outgoing.z)) * let_in_at(incoming.z);
    const Color base =
        reflectance_under_coat(diffuse_reflectance, coats->inner_reflectance_at(facets.alpha_u), nonlinear);
    return specular_reflectance * static_cast<float>(reflected * shape) +
           base * static_cast<float>(let_in * eta * eta / pi);
}

float RoughPlastic::coat_share(float cosine) const {
    const float let_in = let_in_at(cosine);
    const float of_coat = (1.0f - let_in) * max_channel(specular_reflectance);
    const float of_base = let_in * max_channel(diffuse_reflectance);
    return share_beside(of_coat, of_base);
}

std::optional<BsdfSample> RoughPlastic::sample(const Vector& outgoing, Carried, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    const float share = coat_share(outgoing.z);
    const ShareChoice by_coat = choose_by_share(u.x, share);
    const Imath::V2f rest(by_coat.rest, u.y);
    const Vector incoming = by_coat.is_chosen ? mirrored(outgoing, facets.sample(outgoing, rest)).normalized()
                                              : sample_cosine_hemisphere(rest);
    return sample_of_all_lobes(*this, outgoing, incoming);
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
        .facets = reader.facets(&RoughPlastic::facets),
        .index_outside = reader.index("ext_ior", "air"),
        .index_inside = reader.index("int_ior", "polypropylene"),
        .diffuse_reflectance = reader.factor_or_texture("diffuse_reflectance", 0.5, &RoughPlastic::diffuse_reflectance),
        .nonlinear = reader.properties.boolean("nonlinear").value_or(false),
        .specular_reflectance =
            reader.factor_or_texture("specular_reflectance", 1.0, &RoughPlastic::specular_reflectance)};
    if (reader.material.is_anisotropic)
        throw InputError(reader.element.place, "roughplastic: expected the same roughness in all directions");
    if (plastic.index_outside == plastic.index_inside) return plastic;  // which is refused
    const double eta = static_cast<double>(plastic.index_inside) / plastic.index_outside;
    if (!reader.is_version_06() && !reader.properties.has("alpha") && reader.has("alpha"))
        throw InputError(reader.element.place, "roughplastic: alpha: expected a number, as in Mitsuba 3");
    const Imath::V2f alphas = reader.range_of_alpha(plastic.facets);
    std::shared_ptr<const RoughCoats>& coats =
        reader.source.rough_coats[{static_cast<double>(plastic.facets.slopes), alphas.x, alphas.y, eta}];
    if (!coats)
        coats = std::make_shared<const RoughCoats>(
            make_rough_coats(plastic.facets.slopes, alphas, eta, !reader.is_version_06()));
    reader.material.data = coats;
    plastic.coats = coats.get();
    return plastic;
}

void RoughPlastic::check(const MaterialCheck& check) const {
    check.in_unit_range("diffuse_reflectance", diffuse_reflectance);
    check.in_unit_range("specular_reflectance", specular_reflectance);
    check.facets(facets);
    check.require(!facets.is_anisotropic(), "the same roughness in all directions");
    check.index(index_outside);
    check.index(index_inside);
    check.require(index_outside != index_inside, "two different indices");
    check.require(check.keeps(coats), "its own coat");
}

}  // namespace photonlab
