#include "experiment/settings_io.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <limits>

#include "core/number_in.h"
#include "integrators/registry.h"

namespace photonlab {

namespace {

Json write_value(const std::string& value) {
    return value;
}
Json write_value(double value) {
    return value;
}
Json write_value(int value) {
    return value;
}
Json write_value(std::uint64_t value) {
    return value;
}
Json write_value(const std::optional<double>& value) {
    return value ? Json(*value) : Json("auto");
}

template <typename Enumeration>
requires std::is_enum_v<Enumeration> Json write_value(Enumeration value) {
    return name_of(value);
}

[[noreturn]] void refuse(std::string_view name, std::string_view expected, const SettingValue& value) {
    throw InputError(fmt::format("{}: expected {}, got {}", name, expected, describe(value)));
}

void read_value(std::string_view name, std::string& target, const SettingValue& value) {
    const auto* text = std::get_if<std::string>(&value);
    if (!text) refuse(name, "a name", value);
    target = *text;
}

void read_value(std::string_view name, double& target, const SettingValue& value) {
    if (const auto* number = std::get_if<double>(&value))
        target = *number;
    else if (const auto* integer = std::get_if<std::int64_t>(&value))
        target = static_cast<double>(*integer);
    else
        refuse(name, "a number", value);
}

void read_value(std::string_view name, std::optional<double>& target, const SettingValue& value) {
    const auto* text = std::get_if<std::string>(&value);
    if (text && *text == "auto") {
        target.reset();
        return;
    }
    if (text || std::holds_alternative<bool>(value)) refuse(name, "\"auto\" or a length in scene units", value);
    double length = 0.0;
    read_value(name, length, value);
    target = length;
}

/// Whole numbers may be written as 1e6.
std::int64_t whole_number(std::string_view name, const SettingValue& value) {
    if (const auto* integer = std::get_if<std::int64_t>(&value)) return *integer;
    const auto* number = std::get_if<double>(&value);
    if (!number || std::abs(*number) >= 0x1p53 || *number != std::trunc(*number)) refuse(name, "a whole number", value);
    return static_cast<std::int64_t>(*number);
}

void read_value(std::string_view name, int& target, const SettingValue& value) {
    const std::int64_t number = whole_number(name, value);
    if (number < std::numeric_limits<int>::min() || number > std::numeric_limits<int>::max())
        refuse(name, "a whole number of 32 bits", value);
    target = static_cast<int>(number);
}

void read_value(std::string_view name, std::uint64_t& target, const SettingValue& value) {
    const std::int64_t number = whole_number(name, value);
    if (number < 0) refuse(name, "a whole number of at least 0", value);
    target = static_cast<std::uint64_t>(number);
}

template <typename Enumeration>
requires std::is_enum_v<Enumeration>
void read_value(std::string_view name, Enumeration& target, const SettingValue& value) {
    const auto* text = std::get_if<std::string>(&value);
    if (!text) refuse(name, fmt::format("one of {}", fmt::join(all_names<Enumeration>(), ", ")), value);
    target = parse_choice<Enumeration>(name, *text);
}

template <auto Member>
constexpr SettingField field(std::string_view name, std::string_view option, std::string_view meaning) {
    return {name, option, meaning, [](const MethodSettings& settings) { return write_value(settings.*Member); },
            [](std::string_view what, MethodSettings& settings, const SettingValue& value) {
                read_value(what, settings.*Member, value);
            }};
}

}  // namespace

const std::vector<SettingField>& setting_fields() {
    using Settings = MethodSettings;
    static const std::vector<SettingField> fields{
        field<&Settings::integrator>("integrator", "--integrator", "name of the method"),
        field<&Settings::mode>("mode", "--mode", "photonmapper: gather within a radius, or the nearest photons"),
        field<&Settings::schedule>("schedule", "--schedule", "ppm: how radii shrink, hachisuka or knaus-zwicker"),
        field<&Settings::alpha>("alpha", "--alpha", "ppm: share of photons kept a pass, in (0, 1]"),
        field<&Settings::k>("k", "--k", "photonmapper, mode nearest: photons searched, at least 2"),
        field<&Settings::radius>("radius", "--radius",
                                 "initial (ppm) or fixed (photonmapper) gather radius in scene units, or auto: "
                                 "the pixel's footprint times --footprints"),
        field<&Settings::footprints>("footprints", "--footprints", "automatic radius in pixel footprints, above 0"),
        field<&Settings::max_radius>("max_radius", "--max-radius",
                                     "photonmapper, mode nearest: largest radius in scene units, or auto: "
                                     "5% of the scene's bounding radius"),
        field<&Settings::caustic_k>("caustic_k", "--caustic-k",
                                    "photonmapper, mode nearest: photons searched in the caustic map, at least 2"),
        field<&Settings::caustic_radius>(
            "caustic_radius", "--caustic-radius",
            "photonmapper, mode radius: radius in the caustic map in scene units, or auto: "
            "as --radius"),
        field<&Settings::caustic_max_radius>("caustic_max_radius", "--caustic-max-radius",
                                             "photonmapper, mode nearest: largest radius in the caustic map in scene "
                                             "units, or auto: a quarter of --max-radius"),
        field<&Settings::kernel>("kernel", "--kernel", "ppm, photonmapper: disc, cone, epanechnikov or biweight"),
        field<&Settings::eps>(
            "eps", "--eps",
            "ppm, photonmapper: inexactness of the search for photons, at least 0: a group of them is looked at "
            "when its squared distance times 1 + eps is within the squared radius; 0 is exact"),
        field<&Settings::direct>("direct", "--direct", "direct light from shadow rays (sampled) or from photons"),
        field<&Settings::direct_samples>("direct_samples", "--direct-samples", "shadow rays a hit point and pass"),
        field<&Settings::max_depth>("max_depth", "--max-depth",
                                    "edges from camera to light, -1 is unlimited [the scene file's]"),
        field<&Settings::branch_cutoff>("branch_cutoff", "--branch-cutoff",
                                        "throughput below which camera paths end at mirrors and glass, 1e-12 to 1"),
        field<&Settings::photons_per_pass>("photons_per_pass", "--photons", "paths emitted a pass"),
    };
    return fields;
}

const SettingField* find_setting_field(std::string_view name) {
    for (const SettingField& field : setting_fields())
        if (field.name == name) return &field;
    return nullptr;
}

SettingValue parse_setting_value(std::string_view text) {
    if (const auto integer = number_in<std::int64_t>(text)) return *integer;
    if (const auto number = number_in<double>(text)) return *number;
    return std::string(text);
}

std::string describe(const SettingValue& value) {
    if (const auto* text = std::get_if<std::string>(&value)) return '"' + *text + '"';
    if (const auto* integer = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *integer);
    if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
    return std::get<bool>(value) ? "true" : "false";
}

std::string plain_text(const Json& scalar) {
    if (scalar.is_null()) return "";
    if (scalar.is_string()) return scalar.get<std::string>();
    if (scalar.is_number_float()) return fmt::format("{}", scalar.get<double>());
    return scalar.dump();
}

std::string setting_text(const MethodSettings& settings, const SettingField& field) {
    return uses_setting(settings, field.name) ? plain_text(field.write(settings)) : "";
}

Json settings_json(const MethodSettings& settings) {
    Json json = Json::object();
    for (const SettingField& field : setting_fields())
        json[std::string(field.name)] = uses_setting(settings, field.name) ? field.write(settings) : Json();
    return json;
}

void choose(ChosenSettings& settings, const SettingField& field, const SettingValue& value) {
    field.read(field.name, settings.values, value);
    settings.given.emplace(field.name);
}

void require_used(const ChosenSettings& settings, const SettingField& field) {
    if (uses_setting(settings.values, field.name)) return;
    std::string used;
    for (const SettingField& other : setting_fields())
        if (uses_setting(settings.values, other.name)) used += (used.empty() ? "" : ", ") + std::string(other.name);
    throw InputError(fmt::format("{} is not used by integrator \"{}\" with its other settings; used here: {}",
                                 field.name, settings.values.integrator, used));
}

MethodSettings resolve(const ChosenSettings& settings, int scene_max_depth) {
    MethodSettings resolved = settings.values;
    if (!settings.given.contains("max_depth")) resolved.max_depth = scene_max_depth;
    return resolved;
}

}  // namespace photonlab
