// Textures: colours that vary over a surface, as a variant of plain structs. Which there are is listed in
// src/scene/CMakeLists.txt. To add one: a file with a struct that answers what TextureKind asks, its name in the list,
// and a test.

#pragma once

#include <memory>
#include <string_view>
#include <variant>

#include "scene/textures/texture_list.h"

namespace photonlab {

struct XmlElement;
struct SceneSource;

struct NestedTexture {
    Texture texture;
};

/// The colour at a texture coordinate.
inline Color color_at(const Texture& texture, const Imath::V2f& texture_coordinate) {
    return std::visit([&](const auto& kind) { return kind.color_at(texture_coordinate); }, texture);
}

inline TextureGradient gradient_at(const Texture& texture, const Imath::V2f& texture_coordinate) {
    return std::visit([&](const auto& kind) { return kind.gradient_at(texture_coordinate); }, texture);
}

/// The largest value of each channel.
inline Color largest_color(const Texture& texture) {
    return std::visit([](const auto& kind) { return kind.largest(); }, texture);
}

/// Brightness of linear sRGB.
template <typename T>
T luminance(const Imath::Color3<T>& color) {
    return T(0.212671) * color.x + T(0.715160) * color.y + T(0.072169) * color.z;
}

/// Between which values all channels are, everywhere. Where one is not finite, `least` and `most` are not a number.
struct TextureRange {
    float least;
    float most;
    float darkest;  ///< above 0 where the texture is nowhere black
};
TextureRange range_of(const Texture& texture);

/// To coordinates in which the texture is bilinear in each square from whole numbers to the next: (u, v, 0) to
/// (x, y, 0), affine.
Matrix to_cells(const Texture& texture);

/// Throws InputError for what is no factor on light: finite, and at least 0. `what` the message calls it.
void require_factor_on_light(const Texture& texture, const std::string& place, std::string_view what = "texture");

/// Throws InputError for what is no reflectance.
void require_reflectance(const Texture& texture, const std::string& place);

/// The texture of a <texture>, checked for its use. Throws InputError.
Texture read_texture(const XmlElement& element, const SceneSource& source, TextureUse use);

}  // namespace photonlab
