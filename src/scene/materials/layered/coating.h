// A clear coat over any material: it reflects like glass, bends what goes through it, and may colour it.

#pragma once

#include "scene/materials/part.h"

namespace photonlab {

/// The material below is met in the refracted directions: f = T(o) T(i) A f'(o', i') / n^2, with A what the coat
/// absorbs on the way in and out. Light that returns to the base is left out, and the coat is there from behind too,
/// as in Mitsuba. [Weidlich & Wilkie 2007,
/// "Arbitrarily Layered Micro-Facet Surfaces"]
struct Coating {
    static constexpr const char* name = "coating";

    Part inner;                                ///< one through which no light passes
    float index_outside = 1.0f;                ///< above 0
    float index_inside = 1.5f;                 ///< of the coat, above 0
    Color absorption = Color(0.0f);            ///< of the coat straight through it: sigma times thickness, at least 0
    Color specular_reflectance = Color(1.0f);  ///< factor on what the coat reflects, in [0, 1] a channel

    SpecularBranches branches(const Vector& outgoing, Carried carried) const;
    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, Carried carried, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const;
    bool is_black() const { return false; }

    Coating at(const Imath::V2f& uv, bool from_back) const;
    bool has_specular_lobe() const { return true; }
    bool has_scattering_lobe() const { return inner.has_scattering_lobe(); }
    Color straight_through() const { return Color(0.0f); }
    bool transmits() const { return false; }
    bool is_seen_from_behind() const { return true; }
    int most_branches() const { return 1 + inner.most_branches(); }
    PartMaterials parts(bool) const { return {inner.material, nullptr}; }
    bool adds_single_directions(bool) const { return true; }

    static Coating read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;

private:
    struct Refracted;
    double eta() const { return static_cast<double>(index_outside) / index_inside; }
    Refracted refracted(const Vector& direction) const;
    std::optional<Vector> let_out(const Vector& inside) const;
    Color let_through(const Refracted& outgoing, const Refracted& incoming) const;
    float coat_share(const Refracted& outgoing) const;
};

}  // namespace photonlab
