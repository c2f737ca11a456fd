#include "scene/materials/dielectric.h"

namespace photonlab {

FresnelDielectric fresnel_dielectric(double cos_here, double eta) {
    const double cos2_beyond = 1.0 - eta * eta * (1.0 - std::min(1.0, cos_here * cos_here));
    if (!(cos2_beyond > 0.0)) return {1.0, 0.0};
    const double cos_beyond = std::sqrt(cos2_beyond);
    const double perpendicular = (eta * cos_here - cos_beyond) / (eta * cos_here + cos_beyond);
    const double parallel = (cos_here - eta * cos_beyond) / (cos_here + eta * cos_beyond);
    return {0.5 * (perpendicular * perpendicular + parallel * parallel), cos_beyond};
}

SpecularBranches Dielectric::branches(const Vector& outgoing, Carried carried) const {
    SpecularBranches result;
    if (outgoing.z <= 0.0f) return result;
    if (index_here == index_beyond) {
        result.add(-outgoing, transmittance);
        return result;
    }
    const double eta = static_cast<double>(index_here) / static_cast<double>(index_beyond);
    const FresnelDielectric fresnel = fresnel_dielectric(outgoing.z, eta);
    if (fresnel.reflected > 0.0)
        result.add({-outgoing.x, -outgoing.y, outgoing.z}, reflectance * static_cast<float>(fresnel.reflected));
    if (fresnel.cos_beyond > 0.0) {
        // Radiance over the square of the index is what refraction conserves. [Veach 1997, equation 5.2]
        const double compression = carried == Carried::Radiance ? eta * eta : 1.0;
        const float weight = static_cast<float>((1.0 - fresnel.reflected) * compression);
        const auto along = static_cast<float>(-eta);
        const Vector refracted(outgoing.x * along, outgoing.y * along, -static_cast<float>(fresnel.cos_beyond));
        result.add(refracted.normalized(), transmittance * weight);
    }
    return result;
}

// Mitsuba's names and values.
const std::vector<NamedMedium>& named_media() {
    static const std::vector<NamedMedium> media{
        {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
        {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
        {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
        {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
        {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
        {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
        {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
        {"pet", 1.5750},      {"diamond", 2.419},
    };
    return media;
}

}  // namespace photonlab
