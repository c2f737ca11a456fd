#include "scene/materials/material_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "core/text/nearest.h"
#include "scene/materials/wrapper_list.h"

namespace photonlab {

MaterialReader::MaterialReader(const XmlElement& plugin, const SceneSource& scene) : Plugin(plugin, scene) {
    const char* name = "ensure_energy_conservation";
    if (is_version_06() && properties.has(name)) may_scale_ = properties.boolean(name).value_or(true);
}

void MaterialReader::require_may_scale(const std::string& place, const std::string& what, double largest) const {
    if (!may_scale_)
        throw InputError(place, fmt::format("{} {:g}, and ensureEnergyConservation is false: expected at most 1, or "
                                            "true, which scales it down",
                                            what, largest));
}

/// Where a factor is above 1, Mitsuba 3 refuses it and 0.6 scales it down to 0.99.
Color MaterialReader::factor(const std::string& name, double missing) {
    ColorD factor = properties.reflectance(name).value_or(ColorD(missing));
    const double largest = std::max({factor.x, factor.y, factor.z});
    const bool is_scaled = largest > 1.0 && properties.family() == MitsubaFamily::Version06;
    if (std::min({factor.x, factor.y, factor.z}) < 0.0 || (largest > 1.0 && !is_scaled))
        throw InputError(properties.place_of(name), fmt::format("{}: expected values in [0, 1], got {} {} {}", name,
                                                                factor.x, factor.y, factor.z));
    if (is_scaled) {
        require_may_scale(properties.place_of(name), name + " is", largest);
        source.note(fmt::format("{}: {} of {:.3f} {:.3f} {:.3f} is scaled by {:.4f}, as in Mitsuba 0.6",
                                properties.place_of(name), name, factor.x, factor.y, factor.z, 0.99 / largest));
        factor *= 0.99 / largest;
    }
    return Color(factor);
}

ColorOrTexture MaterialReader::color_or_texture(const std::string& name, double missing) {
    ColorOrTexture result{.color = Color(properties.reflectance(name).value_or(ColorD(missing))),
                          .texture = find_texture(name, TextureUse::Number)};
    const Color largest = result.largest();
    if (result.texture && max_channel(largest) <= 1.0f) require_reflectance(*result.texture, element.place);
    return result;
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
    std::vector<std::string_view> known{"a number"};
    for (const NamedMedium& candidate : named_media()) {
        if (candidate.name == medium) return static_cast<float>(candidate.index);
        known.push_back(candidate.name);
    }
    throw InputError(properties.place_of(name), name + ": " + unknown_name("medium", medium, known));
}

const XmlElement* MaterialReader::texture_called(const std::string& name) const {
    for (const XmlElement* object : properties.objects())
        if (object->attribute("name") == name && source.resolve(*object).tag == "texture") return object;
    return nullptr;
}

std::shared_ptr<const Texture> MaterialReader::find_texture(const std::string& name, TextureUse use) {
    textures_asked_.insert(name);
    const XmlElement* object = texture_called(name);
    if (!object) return nullptr;
    if (properties.has(name))
        throw InputError(properties.place_of(name), fmt::format("{}: expected one {}, got a colour and a texture",
                                                                element.attribute("type"), name));
    if (!objects_read_.insert(object).second) return nullptr;
    return std::make_shared<const Texture>(read_texture(source.resolve(*object), source, use));
}

std::shared_ptr<const Texture> MaterialReader::only_texture(TextureUse use) {
    std::shared_ptr<const Texture> found;
    for (const XmlElement* object : properties.objects()) {
        const XmlElement& plugin = source.resolve(*object);
        if (plugin.tag != "texture") continue;
        if (found)
            throw InputError(object->place,
                             fmt::format("{}: expected one texture, got a second", element.attribute("type")));
        objects_read_.insert(object);
        found = std::make_shared<const Texture>(read_texture(plugin, source, use));
    }
    if (!found)
        throw InputError(element.place, fmt::format("{}: expected a texture, got none", element.attribute("type")));
    return found;
}

const std::vector<Material>& MaterialReader::parts(std::size_t count) {
    constexpr int most_nested = 16;           // one inside the other
    constexpr std::size_t most_inside = 256;  // in the outermost one, in all
    std::size_t count_inside = 0;
    SceneSource inside = source;
    ++inside.depth;
    if (!inside.nested_count) inside.nested_count = &count_inside;
    std::vector<Material> parts;
    for (const XmlElement* object : properties.objects()) {
        const XmlElement& plugin = source.resolve(*object);
        if (plugin.tag != "bsdf") continue;
        objects_read_.insert(object);
        if (inside.depth > most_nested)
            throw InputError(object->place, fmt::format("expected at most {} bsdfs inside each other", most_nested));
        if (++*inside.nested_count > most_inside)
            throw InputError(object->place, fmt::format("expected at most {} bsdfs inside one", most_inside));
        parts.push_back(read_material(plugin, inside));
        parts.back().id = plugin.attribute("id").empty() ? plugin.attribute("type") : plugin.attribute("id");
        parts.back().place = plugin.place;
    }
    if (parts.size() != count)
        throw InputError(element.place, fmt::format("{}: expected {} nested bsdf{}, got {}", element.attribute("type"),
                                                    count, count == 1 ? "" : "s", parts.size()));
    for (const Material& part : parts) remember_part(material, part);
    const auto kept = std::make_shared<const std::vector<Material>>(std::move(parts));
    material.data = kept;
    return *kept;
}

Microfacets MaterialReader::read_facets() {
    Microfacets facets;
    std::vector<std::pair<std::string_view, FacetSlopes>> known{{"beckmann", FacetSlopes::Beckmann},
                                                                {"ggx", FacetSlopes::Ggx}};
    if (is_version_06()) known.insert(known.end(), {{"phong", FacetSlopes::Phong}, {"as", FacetSlopes::Phong}});
    std::string name = properties.text("distribution").value_or("beckmann");
    for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    std::vector<std::string_view> names;
    for (const auto& [known_name, slopes] : known) {
        names.push_back(known_name);
        if (name == known_name) facets.slopes = slopes;
    }
    if (std::find(names.begin(), names.end(), name) == names.end())
        throw InputError(properties.place_of("distribution"), unknown_name("distribution", name, names));
    properties.boolean("sample_visible");  // which changes noise alone
    if (has("alpha_u") != has("alpha_v") || (has("alpha_u") && has("alpha")))
        throw InputError(element.place,
                         fmt::format("{}: expected alpha, or alpha_u and alpha_v", element.attribute("type")));
    const auto alpha_called = [&](const char* called) {
        const double alpha = properties.number(called).value_or(0.1);
        if (!(alpha >= 0.0))
            throw InputError(properties.place_of(called),
                             fmt::format("{}: expected a number of at least 0, got {}", called, alpha));
        return std::max(static_cast<float>(alpha), smallest_roughness);
    };
    facets.alpha_u = alpha_called(has("alpha_u") ? "alpha_u" : "alpha");
    facets.alpha_v = alpha_called(has("alpha_v") ? "alpha_v" : "alpha");
    return facets;
}

Imath::V2f MaterialReader::range_of_alpha(const Microfacets& facets) const {
    constexpr float largest = 4.0f;
    if (!alpha_texture_) return Imath::V2f(facets.alpha_u);
    const TextureRange range = range_of(*alpha_texture_);
    if (!(range.most <= largest))
        throw InputError(element.place, fmt::format("{}: alpha: expected a texture of at most {}, got {}",
                                                    element.attribute("type"), largest, range.most));
    return {std::max(range.least, smallest_roughness), std::max(range.most, smallest_roughness)};
}

/// 0.6 scales both down by one factor where the largest values of the two add up to more than 1.
MaterialReader::ScaledBaseAndLobe MaterialReader::read_base_and_lobe() {
    ScaledBaseAndLobe colors{.base = color_or_texture("diffuse_reflectance", 0.5),
                             .lobe = color_or_texture("specular_reflectance", 0.2),
                             .scale = 1.0f};
    const float largest = max_channel(colors.base.largest() + colors.lobe.largest());
    if (largest > 1.0f && std::isfinite(largest)) {
        const std::string type = element.attribute("type");
        colors.scale = 0.99f / largest;
        require_may_scale(element.place, type + ": its reflectances add up to", largest);
        source.note(fmt::format("{}: {}: its reflectances add up to {:.3f} and are scaled by {:.4f}, as in Mitsuba 0.6",
                                element.place, type, largest, colors.scale));
    }
    return colors;
}

void MaterialReader::pass_over_roughness() {
    pass_over({"alpha", "alpha_u", "alpha_v", "distribution"},
              "it is smooth; what is rough is called rough" + element.attribute("type"));
}

void MaterialReader::require_all_known() {
    Plugin::require_all_known();
    for (const XmlElement* object : properties.objects())
        if (!objects_read_.count(object))
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

using MaterialKinds = std::vector<NamedKind<MaterialReader, Material>>;

template <typename... Bsdfs, typename... Wrappers>
MaterialKinds material_kinds(const std::variant<Bsdfs...>*, const std::variant<Wrappers...>*) {
    return {{Bsdfs::name, read_bsdf<Bsdfs>}..., {Wrappers::name, read_whole<Wrappers, MaterialReader, Material>}...};
}

}  // namespace

Material read_material(const XmlElement& element, const SceneSource& source) {
    const MaterialKinds kinds =
        material_kinds(static_cast<const Bsdf*>(nullptr), static_cast<const MaterialWrapper*>(nullptr));
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
