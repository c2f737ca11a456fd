// The lobe is sampled by its half vector, from all facets' normals: their density is D(h) h.n, that of facets that are
// seen from above. [Walter 2005, "Notes on the Ward BRDF"]

#include "scene/materials/lobes/ward.h"

#include "core/error.h"
#include "core/sampling.h"
#include "core/text/nearest.h"
#include "scene/materials/material_reader.h"

namespace photonlab {

namespace {

const Vector straight_up(0.0f, 0.0f, 1.0f);

double lobe_of(const Ward& ward, const Vector& outgoing, const Vector& incoming) {
    const Vector half = (outgoing + incoming).normalized();
    const double distribution = ward.facets.distribution(half);
    const double along = half.dot(outgoing);
    if (ward.form == WardForm::Balanced) return distribution / (4.0 * along * along);
    const double squared = static_cast<double>(half.z) * half.z;
    const double cosines = static_cast<double>(outgoing.z) * incoming.z;
    return distribution * squared * squared / (4.0 * (ward.form == WardForm::Ward ? std::sqrt(cosines) : cosines));
}

}  // namespace

Color Ward::evaluate(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return Color(0.0f);
    return colors.evaluate(lobe_of(*this, outgoing, incoming));
}

std::optional<BsdfSample> Ward::sample(const Vector& outgoing, Carried, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    const ShareChoice lobe = choose_by_share(u.x, colors.lobe_share());
    const Imath::V2f rest(lobe.rest, u.y);
    const Vector incoming = lobe.is_chosen ? mirrored(outgoing, facets.sample(straight_up, rest)).normalized()
                                           : sample_cosine_hemisphere(rest);
    return sample_of_all_lobes(*this, outgoing, incoming);
}

float Ward::density(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return 0.0f;
    const Vector half = (outgoing + incoming).normalized();
    const double lobe = facets.density(straight_up, half) / (4.0 * half.dot(outgoing));
    return colors.density(lobe, incoming);
}

namespace {

WardForm read_form(MaterialReader& reader) {
    const std::string variant = reader.properties.text("variant").value_or("balanced");
    if (variant == "balanced") return WardForm::Balanced;
    if (variant == "ward-duer") return WardForm::Duer;
    if (variant == "ward") return WardForm::Ward;
    throw InputError(reader.properties.place_of("variant"),
                     unknown_name("variant", variant, {"balanced", "ward", "ward-duer"}));
}

}  // namespace

Ward Ward::read(MaterialReader& reader) {
    Ward ward;
    ward.form = read_form(reader);
    ward.colors = reader.base_and_lobe(&Ward::colors);
    const float alpha = static_cast<float>(reader.properties.number("alpha").value_or(0.1));
    ward.facets.alpha_u = std::max(
        reader.mean_or_texture<Ward>(
            "alpha_u", alpha, [](Ward& bsdf, float mean) { bsdf.facets.alpha_u = std::max(mean, smallest_roughness); }),
        smallest_roughness);
    ward.facets.alpha_v = std::max(
        reader.mean_or_texture<Ward>(
            "alpha_v", alpha, [](Ward& bsdf, float mean) { bsdf.facets.alpha_v = std::max(mean, smallest_roughness); }),
        smallest_roughness);
    const auto is_textured = [&](const char* name) { return reader.has(name) && !reader.properties.has(name); };
    reader.material.is_anisotropic = ward.facets.is_anisotropic() || is_textured("alpha_u") || is_textured("alpha_v");
    return ward;
}

void Ward::check(const MaterialCheck& check) const {
    colors.check(check);
    check.facets(facets);
}

}  // namespace photonlab
