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

void Plugin::pass_over(const std::vector<std::string>& names, const std::string& why) {
    std::vector<std::string> found;
    for (const std::string& name : names)
        if (properties.pass_over(name)) found.push_back(name);
    if (!found.empty())
        source.note(fmt::format("{} \"{}\": not read: {}: {}", element.tag, element.attribute("type"),
                                fmt::join(found, ", "), why));
}

namespace {

/// What other programs that read this format have added, and what tells Mitsuba how to go about its work.
const std::vector<std::string> harmless_properties{
    "cache",          "caustic",          "caustic_caster",   "caustic_receiver", "is_caustic", "max_anisotropy",
    "sample_visible", "use_path_guiding", "mis_compensation", "preserve_colors",  "srgb",       "accel"};

}  // namespace

void Plugin::require_all_known() {
    pass_over(harmless_properties, "it changes how another program renders, and not what");
    properties.require_all_known();
}

void fail_unknown(const XmlElement& element, std::vector<std::string_view> known) {
    std::sort(known.begin(), known.end());
    throw InputError(element.place, unknown_name(element.tag, element.attribute("type"), known));
}

}  // namespace photonlab
