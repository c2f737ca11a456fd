#include "scene/materials/layered/normal_map.h"

#include "scene/materials/layered/bump_map.h"

namespace photonlab {

Material NormalMap::read(MaterialReader& reader) {
    return read_with_normals(reader, {reader.only_texture(TextureUse::Normal), false, 1.0});
}

}  // namespace photonlab
