// A material with holes: where it is not opaque, light passes as if nothing were there.

#pragma once

#include "scene/materials/part.h"

namespace photonlab {

struct Mask {
    static constexpr const char* name = "mask";

    Part inner;
    Color opacity = Color(0.5f);  ///< in [0, 1] a channel

    SpecularBranches branches(const Vector& outgoing, Carried carried) const;
    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, Carried carried, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const;
    bool is_black() const { return false; }

    Mask at(const Imath::V2f& uv, bool from_back) const { return {inner.at(uv, from_back), opacity}; }
    bool has_specular_lobe() const;
    bool has_scattering_lobe() const;
    Color straight_through() const;
    bool transmits() const { return true; }
    bool is_seen_from_behind() const { return true; }
    int most_branches() const { return 1 + inner.most_branches(); }
    PartMaterials parts(bool textured) const {
        return {textured || !photonlab::is_black(opacity) ? inner.material : nullptr, nullptr};
    }
    bool adds_single_directions(bool textured) const { return textured || opacity != Color(1.0f); }

    static Mask read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;

private:
    float inner_share() const { return mean_share(opacity); }
    static float mean_share(const Color& color) { return (color.x + color.y + color.z) / 3.0f; }
};

}  // namespace photonlab
