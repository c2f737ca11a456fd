#include "scene/materials/bump_map.h"

#include <fmt/format.h>

#include "core/error.h"

namespace photonlab {

Material read_with_normals(MaterialReader& reader, NormalTexture normals) {
    Material material = reader.parts(1).front();
    if (material.normals || (material.back && material.back->normals))
        throw InputError(reader.element.place,
                         fmt::format("{}: expected a material whose normals no other texture turns",
                                     reader.element.attribute("type")));
    material.normals = std::move(normals);
    return material;
}

Material BumpMap::read(MaterialReader& reader) {
    const double scale = reader.is_version_06() ? 1.0 : reader.properties.number("scale").value_or(1.0);
    return read_with_normals(reader, {reader.only_texture(TextureUse::Height), true, scale});
}

}  // namespace photonlab
