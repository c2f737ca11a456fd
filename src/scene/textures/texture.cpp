#include "scene/textures/texture.h"

#include "scene/mitsuba/plugin.h"

namespace photonlab {

namespace {

template <typename Kind>
Texture read_kind(Plugin& plugin) {
    Kind texture = Kind::read(plugin);
    plugin.properties.require_all_known();
    texture.check(plugin.properties.place_of("filename"));
    return texture;
}

template <typename... Kinds>
std::vector<NamedKind<Plugin, Texture>> kinds_of(const std::variant<Kinds...>*) {
    return {{Kinds::name, read_kind<Kinds>}...};
}

}  // namespace

Texture read_texture(const XmlElement& element, const SceneSource& source) {
    const auto kinds = kinds_of(static_cast<const Texture*>(nullptr));
    const auto& kind = find_kind(kinds, element);
    Plugin plugin(element, source);
    return kind.read(plugin);
}

}  // namespace photonlab
