#include "scene/material_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>

#include "core/error.h"
#include "scene/mitsuba/properties.h"

namespace photonlab {

namespace {

constexpr std::size_t texture_pixel_limit = std::size_t{1} << 27;  // of a scene: small files can hold very many

/// A factor on what a surface reflects or lets through. Where it is above 1, Mitsuba 3 refuses it and 0.6 scales it
/// down to 0.99.
Color read_factor(Properties& properties, const std::string& name, double missing, const MaterialSource& source) {
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

/// What 0.6 has in place of to_uv.
Matrix read_scale_and_offset(Properties& properties) {
    const double scale = properties.number("uvscale").value_or(1.0);
    Matrix to_uv;
    to_uv.setScale(
        VectorD(properties.number("uscale").value_or(scale), properties.number("vscale").value_or(scale), 1.0));
    to_uv[3][0] = properties.number("uoffset").value_or(0.0);
    to_uv[3][1] = properties.number("voffset").value_or(0.0);
    return to_uv;
}

/// What 0.6 has in place of raw: without a gamma it decodes as the file says.
bool is_linear(Properties& properties) {
    const auto gamma = properties.number("gamma");
    if (gamma && *gamma != 0.0 && *gamma != 1.0)
        throw InputError(properties.place_of("gamma"),
                         fmt::format("gamma: expected 1, or none for that of the file, got {}", *gamma));
    return gamma && *gamma == 1.0;
}

std::shared_ptr<const Texture> read_bitmap(const XmlElement& element, const MaterialSource& source) {
    if (element.require("type") != "bitmap")
        throw InputError(element.place,
                         fmt::format("unknown texture \"{}\"; known here: bitmap", element.attribute("type")));
    Properties properties(element);
    const auto filename = properties.text("filename");
    if (!filename) throw InputError(element.place, "bitmap: expected a <string name=\"filename\">");
    const auto require_only = [&](const std::string& name, const std::string& only) {
        const std::string value = properties.text(name).value_or(only);
        if (value != only)
            throw InputError(properties.place_of(name),
                             fmt::format("{}: only \"{}\" is known here, got \"{}\"", name, only, value));
    };
    const bool is_version_06 = element.family() == MitsubaFamily::Version06;
    // What filters over a pixel in 0.6 is bilinear at a point of it.
    const std::string filter = properties.text("filter_type").value_or("bilinear");
    if (!is_version_06 || (filter != "ewa" && filter != "trilinear")) require_only("filter_type", "bilinear");
    require_only("wrap_mode", "repeat");
    const bool raw = is_version_06 ? is_linear(properties) : properties.boolean("raw").value_or(false);
    const Matrix to_uv =
        is_version_06 ? read_scale_and_offset(properties) : properties.transform("to_uv").value_or(Matrix());
    properties.require_all_known();
    if (!properties.objects().empty())
        throw InputError(properties.objects().front()->place, "bitmap: expected no nested plugin");

    const std::filesystem::path file = element.file_called(*filename);
    read_part(file, properties.place_of("filename"), source.bytes_read);
    auto texture = std::make_shared<Texture>(Texture{read_color_image(file, raw), to_uv});
    source.texture_pixels += texture->image.pixels.size();
    if (source.texture_pixels > texture_pixel_limit)
        throw InputError(properties.place_of("filename"),
                         fmt::format("expected textures of at most {} pixels in all", texture_pixel_limit));
    for (const Color& pixel : texture->image.pixels)
        if (!is_finite(pixel) || std::min({pixel.x, pixel.y, pixel.z}) < 0.0f || max_channel(pixel) > 1.0f)
            throw InputError(properties.place_of("filename"),
                             fmt::format("{}: expected reflectances in [0, 1], got {} {} {}", file.string(), pixel.x,
                                         pixel.y, pixel.z));
    return texture;
}

Material read_diffuse(const XmlElement&, Properties& properties, const MaterialSource& source) {
    Material material;
    Diffuse diffuse;
    // 0.6 knows the reflectance by this name, too.
    const std::string other = properties.family() == MitsubaFamily::Version06 ? "diffuse_reflectance" : "reflectance";
    const std::string name = properties.has(other) && !properties.has("reflectance") ? other : "reflectance";
    for (const XmlElement* object : properties.objects()) {
        const XmlElement& texture = source.resolve(*object);
        const std::string child = object->attribute("name");
        if (texture.tag != "texture" || (child != "reflectance" && child != other) || material.texture)
            throw InputError(
                object->place,
                fmt::format("diffuse: expected one reflectance, a colour or a texture of that name, got <{}>",
                            object->tag));
        material.texture = read_bitmap(texture, source);
    }
    if (material.texture && properties.reflectance(name))
        throw InputError(properties.place_of(name), "diffuse: expected one reflectance, got a colour and a texture");
    diffuse.reflectance = read_factor(properties, name, 0.5, source);
    material.bsdf = diffuse;
    return material;
}

/// Refuses what nests in a material that holds no textures.
void require_no_objects(const Properties& properties, const std::string& type) {
    for (const XmlElement* object : properties.objects())
        throw InputError(object->place,
                         fmt::format("{}: textures are known here only for the reflectance of diffuse, got <{}>", type,
                                     object->tag));
}

/// An index of refraction: a number, or the name of a medium.
float read_index(Properties& properties, const std::string& name, const std::string& missing) {
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

Material read_dielectric(const XmlElement&, Properties& properties, const MaterialSource& source) {
    require_no_objects(properties, "dielectric");
    Material material;
    material.bsdf = Dielectric{.index_here = read_index(properties, "ext_ior", "air"),
                               .index_beyond = read_index(properties, "int_ior", "bk7"),
                               .reflectance = read_factor(properties, "specular_reflectance", 1.0, source),
                               .transmittance = read_factor(properties, "specular_transmittance", 1.0, source)};
    return material;
}

/// A metal's index per channel, or `missing`.
ColorD read_metal_index(Properties& properties, const std::string& name, const Color& missing) {
    const ColorD index = properties.index_of_refraction(name).value_or(ColorD(missing));
    if (std::min({index.x, index.y, index.z}) < 0.0)
        throw InputError(properties.place_of(name), fmt::format("{}: expected values of at least 0, got {} {} {}", name,
                                                                index.x, index.y, index.z));
    return index;
}

/// The metal that a conductor names; where it names none, copper in 0.6 and the perfect mirror in 3.
const NamedConductor& read_metal(Properties& properties) {
    const bool is_version_06 = properties.family() == MitsubaFamily::Version06;
    const std::string wanted = properties.text("material").value_or(is_version_06 ? "Cu" : "none");
    const auto& known = named_conductors();
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const auto& metal) { return metal.name == wanted; });
    if (found != known.end()) return *found;
    std::vector<std::string> names;
    for (const NamedConductor& metal : known) names.push_back(metal.name);
    throw InputError(
        properties.place_of("material"),
        fmt::format("unknown material \"{}\"; known here: {}; or eta and k", wanted, fmt::join(names, ", ")));
}

/// In 0.6 eta and k replace those of the metal, and both are relative to the medium around it. Mitsuba 3 has either the
/// one or the other.
Material read_conductor(const XmlElement& element, Properties& properties, const MaterialSource& source) {
    require_no_objects(properties, "conductor");
    Conductor conductor;
    conductor.reflectance = read_factor(properties, "specular_reflectance", 1.0, source);
    const bool is_version_06 = properties.family() == MitsubaFamily::Version06;
    const NamedConductor& metal = read_metal(properties);
    if (metal.name != "none" && (properties.has("eta") || properties.has("k")) && !is_version_06)
        throw InputError(element.place, "conductor: expected a material's name or eta and k, got both");
    const double outside = is_version_06 ? read_index(properties, "ext_eta", "air") : 1.0;
    conductor.eta = Color(read_metal_index(properties, "eta", metal.eta) / outside);
    conductor.k = Color(read_metal_index(properties, "k", metal.k) / outside);
    Material material;
    material.bsdf = conductor;
    return material;
}

/// Measured data often reflects more than it gets at grazing angles. It is rendered as it is, and that is said.
void note_energy_above_one(const MerlTable& table, const std::string& file, const MaterialSource& source) {
    constexpr double quadrature_error = 0.005;
    const MerlTable::Albedo* brightest = nullptr;
    double most = 1.0 + quadrature_error;
    for (const MerlTable::Albedo& at : table.albedos) {
        const double strongest = std::max({at.albedo.x, at.albedo.y, at.albedo.z});
        if (!(strongest > most)) continue;
        brightest = &at;
        most = strongest;
    }
    if (brightest)
        source.note(
            fmt::format("merl \"{}\": reflects more light than it gets: {:.3f} times as much at {:g} degrees from "
                        "the normal",
                        file, most, brightest->degrees));
}

Material read_merl(const XmlElement& element, Properties& properties, const MaterialSource& source) {
    require_no_objects(properties, "merl");
    const auto filename = properties.text("filename");
    if (!filename) throw InputError(element.place, "merl: expected a <string name=\"filename\">");
    Material material;
    material.table =
        load_merl_table(element.file_called(*filename), properties.place_of("filename"), source.bytes_read);
    material.bsdf = Merl{material.table.get()};
    note_energy_above_one(*material.table, *filename, source);
    return material;
}

Material read_two_sided(const XmlElement& element, Properties& properties, const MaterialSource& source) {
    if (properties.objects().size() != 1)
        throw InputError(element.place,
                         fmt::format("twosided: expected one nested bsdf, got {}", properties.objects().size()));
    const XmlElement& inner = source.resolve(*properties.objects().front());
    if (inner.tag != "bsdf" || inner.attribute("type") == "twosided" || inner.attribute("type") == "dielectric")
        throw InputError(inner.place, fmt::format("twosided: expected a one-sided bsdf, got {} \"{}\"", inner.tag,
                                                  inner.attribute("type")));
    Material material = read_material(inner, source);
    material.two_sided = true;
    return material;
}

struct MaterialKind {
    const char* type;
    Material (*read)(const XmlElement&, Properties&, const MaterialSource&);
};

constexpr MaterialKind material_kinds[] = {
    {"conductor", read_conductor}, {"dielectric", read_dielectric}, {"diffuse", read_diffuse},
    {"merl", read_merl},           {"twosided", read_two_sided},
};

}  // namespace

Material read_material(const XmlElement& element, const MaterialSource& source) {
    const std::string& type = element.require("type");
    std::vector<std::string> known;
    for (const MaterialKind& kind : material_kinds) {
        known.push_back(kind.type);
        if (kind.type != type) continue;
        Properties properties(element);
        Material material = kind.read(element, properties, source);
        properties.require_all_known();
        return material;
    }
    throw InputError(element.place, fmt::format("unknown bsdf \"{}\"; known here: {}", type, fmt::join(known, ", ")));
}

}  // namespace photonlab
