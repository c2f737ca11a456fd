#include "scene/materials/lobes/phong.h"

#include <fmt/format.h>

#include "core/sampling.h"
#include "scene/materials/material_reader.h"

namespace photonlab {

Color Phong::evaluate(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return Color(0.0f);
    const double cosine = std::max(0.0f, mirror_direction(outgoing).dot(incoming));
    const double lobe = (exponent + 2.0) / (2.0 * pi) * std::pow(cosine, static_cast<double>(exponent));
    return colors.evaluate(lobe);
}

std::optional<BsdfSample> Phong::sample(const Vector& outgoing, Carried, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    const ShareChoice lobe = choose_by_share(u.x, colors.lobe_share());
    Vector incoming = sample_cosine_hemisphere({lobe.rest, u.y});
    if (lobe.is_chosen) {
        const float cosine = std::pow(1.0f - lobe.rest, 1.0f / (exponent + 1.0f));
        const float sine = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
        const float angle = static_cast<float>(2.0 * pi) * u.y;
        incoming = make_frame(mirror_direction(outgoing))
                       .to_world({sine * std::cos(angle), sine * std::sin(angle), cosine})
                       .normalized();
    }
    return sample_of_all_lobes(*this, outgoing, incoming);
}

float Phong::density(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return 0.0f;
    const double cosine = std::max(0.0f, mirror_direction(outgoing).dot(incoming));
    const double lobe = (exponent + 1.0) / (2.0 * pi) * std::pow(cosine, static_cast<double>(exponent));
    return colors.density(lobe, incoming);
}

Phong Phong::read(MaterialReader& reader) {
    Phong phong;
    phong.colors = reader.base_and_lobe(&Phong::colors);
    phong.exponent =
        reader.mean_or_texture<Phong>("exponent", 30.0f, [](Phong& bsdf, float mean) { bsdf.exponent = mean; });
    return phong;
}

void Phong::check(const MaterialCheck& check) const {
    colors.check(check);
    check.require(std::isfinite(exponent) && exponent >= 0.0f,
                  fmt::format("an exponent of at least 0, got {}", exponent));
}

}  // namespace photonlab
