#include "scene/materials/mask.h"

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
    if (u.x >= share) return BsdfSample{-outgoing, (Color(1.0f) - opacity) / (1.0f - share), 0.0f};
    auto drawn = inner.sample(outgoing, carried, {std::min(u.x / share, 0x1.fffffep-1f), u.y});
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

Mask Mask::read(MaterialReader& reader) {
    // In 3 the opacity is one number; in 0.6 a colour.
    const bool is_number = !reader.is_version_06();
    Mask mask;
    mask.opacity = reader.factor_or_texture("opacity", 0.5, &Mask::opacity, is_number);
    if (is_number) mask.opacity = Color(luminance(mask.opacity));
    mask.inner.material = &reader.parts(1).front();
    // What it lets through goes straight on, whatever the normal.
    reader.material.normals = mask.inner.material->normals;
    return mask;
}

void Mask::check(const MaterialCheck& check) const {
    check.in_unit_range("opacity", opacity);
    check.part(inner.material);
}

}  // namespace photonlab
