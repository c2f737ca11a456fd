#include "scene/material.h"

#include "core/sampling.h"

namespace photonlab {

Color Diffuse::evaluate(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return Color(0.0f);
    return reflectance * static_cast<float>(1.0 / pi);
}

std::optional<BsdfSample> Diffuse::sample(const Vector& outgoing, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    const Vector incoming = sample_cosine_hemisphere(u);
    if (incoming.z <= 0.0f) return std::nullopt;
    return BsdfSample{incoming, reflectance, cosine_hemisphere_density(incoming.z)};
}

float Diffuse::density(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f) return 0.0f;
    return cosine_hemisphere_density(incoming.z);
}

Color evaluate(const Material& material, const Vector& outgoing, const Vector& incoming) {
    return std::visit([&](const auto& bsdf) { return bsdf.evaluate(outgoing, incoming); }, material.bsdf);
}

std::optional<BsdfSample> sample(const Material& material, const Vector& outgoing, const Imath::V2f& u) {
    return std::visit([&](const auto& bsdf) { return bsdf.sample(outgoing, u); }, material.bsdf);
}

float density(const Material& material, const Vector& outgoing, const Vector& incoming) {
    return std::visit([&](const auto& bsdf) { return bsdf.density(outgoing, incoming); }, material.bsdf);
}

bool is_black(const Material& material) {
    const auto* diffuse = std::get_if<Diffuse>(&material.bsdf);
    return diffuse && is_black(diffuse->reflectance);
}

}  // namespace photonlab
