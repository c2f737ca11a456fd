#include <fmt/format.h>
#include <fmt/ranges.h>

#include "app/commands/commands.h"
#include "app/pages/pages.h"
#include "integrators/registry.h"
#include "integrators/settings/settings_table.h"

namespace photonlab {

namespace {

std::vector<std::string> options_of(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::Option* option : command.get_options()) {
        for (const std::string& name : option->get_snames()) names.push_back("-" + name);
        for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
    }
    return names;
}

/// What an option can be, where that is a choice; nothing for all others.
std::vector<std::string_view> choices_of(const SettingField& field) {
    return field.name == "integrator" ? users_of(field.name) : field.choices;
}

}  // namespace

std::string bash_completion(const CLI::App& app) {
    std::vector<std::string> commands;
    std::string options, values;
    for (const CLI::App* command : app.get_subcommands({})) {
        commands.push_back(command->get_name());
        options +=
            fmt::format("        {}) words=\"{}\" ;;\n", command->get_name(), fmt::join(options_of(*command), " "));
    }
    for (const SettingField& field : setting_fields())
        if (const auto choices = choices_of(field); !choices.empty())
            values += fmt::format("        {}) words=\"{}\" ;;\n", field.option, fmt::join(choices, " "));
    return fmt::format(R"(# Completion of photonlab for bash: commands, options, what settings can be; files elsewhere.
_photonlab() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD - 1]}} words=
    if ((COMP_CWORD == 1)); then
        words="{} help"
    elif [[ $COMP_CWORD == 2 && $before == help ]]; then
        words="{}"
    elif [[ $COMP_CWORD == 2 && $before == figure ]]; then
        words="{}"
    elif [[ $word == -* ]]; then
        case ${{COMP_WORDS[1]}} in
{}        esac
    else
        case $before in
{}        esac
    fi
    [[ -z $words ]] || mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}}
complete -o default -F _photonlab photonlab
)",
                       fmt::join(commands, " "), fmt::join(commands, " "), fmt::join(kinds_of_figures(), " "), options,
                       values);
}

}  // namespace photonlab
