#include "scene/mitsuba/properties.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/error.h"
#include "core/text/nearest.h"
#include "image/read_image.h"
#include "scene/mitsuba/spectrum.h"
#include "scene/mitsuba/transform.h"

namespace photonlab {

namespace {

const std::set<std::string> value_tags{"float", "integer",  "boolean", "string", "rgb",
                                       "srgb",  "spectrum", "point",   "vector", "transform"};
const std::set<std::string> color_tags{"float", "rgb", "spectrum", "srgb"};
const std::set<std::string> object_tags{"bsdf", "emitter", "film",    "integrator", "medium", "phase",
                                        "ref",  "rfilter", "sampler", "sensor",     "shape",  "texture"};

/// "#rrggbb": sRGB, except in an <rgb> of Mitsuba 0.6, which takes the bytes for linear.
ColorD parse_hexadecimal(const std::string& text, const XmlElement& element) {
    if (text.size() != 7 || text.find_first_not_of("0123456789abcdefABCDEF", 1) != std::string::npos)
        throw InputError(element.place, fmt::format("expected a colour as #rrggbb, got \"{}\"", excerpt(text)));
    const bool is_linear = element.tag == "rgb" && element.family() == MitsubaFamily::Version06;
    ColorD color;
    for (unsigned i = 0; i < 3; ++i) {
        const double value = std::stoi(text.substr(1 + 2 * i, 2), nullptr, 16) / 255.0;
        color[static_cast<int>(i)] = is_linear ? value : srgb_to_linear(value);
    }
    return color;
}

ColorD parse_rgb(const XmlElement& element) {
    const std::string& text = element.require("value");
    if (!text.empty() && text.front() == '#') return parse_hexadecimal(text, element);
    const std::vector<double> numbers = parse_numbers(text, element.place);
    if (numbers.size() != 1 && numbers.size() != 3)
        throw InputError(element.place, fmt::format("expected 1 or 3 numbers, got \"{}\"", excerpt(text)));
    const auto channel = [&](std::size_t i) {
        const double value = numbers[numbers.size() == 1 ? 0 : i];
        return element.tag == "srgb" ? srgb_to_linear(value) : value;
    };
    return {channel(0), channel(1), channel(2)};
}

/// A <spectrum> that is a plugin of Mitsuba 3: those that an RGB renderer evaluates.
ColorD parse_spectrum_plugin(const XmlElement& element) {
    const std::string& type = element.require("type");
    Properties properties(element);
    ColorD color(1.0);
    if (type == "uniform") {
        const auto value = properties.number("value");
        if (!value) throw InputError(element.place, "uniform: expected a <float name=\"value\">");
        color = ColorD(*value);
    } else if (type == "srgb") {
        const auto value = properties.reflectance("color");
        if (!value) throw InputError(element.place, "srgb: expected an <rgb name=\"color\">");
        color = *value;
    } else if (type == "d65") {
        color = properties.reflectance("color").value_or(ColorD(1.0)) * properties.number("scale").value_or(1.0);
    } else {
        throw InputError(element.place, fmt::format("unknown spectrum \"{}\"; known here: d65, srgb, uniform, or pairs "
                                                    "wavelength:value",
                                                    type));
    }
    properties.require_all_known();
    if (!properties.objects().empty())
        throw InputError(properties.objects().front()->place, fmt::format("{}: expected no nested plugin", type));
    return color;
}

bool is_plugin(const XmlElement& element) {
    return element.tag == "spectrum" && !element.attribute("type").empty();
}

/// What all colours have in common but those by wavelength.
ColorD parse_color(const XmlElement& element) {
    return is_plugin(element) ? parse_spectrum_plugin(element) : parse_rgb(element);
}

bool is_by_wavelength(const XmlElement& element) {
    return element.tag == "spectrum" && !is_plugin(element) && element.require("value").find(':') != std::string::npos;
}

/// A single value that stands for all wavelengths.
bool is_uniform_spectrum(const XmlElement& element) {
    return element.tag == "spectrum" && !is_plugin(element) &&
           parse_numbers(element.require("value"), element.place).size() == 1;
}

}  // namespace

Properties::Properties(const XmlElement& plugin) : plugin_(plugin) {
    for (const XmlElement& child : plugin.children) {
        if (object_tags.count(child.tag)) {
            objects_.push_back(&child);
        } else if (value_tags.count(child.tag)) {
            const std::string& name = child.require("name");
            if (!properties_.emplace(name, &child).second)
                throw InputError(child.place, fmt::format("expected one property \"{}\", got a second", name));
        } else {
            throw InputError(child.place, fmt::format("unknown element <{}>; known here: {}, {}", child.tag,
                                                      fmt::join(value_tags, ", "), fmt::join(object_tags, ", ")));
        }
    }
}

const XmlElement* Properties::take(const std::string& name, const std::set<std::string>& tags) {
    asked_.insert(name);
    const auto found = properties_.find(name);
    if (found == properties_.end()) return nullptr;
    if (!tags.count(found->second->tag))
        throw InputError(found->second->place, fmt::format("property \"{}\": expected <{}>, got <{}>", name,
                                                           fmt::join(tags, "> or <"), found->second->tag));
    return found->second;
}

std::optional<double> Properties::number(const std::string& name) {
    const XmlElement* element = take(name, {"float", "integer"});
    if (!element) return std::nullopt;
    return parse_number(element->require("value"), element->place);
}

std::optional<long> Properties::integer(const std::string& name) {
    const XmlElement* element = take(name, {"integer"});
    if (!element) return std::nullopt;
    return parse_integer(element->require("value"), element->place);
}

std::optional<bool> Properties::boolean(const std::string& name) {
    const XmlElement* element = take(name, {"boolean"});
    if (!element) return std::nullopt;
    return parse_boolean(element->require("value"), element->place);
}

std::optional<std::string> Properties::text(const std::string& name) {
    const XmlElement* element = take(name, {"string"});
    if (!element) return std::nullopt;
    return element->require("value");
}

std::optional<std::variant<double, std::string>> Properties::number_or_text(const std::string& name) {
    const XmlElement* element = take(name, {"float", "integer", "string"});
    if (!element) return std::nullopt;
    if (element->tag == "string") return element->require("value");
    return parse_number(element->require("value"), element->place);
}

std::optional<ColorD> Properties::reflectance(const std::string& name) {
    const XmlElement* element = take(name, color_tags);
    if (!element) return std::nullopt;
    if (!is_by_wavelength(*element)) return parse_color(*element);
    const Spectrum spectrum = parse_spectrum(element->require("value"), element->place);
    const bool is_version_06 = element->family() == MitsubaFamily::Version06;
    for (const double value : spectrum.values)
        if (value < 0.0 || (value > 1.0 && !is_version_06))
            throw InputError(element->place, fmt::format("{}: expected values in [0, 1], got {}", name, value));
    if (is_version_06) return rgb_under_equal_energy(spectrum);
    const ColorD rgb = rgb_under_d65(spectrum);
    return ColorD(std::min(rgb.x, 1.0), std::min(rgb.y, 1.0), std::min(rgb.z, 1.0));
}

std::optional<ColorD> Properties::index_of_refraction(const std::string& name) {
    const XmlElement* element = take(name, color_tags);
    if (!element) return std::nullopt;
    if (!is_by_wavelength(*element)) return parse_color(*element);
    const Spectrum spectrum = parse_spectrum(element->require("value"), element->place);
    return element->family() == MitsubaFamily::Version06 ? rgb_under_equal_energy(spectrum) : rgb_under_d65(spectrum);
}

std::optional<ColorD> Properties::emission(const std::string& name) {
    const XmlElement* element = take(name, color_tags);
    if (!element) return std::nullopt;
    if (is_by_wavelength(*element)) {
        const Spectrum spectrum = parse_spectrum(element->require("value"), element->place);
        for (const double value : spectrum.values)
            if (value < 0.0)
                throw InputError(element->place, fmt::format("{}: expected values of at least 0, got {}", name, value));
        return rgb_under_equal_energy(spectrum);
    }
    // 0.6 takes the one value for a multiple of D65, which is white in its RGB builds.
    if (is_uniform_spectrum(*element) && element->family() == MitsubaFamily::Version3)
        return equal_energy_white() * parse_rgb(*element);
    return parse_color(*element);
}

std::optional<VectorD> Properties::vector(const std::string& name) {
    const XmlElement* element = take(name, {"point", "vector"});
    if (!element) return std::nullopt;
    return parse_vector(*element);
}

std::optional<Matrix> Properties::transform(const std::string& name) {
    const XmlElement* element = take(name, {"transform"});
    if (!element) return std::nullopt;
    return parse_transform(*element);
}

void Properties::require_all_known() const {
    const std::vector<std::string_view> known(asked_.begin(), asked_.end());
    for (const auto& [name, element] : properties_) {
        if (asked_.count(name)) continue;
        const std::string guess = did_you_mean(name, known);
        throw InputError(
            element->place,
            fmt::format("unknown property \"{}\" of {} \"{}\"{}{}{}", name, plugin_.tag, plugin_.attribute("type"),
                        guess, guess.empty() ? "; known here: " : " Known here: ", fmt::join(asked_, ", ")));
    }
}

std::vector<std::string> Properties::unknown() const {
    std::vector<std::string> names;
    for (const auto& [name, element] : properties_)
        if (!asked_.count(name)) names.push_back(name);
    return names;
}

const std::string& Properties::place_of(const std::string& name) const {
    const auto found = properties_.find(name);
    return found == properties_.end() ? plugin_.place : found->second->place;
}

}  // namespace photonlab
