// A material that looks from behind as from the front, or as another.

#pragma once

#include "scene/materials/material_reader.h"

namespace photonlab {

struct TwoSided {
    static constexpr const char* name = "twosided";

    static Material read(MaterialReader& reader);
};

}  // namespace photonlab
