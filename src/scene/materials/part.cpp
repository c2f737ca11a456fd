#include "scene/materials/part.h"

#include <algorithm>

#include "scene/materials/material.h"

namespace photonlab {

namespace {

/// Asks its BSDF there, which need not be made where it is the same everywhere.
template <typename Ask>
auto ask_bsdf_of(const Part& part, const Ask& ask) {
    const Material& material = *part.material;
    if (!part.from_back && material.textures.empty() && !material.parts_look_up_textures) return ask(material.bsdf);
    return ask(part_at(material, part.texture_coordinate, part.from_back));
}

}  // namespace

Color Part::evaluate(const Vector& outgoing, const Vector& incoming) const {
    return ask_bsdf_of(*this, [&](const Bsdf& bsdf) { return photonlab::evaluate(bsdf, outgoing, incoming); });
}

std::optional<BsdfSample> Part::sample(const Vector& outgoing, Carried carried, const Imath::V2f& u) const {
    return ask_bsdf_of(*this, [&](const Bsdf& bsdf) { return photonlab::sample(bsdf, outgoing, carried, u); });
}

float Part::density(const Vector& outgoing, const Vector& incoming) const {
    return ask_bsdf_of(*this, [&](const Bsdf& bsdf) { return photonlab::density(bsdf, outgoing, incoming); });
}

SpecularBranches Part::branches(const Vector& outgoing, Carried carried) const {
    return ask_bsdf_of(*this, [&](const Bsdf& bsdf) { return specular_branches(bsdf, outgoing, carried); });
}

bool Part::has_specular_lobe() const {
    return ask_bsdf_of(*this, is_specular);
}

bool Part::has_scattering_lobe() const {
    return ask_bsdf_of(*this, [](const Bsdf& bsdf) { return is_scattering(bsdf) && !is_black(bsdf); });
}

Color Part::straight_through() const {
    return ask_bsdf_of(*this, photonlab::straight_through);
}

bool Part::transmits() const {
    return is_transmissive(material->bsdf);
}

bool Part::is_seen_from_behind() const {
    return photonlab::is_seen_from_behind(*material);
}

int Part::most_branches() const {
    const int in_front = photonlab::most_branches(material->bsdf);
    return material->back ? std::max(in_front, photonlab::most_branches(material->back->bsdf)) : in_front;
}

}  // namespace photonlab
