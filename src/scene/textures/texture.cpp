#include "scene/textures/texture.h"

#include "scene/mitsuba/plugin.h"

namespace photonlab {

namespace {

template <typename Kind>
Texture read_kind(Plugin& plugin) {
    Kind texture = Kind::read(plugin);
    plugin.require_all_known();
    return texture;
}

template <typename... Kinds>
std::vector<NamedKind<Plugin, Texture>> kinds_of(const std::variant<Kinds...>*) {
    return {{Kinds::name, read_kind<Kinds>}...};
}

}  // namespace

void require_reflectance(const Texture& texture, const std::string& place) {
    std::visit([&](const auto& kind) { kind.check(place); }, texture);
}

Texture read_texture(const XmlElement& element, const SceneSource& source, TextureUse use) {
    const auto kinds = kinds_of(static_cast<const Texture*>(nullptr));
    const auto& kind = find_kind(kinds, element);
    Plugin plugin(element, source);
    Texture texture = kind.read(plugin);
    if (auto* board = std::get_if<Checkerboard>(&texture); board && use == TextureUse::Share && !plugin.is_version_06())
        std::swap(board->first, board->second);  // so does Mitsuba 3 where a checkerboard is one number
    if (use == TextureUse::Reflectance) require_reflectance(texture, plugin.properties.place_of("filename"));
    return texture;
}

}  // namespace photonlab
