#include "scene/materials/rough/rough_conductor.h"

#include "scene/materials/material_reader.h"
#include "scene/materials/smooth/conductor.h"

namespace photonlab {

namespace {

Color fresnel(const RoughConductor& bsdf, double cosine) {
    Color result = bsdf.reflectance;
    for (int channel = 0; channel < 3; ++channel)
        result[channel] *= static_cast<float>(fresnel_conductor(cosine, bsdf.eta[channel], bsdf.k[channel]));
    return result;
}

}  // namespace

Color RoughConductor::evaluate(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return Color(0.0f);
    const Vector normal = (outgoing + incoming).normalized();
    return fresnel(*this, outgoing.dot(normal)) * static_cast<float>(facets.reflected(outgoing, incoming, normal));
}

std::optional<BsdfSample> RoughConductor::sample(const Vector& outgoing, Carried, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    const Vector normal = facets.sample(outgoing, u);
    const Vector incoming = mirrored(outgoing, normal).normalized();
    if (incoming.z <= 0.0f || outgoing.dot(normal) <= 0.0f) return std::nullopt;
    const auto weight = static_cast<float>(facets.weight(outgoing, incoming, normal));
    const double density = facets.density(outgoing, normal) / (4.0 * outgoing.dot(normal));
    if (!(density > 0.0)) return std::nullopt;
    return BsdfSample{incoming, fresnel(*this, outgoing.dot(normal)) * weight, static_cast<float>(density)};
}

float RoughConductor::density(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return 0.0f;
    const Vector normal = (outgoing + incoming).normalized();
    return static_cast<float>(facets.density(outgoing, normal) / (4.0 * outgoing.dot(normal)));
}

RoughConductor RoughConductor::read(MaterialReader& reader) {
    const MetalIndex metal = read_metal(reader);
    return {.facets = reader.facets(&RoughConductor::facets),
            .eta = metal.eta,
            .k = metal.k,
            .reflectance = reader.factor_or_texture("specular_reflectance", 1.0, &RoughConductor::reflectance)};
}

void RoughConductor::check(const MaterialCheck& check) const {
    check.in_unit_range("reflectance", reflectance);
    check.facets(facets);
    require_metal(check, eta, k);
}

}  // namespace photonlab
