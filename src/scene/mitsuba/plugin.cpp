#include "scene/mitsuba/plugin.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/error.h"

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

void fail_unknown(const XmlElement& element, std::vector<std::string_view> known) {
    std::sort(known.begin(), known.end());
    throw InputError(element.place, fmt::format("unknown {} \"{}\"; known here: {}", element.tag,
                                                element.attribute("type"), fmt::join(known, ", ")));
}

}  // namespace photonlab
