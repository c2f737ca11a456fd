#include "scene/materials/smooth/plastic.h"

#include "core/sampling.h"
#include "scene/materials/material_reader.h"
#include "scene/materials/smooth/dielectric.h"

namespace photonlab {

namespace {

double reflected_at(const Plastic& plastic, double cosine) {
    if (plastic.index_outside == plastic.index_inside) return 0.0;
    return fresnel_dielectric(cosine, static_cast<double>(plastic.index_outside) / plastic.index_inside).reflected;
}

}  // namespace

SpecularBranches Plastic::branches(const Vector& outgoing, Carried) const {
    SpecularBranches result;
    if (outgoing.z <= 0.0f) return result;
    result.add(mirror_direction(outgoing), specular_reflectance * static_cast<float>(reflected_at(*this, outgoing.z)));
    return result;
}

Color Plastic::evaluate(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return Color(0.0f);
    const double let_in = (1.0 - reflected_at(*this, outgoing.z)) * (1.0 - reflected_at(*this, incoming.z));
    const double eta = static_cast<double>(index_outside) / index_inside;
    const Color base = reflectance_under_coat(diffuse_reflectance, inner_reflectance, nonlinear);
    return base * static_cast<float>(let_in * eta * eta / pi);
}

float Plastic::coat_share(float cosine) const {
    const auto reflected = static_cast<float>(reflected_at(*this, cosine));
    const float coat = reflected * max_channel(specular_reflectance);
    const float base = (1.0f - reflected) * max_channel(diffuse_reflectance);
    return share_beside(coat, base);
}

std::optional<BsdfSample> Plastic::sample(const Vector& outgoing, Carried carried, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    const float share = coat_share(outgoing.z);
    const ShareChoice coat = choose_by_share(u.x, share);
    if (coat.is_chosen) {
        const SpecularBranch reflection = *branches(outgoing, carried).begin();
        return BsdfSample{reflection.incoming, reflection.weight / share, 0.0f};
    }
    const Vector incoming = sample_cosine_hemisphere({coat.rest, u.y});
    if (incoming.z <= 0.0f) return std::nullopt;
    const Color f = evaluate(outgoing, incoming);
    return BsdfSample{incoming, f * static_cast<float>(pi) / (1.0f - share),
                      (1.0f - share) * cosine_hemisphere_density(incoming.z)};
}

float Plastic::density(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f) return 0.0f;
    return (1.0f - coat_share(outgoing.z)) * cosine_hemisphere_density(incoming.z);
}

Color reflectance_under_coat(Color rho, float inner_reflectance, bool nonlinear) {
    for (int channel = 0; channel < 3; ++channel)
        rho[channel] /= 1.0f - (nonlinear ? rho[channel] : 1.0f) * inner_reflectance;
    return rho;
}

double inner_reflectance_of(double eta) {
    if (eta == 1.0) return 0.0;
    // Over the squared cosine, of which F is a function with a kink at the critical angle: the midpoint rule in a
    // variable that is flat there.
    constexpr int steps = 20'000;
    const double critical = eta > 1.0 ? 1.0 - 1.0 / (eta * eta) : 0.0;  // squared cosine; all is thrown back below
    double sum = 0.0;
    for (int i = 0; i < steps; ++i) {
        const double x = (i + 0.5) / steps;
        const double squared_cosine = critical + (1.0 - critical) * x * x;
        sum += fresnel_dielectric(std::sqrt(squared_cosine), eta).reflected * 2.0 * x;
    }
    return critical + (1.0 - critical) * sum / steps;
}

double fitted_inner_reflectance_of(double eta) {
    if (eta > 1.0) return -1.4399 / (eta * eta) + 0.7099 / eta + 0.6681 + 0.0636 * eta;
    return 0.919317 + eta * (-3.4793 + eta * (6.75335 + eta * (-7.80989 + eta * (4.98554 - eta * 1.36881))));
}

Plastic Plastic::read(MaterialReader& reader) {
    Plastic plastic{
        .index_outside = reader.index("ext_ior", "air"),
        .index_inside = reader.index("int_ior", "polypropylene"),
        .nonlinear = reader.properties.boolean("nonlinear").value_or(false),
        .diffuse_reflectance = reader.factor_or_texture("diffuse_reflectance", 0.5, &Plastic::diffuse_reflectance),
        .specular_reflectance = reader.factor_or_texture("specular_reflectance", 1.0, &Plastic::specular_reflectance)};
    const double eta = static_cast<double>(plastic.index_inside) / plastic.index_outside;
    plastic.inner_reflectance =
        static_cast<float>(reader.is_version_06() ? inner_reflectance_of(eta) : fitted_inner_reflectance_of(eta));
    return plastic;
}

void Plastic::check(const MaterialCheck& check) const {
    check.in_unit_range("diffuse_reflectance", diffuse_reflectance);
    check.in_unit_range("specular_reflectance", specular_reflectance);
    check.index(index_outside);
    check.index(index_inside);
    check.require(inner_reflectance >= 0.0f && inner_reflectance < 1.0f, "an inner reflectance in [0, 1)");
}

}  // namespace photonlab
