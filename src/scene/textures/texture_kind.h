// What every kind of texture answers.

#pragma once

#include <concepts>
#include <string>
#include <variant>

#include "core/math.h"

namespace photonlab {

struct Plugin;

/// What a texture is for, which decides what it may hold. A reflectance is at every point a colour in [0, 1], light one
/// that is finite and at least 0; a share or a roughness is one number, which its user brings into its range.
enum class TextureUse { Reflectance, Light, Number, Share, Height, Normal };

/// How fast a colour changes with u and with v.
struct TextureGradient {
    ColorD by_u = ColorD(0.0);
    ColorD by_v = ColorD(0.0);
};

/// `name` is the plugin's in scene files. read() throws InputError for what the file says wrongly, and check(place)
/// for what is no reflectance. largest() has the largest value of each channel.
template <typename Kind>
concept TextureKind = requires(const Kind& texture, const Imath::V2f& uv, const std::string& place, Plugin& plugin) {
    { Kind::name } -> std::convertible_to<const char*>;
    { Kind::read(plugin) } -> std::same_as<Kind>;
    { texture.check(place) } -> std::same_as<void>;
    { texture.color_at(uv) } -> std::same_as<Color>;
    { texture.largest() } -> std::same_as<Color>;
    { texture.gradient_at(uv) } -> std::same_as<TextureGradient>;
};

template <TextureKind... Kinds>
using TextureOf = std::variant<Kinds...>;

/// A texture inside another, which is not known yet where that is declared.
struct NestedTexture;

}  // namespace photonlab
