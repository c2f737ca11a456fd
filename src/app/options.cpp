#include "app/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string_view>

#include "app/written_files.h"
#include "core/error.h"
#include "core/files/files.h"
#include "core/text/number_in.h"
#include "integrators/registry.h"

namespace photonlab {

Resolution parse_resolution(const std::string& text) {
    const std::size_t x = text.find('x');
    if (x != std::string::npos) {
        const std::optional<int> width = number_in<int>(std::string_view(text).substr(0, x));
        const std::optional<int> height = number_in<int>(std::string_view(text).substr(x + 1));
        const auto fits = [](std::optional<int> side) { return side && *side >= 1 && *side <= largest_image_side; };
        if (fits(width) && fits(height)) return {*width, *height};
    }
    throw InputError(fmt::format("--resolution: expected WIDTHxHEIGHT in pixels, such as 640x480, got \"{}\"", text));
}

PassesOption parse_passes(const std::string& text) {
    constexpr std::uint64_t most = 0xffffffffu;
    const std::size_t dots = text.find("..");
    const bool is_part = dots != std::string::npos;
    const auto first = is_part ? number_in<std::uint64_t>(std::string_view(text).substr(0, dots)) : 1;
    const auto last = number_in<std::uint64_t>(std::string_view(text).substr(is_part ? dots + 2 : 0));
    if (!first || !last || *first < 1 || *last < *first || *last > most)
        throw InputError(fmt::format(
            "--passes: expected how many, from 1 to {}, or a range of them such as 17..32, got \"{}\"", most, text));
    return {{*first, *last}, is_part};
}

void SceneParameters::add_to(CLI::App& command) {
    command.add_option("-D", texts_, "NAME=VALUE in place of the scene file's <default>; may be given more than once")
        ->allow_extra_args(false);
}

std::map<std::string, std::string> SceneParameters::values() const {
    std::map<std::string, std::string> values;
    for (const std::string& text : texts_) {
        const std::size_t equals = text.find('=');
        if (equals == std::string::npos || equals == 0)
            throw InputError(fmt::format("-D: expected NAME=VALUE, got \"{}\"", text));
        const std::string name = text.substr(0, equals);
        if (!values.emplace(name, text.substr(equals + 1)).second)
            throw InputError(fmt::format("-D: {} is given twice", name));
    }
    return values;
}

std::string require_whole_number(const std::string& text) {
    return number_in<std::uint64_t>(text)
               ? ""
               : fmt::format("expected a whole number from 0 to {}, got \"{}\"", ~std::uint64_t{0}, text);
}

std::string require_seconds(const std::string& text) {
    const std::optional<double> number = number_in<double>(text);
    const bool is_sound = number && *number >= 0.0 && *number <= std::numeric_limits<double>::max();
    return is_sound ? "" : fmt::format("expected a number of seconds, at least 0, got \"{}\"", text);
}

std::string named_by_option(const std::string& message) {
    const auto with = [&](std::string_view name, std::string_view option) {
        return message.starts_with(fmt::format("{}: ", name)) ? std::string(option) + message.substr(name.size()) : "";
    };
    if (const std::string named = with("samples_per_pixel", "--samples-per-pixel"); !named.empty()) return named;
    for (const SettingField& field : setting_fields())
        if (const std::string named = with(field.name, field.option); !named.empty()) return named;
    return message;
}

std::string require_folder_name(const std::string& text) {
    const FileKind* kind = kind_named(text);
    if (!kind || is_folder(text)) return "";
    return fmt::format("expected the name of a folder, got \"{}\", that of a file of {}", text, kind->name);
}

namespace {

/// "ppm: share of photons kept a pass, a number in (0, 1] [0.7]", with other settings called as options are.
std::string help_of(const SettingField& field) {
    const std::vector<std::string_view> users = users_of(field.name);
    const bool is_for_all = users.size() == integrator_kinds().size();
    std::string help = is_for_all ? "" : fmt::format("{}: ", fmt::join(users, ", "));
    help += field.meaning;
    for (const SettingField& other : setting_fields())
        for (const std::string name = fmt::format("`{}`", other.name); help.find(name) != std::string::npos;)
            help.replace(help.find(name), name.size(), other.option);
    const std::string values =
        field.name == "integrator" ? fmt::format("{}", fmt::join(users, ", ")) : describe_values(field);
    if (!values.empty()) help += "; " + values;
    return help + fmt::format(" [{}]", default_of(field));
}

}  // namespace

void MethodOptions::add_to(CLI::App& command) {
    for (const SettingField& field : setting_fields())
        command.add_option(std::string(field.option), texts_[std::string(field.name)], help_of(field))->group("Method");
}

ChosenSettings MethodOptions::settings() const {
    ChosenSettings chosen;
    for (const SettingField& field : setting_fields()) {
        const auto text = texts_.find(field.name);
        if (text == texts_.end() || text->second.empty()) continue;
        try {
            choose(chosen, field, parse_setting_value(text->second));
            require_valid(chosen.values);
            require_used(chosen, field);
        } catch (const InputError& error) {
            const std::string named = named_by_option(error.what());
            throw named.starts_with('-') ? InputError(named) : InputError(std::string(field.option), named);
        }
    }
    return chosen;
}

}  // namespace photonlab
