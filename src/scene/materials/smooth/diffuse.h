// Lambert's law: light leaves equally bright in every direction.

#pragma once

#include "core/sampling.h"
#include "scene/materials/bsdf.h"

namespace photonlab {

/// f = reflectance / pi above the surface, nothing below.
struct Diffuse {
    static constexpr const char* name = "diffuse";
    static constexpr bool is_transmissive = false;
    static constexpr bool is_wide = true;

    Color reflectance = Color(0.5f);  ///< in [0, 1] a channel

    Color uniform_value() const { return reflectance * static_cast<float>(1.0 / pi); }
    Color evaluate(const Vector& outgoing, const Vector& incoming) const {
        if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return Color(0.0f);
        return uniform_value();
    }
    std::optional<BsdfSample> sample(const Vector& outgoing, Carried, const Imath::V2f& u) const {
        if (outgoing.z <= 0.0f) return std::nullopt;
        const Vector incoming = sample_cosine_hemisphere(u);
        if (incoming.z <= 0.0f) return std::nullopt;
        return BsdfSample{incoming, reflectance, cosine_hemisphere_density(incoming.z)};
    }
    float density(const Vector& outgoing, const Vector& incoming) const {
        return outgoing.z > 0.0f ? cosine_hemisphere_density(incoming.z) : 0.0f;
    }
    bool is_black() const { return photonlab::is_black(reflectance); }

    /// 0.6 knows the reflectance by a second name.
    static Diffuse read(auto& reader) {
        const bool has_other_name = reader.is_version_06() && reader.has("diffuse_reflectance");
        return {reader.factor_or_texture(has_other_name ? "diffuse_reflectance" : "reflectance", 0.5,
                                         &Diffuse::reflectance)};
    }
    void check(const MaterialCheck& check) const { check.in_unit_range("reflectance", reflectance); }
};

}  // namespace photonlab
