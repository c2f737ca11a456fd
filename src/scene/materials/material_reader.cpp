#include "scene/materials/material_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "scene/materials/wrapper_list.h"

namespace photonlab {

/// Where a factor is above 1, Mitsuba 3 refuses it and 0.6 scales it down to 0.99.
Color MaterialReader::factor(const std::string& name, double missing) {
    ColorD factor = properties.reflectance(name).value_or(ColorD(missing));
    const double largest = std::max({factor.x, factor.y, factor.z});
    const bool is_scaled = largest > 1.0 && properties.family() == MitsubaFamily::Version06;
    if (std::min({factor.x, factor.y, factor.z}) < 0.0 || (largest > 1.0 && !is_scaled))
        throw InputError(properties.place_of(name), fmt::format("{}: expected values in [0, 1], got {} {} {}", name,
                                                                factor.x, factor.y, factor.z));
    if (is_scaled) {
        source.note(fmt::format("{}: {} of {:.3f} {:.3f} {:.3f} is scaled by {:.4f}, as in Mitsuba 0.6",
                                properties.place_of(name), name, factor.x, factor.y, factor.z, 0.99 / largest));
        factor *= 0.99 / largest;
    }
    return Color(factor);
}

float MaterialReader::index(const std::string& name, const std::string& missing) {
    const auto value = properties.number_or_text(name);
    if (value && std::holds_alternative<double>(*value)) {
        const double index = std::get<double>(*value);
        if (!(index >= 0.1 && index <= 10.0))
            throw InputError(properties.place_of(name),
                             fmt::format("{}: expected an index of 0.1 to 10, got {}", name, index));
        return static_cast<float>(index);
    }
    std::string medium = value ? std::get<std::string>(*value) : missing;
    for (char& c : medium) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    std::vector<std::string> known;
    for (const NamedMedium& candidate : named_media()) {
        if (candidate.name == medium) return static_cast<float>(candidate.index);
        known.push_back(candidate.name);
    }
    throw InputError(properties.place_of(name), fmt::format("{}: unknown medium \"{}\"; known here: a number, {}", name,
                                                            medium, fmt::join(known, ", ")));
}

const XmlElement* MaterialReader::texture_called(const std::string& name) const {
    for (const XmlElement* object : properties.objects())
        if (object->attribute("name") == name && source.resolve(*object).tag == "texture") return object;
    return nullptr;
}

std::shared_ptr<const Texture> MaterialReader::find_texture(const std::string& name) {
    textures_asked_.insert(name);
    const XmlElement* object = texture_called(name);
    if (!object) return nullptr;
    if (properties.has(name))
        throw InputError(properties.place_of(name), fmt::format("{}: expected one {}, got a colour and a texture",
                                                                element.attribute("type"), name));
    return std::make_shared<const Texture>(read_texture(source.resolve(*object), source));
}

void MaterialReader::require_all_known() const {
    properties.require_all_known();
    std::set<std::string> open = textures_asked_;
    for (const XmlElement* object : properties.objects())
        if (source.resolve(*object).tag != "texture" || !open.erase(object->attribute("name")))
            throw InputError(object->place,
                             fmt::format("{}: expected {}, got <{}> \"{}\"", element.attribute("type"),
                                         textures_asked_.empty()
                                             ? "no nested plugin"
                                             : fmt::format("one texture for {}", fmt::join(textures_asked_, " or ")),
                                         object->tag, object->attribute("name")));
}

// ---------------------------------------------------------------------------------------------------------------------

namespace {

template <BsdfKind Kind>
Material read_bsdf(MaterialReader& reader) {
    reader.material.bsdf = Kind::read(reader);
    reader.require_all_known();
    return std::move(reader.material);
}

template <MaterialWrapperKind Kind>
Material read_wrapper(MaterialReader& reader) {
    Material material = Kind::read(reader);
    reader.properties.require_all_known();
    return material;
}

using Kinds = std::vector<NamedKind<MaterialReader, Material>>;

template <typename... Bsdfs, typename... Wrappers>
Kinds kinds_of(const std::variant<Bsdfs...>*, const std::variant<Wrappers...>*) {
    return {{Bsdfs::name, read_bsdf<Bsdfs>}..., {Wrappers::name, read_wrapper<Wrappers>}...};
}

}  // namespace

Material read_material(const XmlElement& element, const SceneSource& source) {
    const Kinds kinds = kinds_of(static_cast<const Bsdf*>(nullptr), static_cast<const MaterialWrapper*>(nullptr));
    const auto& kind = find_kind(kinds, element);
    MaterialReader reader(element, source);
    return kind.read(reader);
}

// Mitsuba's names and values.
const std::vector<NamedMedium>& named_media() {
    static const std::vector<NamedMedium> media{
        {"vacuum", 1.0},      {"helium", 1.000036},        {"hydrogen", 1.000132},
        {"air", 1.000277},    {"carbon dioxide", 1.00045}, {"water", 1.3330},
        {"acetone", 1.36},    {"ethanol", 1.361},          {"carbon tetrachloride", 1.461},
        {"glycerol", 1.4729}, {"benzene", 1.501},          {"silicone oil", 1.52045},
        {"bromine", 1.661},   {"water ice", 1.31},         {"fused quartz", 1.458},
        {"pyrex", 1.470},     {"acrylic glass", 1.49},     {"polypropylene", 1.49},
        {"bk7", 1.5046},      {"sodium chloride", 1.544},  {"amber", 1.55},
        {"pet", 1.5750},      {"diamond", 2.419},
    };
    return media;
}

}  // namespace photonlab
