// Lambert's law: light leaves equally bright in every direction.

#pragma once

#include "scene/materials/bsdf.h"

namespace photonlab {

/// f = reflectance / pi above the surface, nothing below.
struct Diffuse {
    static constexpr const char* name = "diffuse";

    Color reflectance = Color(0.5f);  ///< in [0, 1] a channel

    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const;
};

}  // namespace photonlab
