#include "scene/materials/layered/mask.h"

#include "core/sampling.h"
#include "scene/materials/material_reader.h"

namespace photonlab {

SpecularBranches Mask::branches(const Vector& outgoing, Carried carried) const {
    SpecularBranches result;
    if (opacity != Color(1.0f)) result.add(-outgoing, Color(1.0f) - opacity);
    if (photonlab::is_black(opacity)) return result;
    for (const SpecularBranch& branch : inner.branches(outgoing, carried))
        result.add(branch.incoming, branch.weight * opacity);
    return result;
}

Color Mask::evaluate(const Vector& outgoing, const Vector& incoming) const {
    return photonlab::is_black(opacity) ? Color(0.0f) : inner.evaluate(outgoing, incoming) * opacity;
}

std::optional<BsdfSample> Mask::sample(const Vector& outgoing, Carried carried, const Imath::V2f& u) const {
    const float share = inner_share();
    const ShareChoice inside = choose_by_share(u.x, share);
    if (!inside.is_chosen) return BsdfSample{-outgoing, (Color(1.0f) - opacity) / (1.0f - share), 0.0f};
    auto drawn = inner.sample(outgoing, carried, {inside.rest, u.y});
    if (!drawn) return std::nullopt;
    drawn->weight *= opacity / share;
    drawn->density *= share;
    return drawn;
}

float Mask::density(const Vector& outgoing, const Vector& incoming) const {
    return inner_share() * inner.density(outgoing, incoming);
}

bool Mask::has_specular_lobe() const {
    return opacity != Color(1.0f) || inner.has_specular_lobe();
}

bool Mask::has_scattering_lobe() const {
    return !photonlab::is_black(opacity) && inner.has_scattering_lobe();
}

Color Mask::straight_through() const {
    const Color through = Color(1.0f) - opacity;
    return photonlab::is_black(opacity) ? through : through + opacity * inner.straight_through();
}

/// In 3 the opacity is one number; in 0.6 a colour.
Mask Mask::read(MaterialReader& reader) {
    Mask mask;
    mask.opacity = reader.is_version_06() ? reader.factor_or_texture("opacity", 0.5, &Mask::opacity)
                                          : reader.share_of_color_or_texture("opacity", 0.5, &Mask::opacity);
    mask.inner.material = &reader.parts(1).front();
    reader.material.normals = mask.inner.material->normals;
    reader.material.normals_behind = mask.inner.material->normals_behind;
    return mask;
}

void Mask::check(const MaterialCheck& check) const {
    check.in_unit_range("opacity", opacity);
    check.part(inner.material);
}

}  // namespace photonlab
