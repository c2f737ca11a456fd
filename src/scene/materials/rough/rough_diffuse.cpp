#include "scene/materials/rough/rough_diffuse.h"

#include <fmt/format.h>

#include "scene/materials/material_reader.h"

namespace photonlab {

Color RoughDiffuse::evaluate(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return Color(0.0f);
    const double variance = 0.5 * static_cast<double>(alpha) * alpha;  // of angles
    const double sine_out = std::hypot(outgoing.x, outgoing.y);
    const double sine_in = std::hypot(incoming.x, incoming.y);
    const double across =  // cosine of the angle between the two, seen from above
        sine_out > 0.0 && sine_in > 0.0
            ? (static_cast<double>(outgoing.x) * incoming.x + static_cast<double>(outgoing.y) * incoming.y) /
                  (sine_out * sine_in)
            : 0.0;
    const bool out_is_lower = outgoing.z < incoming.z;
    const double steep_sine = out_is_lower ? sine_out : sine_in;
    const double flat_sine = out_is_lower ? sine_in : sine_out;
    const double flat_cosine = std::max(outgoing.z, incoming.z);
    const double steep_cosine = std::min(outgoing.z, incoming.z);
    const double flat_tangent = flat_sine / flat_cosine;
    const double c1 = 1.0 - 0.5 * variance / (variance + 0.33);
    const double share = variance / (variance + 0.09);
    const ColorD rho(reflectance);
    if (is_qualitative)
        return Color(rho * ((c1 + 0.45 * share * std::max(0.0, across) * steep_sine * flat_tangent) / pi));
    const double steep = std::atan2(steep_sine, steep_cosine);
    const double flat = std::atan2(flat_sine, flat_cosine);
    const double turned = 2.0 * flat / pi;
    const double c2 = 0.45 * share * (across > 0.0 ? steep_sine : steep_sine - turned * turned * turned);
    const double product = 4.0 * steep * flat / (pi * pi);
    const double c3 = 0.125 * share * product * product;
    const double half_tangent = std::tan(0.5 * (steep + flat));
    const double once = c1 + across * c2 * flat_tangent + (1.0 - std::abs(across)) * c3 * half_tangent;
    const double twice = 0.17 * variance / (variance + 0.13) * (1.0 - across * turned * turned);
    return Color((rho * once + rho * rho * twice) / pi);
}

std::optional<BsdfSample> RoughDiffuse::sample(const Vector& outgoing, Carried, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    const Vector incoming = sample_cosine_hemisphere(u);
    if (incoming.z <= 0.0f) return std::nullopt;
    return BsdfSample{incoming, evaluate(outgoing, incoming) * static_cast<float>(pi),
                      cosine_hemisphere_density(incoming.z)};
}

RoughDiffuse RoughDiffuse::read(MaterialReader& reader) {
    const bool has_other_name = reader.has("diffuse_reflectance");
    return {.reflectance = reader.factor_or_texture(has_other_name ? "diffuse_reflectance" : "reflectance", 0.5,
                                                    &RoughDiffuse::reflectance),
            .alpha = reader.mean_or_texture<RoughDiffuse>("alpha", 0.2f,
                                                          [](RoughDiffuse& bsdf, float mean) { bsdf.alpha = mean; }),
            .is_qualitative = reader.properties.boolean("use_fast_approx").value_or(false)};
}

void RoughDiffuse::check(const MaterialCheck& check) const {
    check.in_unit_range("reflectance", reflectance);
    check.require(std::isfinite(alpha) && alpha >= 0.0f, fmt::format("a roughness of at least 0, got {}", alpha));
}

}  // namespace photonlab
