#include "scene/emitters/light_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "scene/mitsuba/transform.h"

namespace photonlab {

ColorD LightReader::light(const std::string& name, const ColorD& missing) {
    const ColorD light = properties.emission(name).value_or(missing);
    if (std::min({light.x, light.y, light.z}) < 0.0)
        throw InputError(properties.place_of(name), fmt::format("{}: expected values of at least 0, got {} {} {}", name,
                                                                light.x, light.y, light.z));
    return light;
}

TextureAxes LightReader::axes() {
    const Matrix to_world = properties.transform("to_world").value_or(Matrix());
    TextureAxes axes{transform_direction(to_world, {1, 0, 0}), transform_direction(to_world, {0, 1, 0}),
                     transform_direction(to_world, {0, 0, 1})};
    const double scale = axes[0].length();
    constexpr double scale_rounding = 1e-3;  // that of 0.6
    for (VectorD& axis : axes) {
        if (!(std::abs(axis.length() / scale - 1.0) < scale_rounding))
            throw InputError(properties.place_of("to_world"),
                             "to_world: expected a transform that scales alike along all axes");
        axis.normalize();
    }
    constexpr double rounding = 1e-4;  // matrices in files are often written with six digits
    for (std::size_t i = 0; i < 3; ++i)
        if (std::abs(axes[i].dot(axes[(i + 1) % 3])) > rounding)
            throw InputError(properties.place_of("to_world"),
                             "to_world: expected a transform without shear, whose axes stay at right angles");
    if (std::abs(scale - 1.0) > scale_rounding)
        source.note(fmt::format("{} \"{}\": the scale of its to_world, {:g}, changes nothing of a light", element.tag,
                                element.attribute("type"), scale));
    return axes;
}

Vector place_point(const VectorD& position, const SceneExtent& extent, const std::string& place) {
    const Vector there = extent.to_unit_box(position);
    if (!is_squarable(there))
        throw InputError(
            place, fmt::format("position: expected one nearer to the scene, which is {} scene units large, got {} "
                               "{} {}",
                               extent.to_unit_box.unit_length, position.x, position.y, position.z));
    return there;
}

namespace {

/// How often a light is chosen, which changes the noise of an image and not what it shows.
double read_sampling_weight(Plugin& plugin) {
    constexpr double least = 1e-6, most = 1e6;  // beyond, floats lose the power that a photon then has
    const double weight = plugin.properties.number("sampling_weight").value_or(1.0);
    if (!(weight >= least && weight <= most))
        throw InputError(
            plugin.properties.place_of("sampling_weight"),
            fmt::format("sampling_weight: expected a number from {:g} to {:g}, got {}", least, most, weight));
    return weight;
}

template <typename Kind>
auto read_weighted(LightReader& reader) {
    auto light = Kind::read(reader);
    light.sampling_weight = read_sampling_weight(reader);
    reader.require_all_known();
    return light;
}

template <typename Kind>
LightDescription read_kind(LightReader& reader) {
    return read_weighted<Kind>(reader);
}

using Kinds = std::vector<NamedKind<LightReader, LightDescription>>;

template <typename... Lights>
Kinds kinds_of(const std::variant<Lights...>*) {
    return {{Lights::name, read_kind<Lights>}...};
}

/// What there is in Mitsuba for the sky and the sun, which are made of measurements that are not built in here.
constexpr std::string_view sky_models[] = {"sky", "sun", "sunsky"};

[[noreturn]] void fail_unknown_light(const XmlElement& element) {
    const std::string& type = element.require("type");
    if (std::find(std::begin(sky_models), std::end(sky_models), type) != std::end(sky_models))
        throw InputError(element.place,
                         fmt::format("emitter \"{}\": models of the sky are not built in; an image of it can light "
                                     "the scene: <emitter type=\"envmap\"> with a filename",
                                     type));
    std::vector<std::string> known{fmt::format("{} (in a shape)", AreaLight::name)};
    for (const auto& kind : kinds_of(static_cast<const SceneLight*>(nullptr)))
        known.push_back(fmt::format("{} (in the scene)", kind.name));
    fail_unknown(element, {known.begin(), known.end()});
}

}  // namespace

AreaLight::Description read_area_light(const XmlElement& element, const SceneSource& source) {
    if (element.require("type") != AreaLight::name) fail_unknown_light(element);
    LightReader reader(element, source);
    return read_weighted<AreaLight>(reader);
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
