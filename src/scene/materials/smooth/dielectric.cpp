#include "scene/materials/smooth/dielectric.h"

#include <cmath>

#include "scene/materials/material_reader.h"

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
        result.add(mirror_direction(outgoing), reflectance * static_cast<float>(fresnel.reflected));
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

Dielectric Dielectric::read(MaterialReader& reader) {
    reader.pass_over_roughness();
    return {.index_here = reader.index("ext_ior", "air"),
            .index_beyond = reader.index("int_ior", "bk7"),
            .reflectance = reader.factor_or_texture("specular_reflectance", 1.0, &Dielectric::reflectance),
            .transmittance = reader.factor_or_texture("specular_transmittance", 1.0, &Dielectric::transmittance)};
}

void Dielectric::check(const MaterialCheck& check) const {
    check.in_unit_range("reflectance", reflectance);
    check.in_unit_range("transmittance", transmittance);
    check.index(index_here);
    check.index(index_beyond);
}

}  // namespace photonlab
