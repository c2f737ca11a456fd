#include "scene/materials/diffuse.h"

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

}  // namespace photonlab
