#include "scene/materials/smooth/thin_dielectric.h"

#include "scene/materials/material_reader.h"
#include "scene/materials/smooth/dielectric.h"

namespace photonlab {

SpecularBranches ThinDielectric::branches(const Vector& outgoing, Carried) const {
    SpecularBranches result;
    if (outgoing.z <= 0.0f) return result;
    const double of_face =
        fresnel_dielectric(outgoing.z, static_cast<double>(index_outside) / static_cast<double>(index_inside))
            .reflected;
    const double reflected = index_outside == index_inside ? 0.0 : 2.0 * of_face / (1.0 + of_face);
    if (reflected > 0.0) result.add(mirror_direction(outgoing), reflectance * static_cast<float>(reflected));
    if (reflected < 1.0) result.add(-outgoing, transmittance * static_cast<float>(1.0 - reflected));
    return result;
}

ThinDielectric ThinDielectric::read(MaterialReader& reader) {
    return {.index_outside = reader.index("ext_ior", "air"),
            .index_inside = reader.index("int_ior", "bk7"),
            .reflectance = reader.factor_or_texture("specular_reflectance", 1.0, &ThinDielectric::reflectance),
            .transmittance = reader.factor_or_texture("specular_transmittance", 1.0, &ThinDielectric::transmittance)};
}

void ThinDielectric::check(const MaterialCheck& check) const {
    check.in_unit_range("reflectance", reflectance);
    check.in_unit_range("transmittance", transmittance);
    check.index(index_outside);
    check.index(index_inside);
}

}  // namespace photonlab
