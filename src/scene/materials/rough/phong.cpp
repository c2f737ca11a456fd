#include "scene/materials/rough/phong.h"

#include <fmt/format.h>

#include "core/sampling.h"
#include "scene/materials/material_reader.h"

namespace photonlab {

Color Phong::evaluate(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return Color(0.0f);
    const double cosine = std::max(0.0f, mirror_direction(outgoing).dot(incoming));
    const double lobe = (exponent + 2.0) / (2.0 * pi) * std::pow(cosine, static_cast<double>(exponent));
    return diffuse_reflectance * static_cast<float>(1.0 / pi) + specular_reflectance * static_cast<float>(lobe);
}

float Phong::lobe_share() const {
    return share_beside(max_channel(specular_reflectance), max_channel(diffuse_reflectance));
}

std::optional<BsdfSample> Phong::sample(const Vector& outgoing, Carried, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    const ShareChoice lobe = choose_by_share(u.x, lobe_share());
    Vector incoming = sample_cosine_hemisphere({lobe.rest, u.y});
    if (lobe.is_chosen) {
        const float cosine = std::pow(1.0f - lobe.rest, 1.0f / (exponent + 1.0f));
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

Phong Phong::read(MaterialReader& reader) {
    Phong phong;
    reader.read_base_and_lobe(phong);
    phong.exponent =
        reader.mean_or_texture<Phong>("exponent", 30.0f, [](Phong& bsdf, float mean) { bsdf.exponent = mean; });
    return phong;
}

void Phong::check(const MaterialCheck& check) const {
    check.in_unit_range("diffuse_reflectance", diffuse_reflectance);
    check.in_unit_range("specular_reflectance", specular_reflectance);
    check.require(std::isfinite(exponent) && exponent >= 0.0f,
                  fmt::format("an exponent of at least 0, got {}", exponent));
}

}  // namespace photonlab
