#include "scene/mitsuba/plugin.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/error.h"
#include "core/text/nearest.h"

namespace photonlab {

std::filesystem::path Plugin::require_file() {
    const auto name = properties.text("filename");
    if (!name)
        throw InputError(element.place,
                         fmt::format("{}: expected a <string name=\"filename\">", element.attribute("type")));
    return element.file_called(*name);
}

void Plugin::require_no_objects() const {
    for (const XmlElement* object : properties.objects())
        throw InputError(object->place, fmt::format("{}: expected no nested plugin, got <{}>",
                                                    element.attribute("type"), object->tag));
}

SceneSource Plugin::source_inside(const XmlElement& object, std::string_view kinds) const {
    constexpr int most_nested = 16;
    if (source.depth + 1 > most_nested)
        throw InputError(object.place, fmt::format("expected at most {} {} inside each other", most_nested, kinds));
    SceneSource inside = source;
    ++inside.depth;
    return inside;
}

void Plugin::pass_over(const std::vector<std::string>& names, const std::string& why) {
    std::vector<std::string> found;
    for (const std::string& name : names)
        if (properties.pass_over(name)) found.push_back(name);
    if (!found.empty())
        source.note(fmt::format("{} \"{}\": not read: {}: {}", element.tag, element.attribute("type"),
                                fmt::join(found, ", "), why));
}

namespace {

/// Of elements, by their tags, what other programs that read this format have added to them, and what tells Mitsuba how
/// to go about its work.
const std::map<std::string, std::vector<std::string>> harmless_properties{
    {"bsdf", {"caustic", "caustic_caster", "caustic_receiver", "is_caustic", "sample_visible", "use_path_guiding"}},
    {"emitter", {"cache", "caustic", "is_caustic", "mis_compensation", "use_path_guiding"}},
    {"shape",
     {"caustic", "caustic_caster", "caustic_receiver", "is_caustic", "preserve_colors", "srgb", "use_path_guiding"}},
    {"texture", {"accel", "cache", "max_anisotropy"}}};

}  // namespace

void Plugin::require_all_known() {
    if (const auto names = harmless_properties.find(element.tag); names != harmless_properties.end())
        pass_over(names->second, "it changes how another program renders, and not what");
    properties.require_all_known();
}

void fail_unknown(const XmlElement& element, std::vector<std::string_view> known) {
    std::sort(known.begin(), known.end());
    throw InputError(element.place, unknown_name(element.tag, element.attribute("type"), known));
}

}  // namespace photonlab
