// A material whose shading normal is turned by a texture of heights above the surface.
//
// [Blinn 1978, "Simulation of Wrinkled Surfaces"]

#pragma once

#include "scene/materials/material_reader.h"

namespace photonlab {

/// Heights in scene units, in Mitsuba 3 times `scale`.
struct BumpMap {
    static constexpr const char* name = "bumpmap";

    static Material read(MaterialReader& reader);
};

/// The one material inside, with its normals from `normals`. Throws InputError where it has such a texture already.
Material read_with_normals(MaterialReader& reader, NormalTexture normals);

}  // namespace photonlab
