// A pane of glass, so thin that what it lets through is not displaced: both of its faces as one surface.

#pragma once

#include "scene/materials/bsdf.h"

namespace photonlab {

/// With R of one face, and all reflections between the two: 2 R / (1 + R) is reflected, and the rest goes straight on.
struct ThinDielectric {
    static constexpr const char* name = "thindielectric";
    static constexpr bool is_transmissive = true;

    float index_outside = 1.0f;         ///< on both sides, above 0
    float index_inside = 1.5f;          ///< above 0
    Color reflectance = Color(1.0f);    ///< factor on what is reflected, in [0, 1] a channel
    Color transmittance = Color(1.0f);  ///< factor on what goes through, in [0, 1] a channel

    SpecularBranches branches(const Vector& outgoing, Carried) const;
    ThinDielectric turned_over() const { return *this; }
    bool is_black() const { return false; }

    static ThinDielectric read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;
};

}  // namespace photonlab
