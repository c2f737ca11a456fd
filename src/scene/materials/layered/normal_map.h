// A material whose shading normal comes from a texture.

#pragma once

#include "scene/materials/material_reader.h"

namespace photonlab {

/// Normals in the frame of the surface's texture coordinates, as 2 c - 1 of the texture's colour c.
struct NormalMap {
    static constexpr const char* name = "normalmap";

    static Material read(MaterialReader& reader);
};

}  // namespace photonlab
