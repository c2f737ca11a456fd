// Textures: colours that vary over a surface, as a variant of plain structs. Which there are is listed in
// src/scene/CMakeLists.txt. To add one: a file with a struct that answers what TextureKind asks, its name in the list,
// and a test.

#pragma once

#include <variant>

#include "scene/textures/texture_list.h"

namespace photonlab {

struct XmlElement;
struct SceneSource;

/// The colour at a texture coordinate.
inline Color color_at(const Texture& texture, const Imath::V2f& texture_coordinate) {
    return std::visit([&](const auto& kind) { return kind.color_at(texture_coordinate); }, texture);
}

/// The texture of a <texture>, checked. Throws InputError.
Texture read_texture(const XmlElement& element, const SceneSource& source);

}  // namespace photonlab
