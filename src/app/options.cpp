#include "app/options.h"

#include <fmt/format.h>

#include <charconv>
#include <cstdint>
#include <limits>

#include "core/error.h"
#include "integrators/registry.h"

namespace photonlab {

Resolution parse_resolution(const std::string& text) {
    constexpr int largest_side = 65536;
    const char* end = text.data() + text.size();
    Resolution resolution{0, 0};
    const auto width = std::from_chars(text.data(), end, resolution.width);
    if (width.ec == std::errc() && width.ptr != end && *width.ptr == 'x') {
        const auto height = std::from_chars(width.ptr + 1, end, resolution.height);
        const auto fits = [](int side) { return side >= 1 && side <= largest_side; };
        if (height.ec == std::errc() && height.ptr == end && fits(resolution.width) && fits(resolution.height))
            return resolution;
    }
    throw InputError(fmt::format("--resolution: expected WIDTHxHEIGHT in pixels, such as 640x480, got \"{}\"", text));
}

std::string require_whole_number(const std::string& text) {
    std::uint64_t number = 0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_sound = read.ec == std::errc() && read.ptr == text.data() + text.size();
    return is_sound ? "" : fmt::format("expected a whole number from 0 to {}, got \"{}\"", ~std::uint64_t{0}, text);
}

std::string require_seconds(const std::string& text) {
    double number = 0.0;
    const auto read = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool is_sound = read.ec == std::errc() && read.ptr == text.data() + text.size() && number >= 0.0 &&
                          number <= std::numeric_limits<double>::max();
    return is_sound ? "" : fmt::format("expected a number of seconds, at least 0, got \"{}\"", text);
}

std::string require_text(const std::string& text) {
    return text.empty() ? "expected a value" : "";
}

void MethodOptions::add_to(CLI::App& command) {
    std::string integrators;
    for (const IntegratorKind& kind : integrator_kinds())
        integrators += (integrators.empty() ? "" : ", ") + std::string(kind.name);
    const MethodSettings defaults;
    for (const SettingField& field : setting_fields()) {
        std::string meaning(field.meaning);
        if (field.name == "integrator") meaning += ": " + integrators;
        if (field.name != "max_depth") meaning += fmt::format(" [{}]", plain_text(field.write(defaults)));
        command.add_option(std::string(field.option), texts_[std::string(field.name)], meaning)
            ->check(require_text)
            ->group("Method");
    }
}

ChosenSettings MethodOptions::settings() const {
    ChosenSettings chosen;
    for (const SettingField& field : setting_fields()) {
        const auto text = texts_.find(field.name);
        if (text == texts_.end() || text->second.empty()) continue;
        choose(chosen, field, parse_setting_value(text->second));
        require_valid(chosen.values);
        require_used(chosen, field);
    }
    return chosen;
}

}  // namespace photonlab
