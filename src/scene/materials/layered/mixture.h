// Any number of materials in one, each with its weight: blends of two, one inside the other.

#pragma once

#include "scene/materials/material_reader.h"

namespace photonlab {

/// What the weights lack to 1 is black; in 0.6, where alone it is known, they are scaled where they add up to more.
struct Mixture {
    static constexpr const char* name = "mixturebsdf";

    static Material read(MaterialReader& reader);
};

}  // namespace photonlab
