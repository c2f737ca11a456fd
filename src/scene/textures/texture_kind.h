// What every kind of texture answers.

#pragma once

#include <concepts>
#include <string>
#include <variant>

#include "core/math.h"

namespace photonlab {

struct Plugin;

/// `name` is the plugin's in scene files. read() throws InputError for what the file says wrongly, and check(place)
/// for what is no reflectance: at every point a colour in [0, 1].
template <typename Kind>
concept TextureKind = requires(const Kind& texture, const Imath::V2f& uv, const std::string& place, Plugin& plugin) {
    { Kind::name } -> std::convertible_to<const char*>;
    { Kind::read(plugin) } -> std::same_as<Kind>;
    { texture.check(place) } -> std::same_as<void>;
    { texture.color_at(uv) } -> std::same_as<Color>;
};

template <TextureKind... Kinds>
using TextureOf = std::variant<Kinds...>;

}  // namespace photonlab
