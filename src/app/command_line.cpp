#include "app/command_line.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>

#include "core/error.h"
#include "core/text/nearest.h"
#include "core/text/number_in.h"

namespace photonlab {

namespace {

std::vector<std::string> command_names(const CLI::App& app) {
    std::vector<std::string> names;
    for (const CLI::App* command : app.get_subcommands({})) names.push_back(command->get_name());
    return names;
}

/// All options, with their dashes.
std::vector<std::string> option_names(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    return names;
}

std::string_view without_dashes(std::string_view option) {
    return option.substr(std::min(option.find_first_not_of('-'), option.size()));
}

/// Looks like an option, and is no number below 0.
bool is_option(const std::string& word) {
    return word.size() > 1 && word[0] == '-' && !number_in<double>(word);
}

[[noreturn]] void refuse_option(const std::string& word, const CLI::App& command, const std::string& advice) {
    const std::string written = word.substr(0, word.find('='));
    const std::vector<std::string> names = option_names(command);
    std::vector<std::string_view> known;
    for (const std::string& name : names) known.push_back(without_dashes(name));
    const std::string_view nearest = nearest_name(without_dashes(written), known);
    const auto at = std::find(known.begin(), known.end(), nearest) - known.begin();
    throw InputError(fmt::format(
        "there is no option \"{}\"{}", written,
        nearest.empty() ? "; " + advice : fmt::format("; did you mean \"{}\"?", names[static_cast<std::size_t>(at)])));
}

void require_values(const std::vector<std::string>& words) {
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string& word = words[i];
        if (word.starts_with("--") && word.ends_with("="))
            throw InputError(word.substr(0, word.size() - 1), "expected a value, it is empty");
        if (!word.empty()) continue;
        throw InputError(i > 0 && is_option(words[i - 1]) ? words[i - 1] : fmt::format("argument {}", i + 1),
                         "expected a value, it is empty");
    }
}

}  // namespace

void require_command(const CLI::App& app, std::vector<std::string>& words) {
    const std::vector<std::string> names = command_names(app);
    if (words.empty())
        throw InputError(fmt::format("expected a command: {}; photonlab help says more", fmt::join(names, ", ")));
    require_values(words);
    const bool wants_help = words[0] == "help";
    if (wants_help) words.erase(words.begin());
    const auto is_command = [&](const std::string& word) {
        return std::find(names.begin(), names.end(), word) != names.end();
    };
    if (!words.empty() && !is_option(words[0]) && !is_command(words[0])) {
        std::vector<std::string_view> known(names.begin(), names.end());
        known.emplace_back("help");
        const std::string guess = did_you_mean(words[0], known);
        throw InputError(fmt::format("there is no command \"{}\"{}", words[0],
                                     guess.empty() ? fmt::format("; expected {}", fmt::join(names, ", ")) : guess));
    }
    if (!words.empty() && is_option(words[0]) && !app.get_option_no_throw(words[0]))
        refuse_option(words[0], app, "options stand behind their command");
    if (!wants_help) return;
    words.resize(std::min<std::size_t>(words.size(), 1));
    words.emplace_back("--help");
}

void require_known_options(const CLI::App& app, const std::string& command) {
    for (const CLI::App* chosen : app.get_subcommands([&](const CLI::App* one) { return one->get_name() == command; }))
        for (const std::string& word : chosen->remaining())
            if (is_option(word)) refuse_option(word, *chosen, fmt::format("photonlab help {} lists them", command));
}

}  // namespace photonlab
