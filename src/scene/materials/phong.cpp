#include "scene/materials/phong.h"

#include <fmt/format.h>

#include "core/sampling.h"
#include "scene/materials/material_reader.h"

namespace photonlab {

namespace {

Vector mirror_direction(const Vector& outgoing) {
    return {-outgoing.x, -outgoing.y, outgoing.z};
}

}  // namespace

Color Phong::evaluate(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return Color(0.0f);
    const double cosine = std::max(0.0f, mirror_direction(outgoing).dot(incoming));
    const double lobe = (exponent + 2.0) / (2.0 * pi) * std::pow(cosine, static_cast<double>(exponent));
    return diffuse_reflectance * static_cast<float>(1.0 / pi) + specular_reflectance * static_cast<float>(lobe);
}

float Phong::lobe_share() const {
    const float lobe = max_channel(specular_reflectance);
    return lobe / (lobe + max_channel(diffuse_reflectance));
}

std::optional<BsdfSample> Phong::sample(const Vector& outgoing, Carried, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    const float share = lobe_share();
    const bool is_lobe = u.x < share;
    const float rest = std::min(is_lobe ? u.x / share : (u.x - share) / (1.0f - share), 0x1.fffffep-1f);
    Vector incoming = sample_cosine_hemisphere({rest, u.y});
    if (is_lobe) {
        const float cosine = std::pow(1.0f - rest, 1.0f / (exponent + 1.0f));
        const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
        const float angle = static_cast<float>(2.0 * pi) * u.y;
        incoming = make_frame(mirror_direction(outgoing))
                       .to_world({sine * std::cos(angle), sine * std::sin(angle), cosine})
                       .normalized();
    }
    const float found = density(outgoing, incoming);
    if (incoming.z <= 0.0f || !(found > 0.0f)) return std::nullopt;
    return BsdfSample{incoming, evaluate(outgoing, incoming) * (incoming.z / found), found};
}

float Phong::density(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return 0.0f;
    const float share = lobe_share();
    const double cosine = std::max(0.0f, mirror_direction(outgoing).dot(incoming));
    const double lobe = (exponent + 1.0) / (2.0 * pi) * std::pow(cosine, static_cast<double>(exponent));
    return share * static_cast<float>(lobe) + (1.0f - share) * cosine_hemisphere_density(incoming.z);
}

/// 0.6 scales the two down together where their sum is above 1.
Phong Phong::read(MaterialReader& reader) {
    Phong phong{
        .exponent = static_cast<float>(reader.properties.number("exponent").value_or(30.0)),
        .diffuse_reflectance = reader.factor_or_texture("diffuse_reflectance", 0.5, &Phong::diffuse_reflectance),
        .specular_reflectance = reader.factor_or_texture("specular_reflectance", 0.2, &Phong::specular_reflectance)};
    const float largest = max_channel(phong.diffuse_reflectance + phong.specular_reflectance);
    if (reader.material.textures.empty() && largest > 1.0f) {
        const float scale = 0.99f / largest;
        reader.source.note(
            fmt::format("{}: phong: its reflectances add up to {:.3f} and are scaled by {:.4f}, as in "
                        "Mitsuba 0.6",
                        reader.element.place, largest, scale));
        phong.diffuse_reflectance *= scale;
        phong.specular_reflectance *= scale;
    }
    return phong;
}

void Phong::check(const MaterialCheck& check) const {
    check.in_unit_range("diffuse_reflectance", diffuse_reflectance);
    check.in_unit_range("specular_reflectance", specular_reflectance);
    check.require(std::isfinite(exponent) && exponent >= 0.0f,
                  fmt::format("an exponent of at least 0, got {}", exponent));
}

}  // namespace photonlab
