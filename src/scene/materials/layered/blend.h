// Two materials in one, each for its share of the surface.

#pragma once

#include "scene/materials/part.h"

namespace photonlab {

struct Blend {
    static constexpr const char* name = "blendbsdf";

    Part first;
    Part second;
    float weight = 0.5f;  ///< share of the second, in [0, 1]

    SpecularBranches branches(const Vector& outgoing, Carried carried) const;
    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, Carried carried, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const;
    bool is_black() const { return false; }

    Blend at(const Imath::V2f& uv, bool from_back) const {
        return {first.at(uv, from_back), second.at(uv, from_back), weight};
    }
    bool has_specular_lobe() const;
    bool has_scattering_lobe() const;
    Color straight_through() const;
    bool transmits() const { return first.transmits() || second.transmits(); }
    bool is_seen_from_behind() const { return first.is_seen_from_behind() || second.is_seen_from_behind(); }
    int most_branches() const { return first.most_branches() + second.most_branches(); }
    PartMaterials parts(bool textured) const {
        return {textured || weight < 1.0f ? first.material : nullptr,
                textured || weight > 0.0f ? second.material : nullptr};
    }
    bool adds_single_directions(bool) const { return false; }

    static Blend read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;
};

}  // namespace photonlab
