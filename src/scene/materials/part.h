// What a material that is made of others keeps of each of them.

#pragma once

#include "scene/materials/bsdf.h"

namespace photonlab {

/// Another material, at one point of a surface and seen from one side. The material that is made of it keeps it.
struct Part {
    const Material* material = nullptr;
    Imath::V2f texture_coordinate = Imath::V2f(0.0f);
    bool from_back = false;

    Part at(const Imath::V2f& uv, bool is_from_back) const { return {material, uv, is_from_back}; }

    // What its BSDF there answers.
    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, Carried carried, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const;
    SpecularBranches branches(const Vector& outgoing, Carried carried) const;
    bool has_specular_lobe() const;
    bool has_scattering_lobe() const;
    Color straight_through() const;

    // What the material is, wherever it is looked at.
    bool transmits() const;
    bool is_seen_from_behind() const;
    int most_branches() const;
};

}  // namespace photonlab
