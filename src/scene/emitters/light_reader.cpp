#include "scene/emitters/light_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace photonlab {

ColorD LightReader::light(const std::string& name, const ColorD& missing) {
    const ColorD light = properties.emission(name).value_or(missing);
    if (std::min({light.x, light.y, light.z}) < 0.0)
        throw InputError(properties.place_of(name), fmt::format("{}: expected values of at least 0, got {} {} {}", name,
                                                                light.x, light.y, light.z));
    return light;
}

namespace {

/// How often a light is chosen, which changes the noise of an image and not what it shows.
void read_sampling_weight(Plugin& plugin) {
    const auto weight = plugin.properties.number("sampling_weight");
    if (!weight) return;
    if (!(*weight > 0.0))
        throw InputError(plugin.properties.place_of("sampling_weight"),
                         fmt::format("sampling_weight: expected a number above 0, got {}", *weight));
    plugin.source.note("sampling_weight of emitters: not read; they are chosen by their power");
}

template <typename Result, typename Kind>
Result read_kind(LightReader& reader) {
    Result light = Kind::read(reader);
    read_sampling_weight(reader);
    reader.properties.require_all_known();
    return light;
}

using Kinds = std::vector<NamedKind<LightReader, LightDescription>>;

template <typename... Lights>
Kinds kinds_of(const std::variant<Lights...>*) {
    return {{Lights::name, read_kind<LightDescription, Lights>}...};
}

[[noreturn]] void fail_unknown_light(const XmlElement& element) {
    std::vector<std::string> known{fmt::format("{} (in a shape)", AreaLight::name)};
    for (const auto& kind : kinds_of(static_cast<const SceneLight*>(nullptr)))
        known.push_back(fmt::format("{} (in the scene)", kind.name));
    fail_unknown(element, {known.begin(), known.end()});
}

}  // namespace

ColorD read_area_light(const XmlElement& element, const SceneSource& source) {
    if (element.require("type") != AreaLight::name) fail_unknown_light(element);
    LightReader reader(element, source);
    return read_kind<ColorD, AreaLight>(reader);
}

LightDescription read_scene_light(const XmlElement& element, const SceneSource& source) {
    for (const auto& kind : kinds_of(static_cast<const SceneLight*>(nullptr)))
        if (kind.name == element.require("type")) {
            LightReader reader(element, source);
            return kind.read(reader);
        }
    fail_unknown_light(element);
}

}  // namespace photonlab
