#include "scene/materials/part.h"

#include <algorithm>

#include "scene/materials/material.h"

namespace photonlab {

namespace {

Bsdf bsdf_of(const Part& part) {
    return part_at(*part.material, part.texture_coordinate, part.from_back);
}

}  // namespace

Color Part::evaluate(const Vector& outgoing, const Vector& incoming) const {
    return photonlab::evaluate(bsdf_of(*this), outgoing, incoming);
}

std::optional<BsdfSample> Part::sample(const Vector& outgoing, Carried carried, const Imath::V2f& u) const {
    return photonlab::sample(bsdf_of(*this), outgoing, carried, u);
}

float Part::density(const Vector& outgoing, const Vector& incoming) const {
    return photonlab::density(bsdf_of(*this), outgoing, incoming);
}

SpecularBranches Part::branches(const Vector& outgoing, Carried carried) const {
    return photonlab::specular_branches(bsdf_of(*this), outgoing, carried);
}

bool Part::has_specular_lobe() const {
    return is_specular(bsdf_of(*this));
}

bool Part::has_scattering_lobe() const {
    const Bsdf bsdf = bsdf_of(*this);
    return is_scattering(bsdf) && !is_black(bsdf);
}

bool Part::transmits() const {
    return is_transmissive(material->bsdf);
}

bool Part::scatters_through() const {
    return photonlab::scatters_through(bsdf_of(*this));
}

int Part::most_branches() const {
    const int in_front = photonlab::most_branches(material->bsdf);
    return material->back ? std::max(in_front, photonlab::most_branches(material->back->bsdf)) : in_front;
}

}  // namespace photonlab
