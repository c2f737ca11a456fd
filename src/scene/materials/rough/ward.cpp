// The lobe is sampled by its half vector, from all facets' normals: their density is D(h) h.n, that of facets that are
// seen from above. [Walter 2005, "Notes on the Ward BRDF"]

#include "scene/materials/rough/ward.h"

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
    return diffuse_reflectance * static_cast<float>(1.0 / pi) +
           specular_reflectance * static_cast<float>(lobe_of(*this, outgoing, incoming));
}

float Ward::lobe_share() const {
    return share_beside(max_channel(specular_reflectance), max_channel(diffuse_reflectance));
}

std::optional<BsdfSample> Ward::sample(const Vector& outgoing, Carried, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    const ShareChoice lobe = choose_by_share(u.x, lobe_share());
    const Imath::V2f rest(lobe.rest, u.y);
    const Vector incoming = lobe.is_chosen ? mirrored(outgoing, facets.sample(straight_up, rest)).normalized()
                                           : sample_cosine_hemisphere(rest);
    if (incoming.z <= 0.0f) return std::nullopt;
    const float found = density(outgoing, incoming);
    if (!(found > 0.0f)) return std::nullopt;
    return BsdfSample{incoming, evaluate(outgoing, incoming) * (incoming.z / found), found};
}

float Ward::density(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return 0.0f;
    const float share = lobe_share();
    const Vector half = (outgoing + incoming).normalized();
    const double lobe = facets.density(straight_up, half) / (4.0 * half.dot(outgoing));
    return share * static_cast<float>(lobe) + (1.0f - share) * cosine_hemisphere_density(incoming.z);
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
    reader.read_base_and_lobe(ward);
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
    check.in_unit_range("diffuse_reflectance", diffuse_reflectance);
    check.in_unit_range("specular_reflectance", specular_reflectance);
    check.facets(facets);
}

}  // namespace photonlab
