// Lambert's law: light leaves equally bright in every direction.

#pragma once

#include "core/sampling.h"
#include "scene/materials/bsdf.h"

namespace photonlab {

/// f = reflectance / pi above the surface, nothing below.
struct Diffuse {
    static constexpr const char* name = "diffuse";

    Color reflectance = Color(0.5f);  ///< in [0, 1] a channel

    Color evaluate(const Vector& outgoing, const Vector& incoming) const {
        if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return Color(0.0f);
        return reflectance * static_cast<float>(1.0 / pi);
    }
    std::optional<BsdfSample> sample(const Vector& outgoing, const Imath::V2f& u) const {
        if (outgoing.z <= 0.0f) return std::nullopt;
        const Vector incoming = sample_cosine_hemisphere(u);
        if (incoming.z <= 0.0f) return std::nullopt;
        return BsdfSample{incoming, reflectance, cosine_hemisphere_density(incoming.z)};
    }
    float density(const Vector& outgoing, const Vector& incoming) const {
        return outgoing.z > 0.0f ? cosine_hemisphere_density(incoming.z) : 0.0f;
    }
};

}  // namespace photonlab
