// The subcommands. Each adds itself to the command line, with what is to be called when the user chose it.

#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace photonlab {

/// All of them, in the order of the help.
void add_commands(CLI::App& app);

void add_render_command(CLI::App& app);
void add_run_command(CLI::App& app);
void add_join_command(CLI::App& app);
void add_reference_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_merge_command(CLI::App& app);
void add_verify_command(CLI::App& app);
void add_new_command(CLI::App& app);

/// `analyse` and `figure`, whose words are the analysis's to read: what is added is their help alone.
void add_analysis_commands(CLI::App& app);

/// True of the words of a command line that are for the analysis.
bool are_for_analysis(const std::vector<std::string>& words);

/// Goes on as the Python program of the analysis, with these words. Throws InputError when there is no Python here that
/// has what it needs.
[[noreturn]] void start_analysis(const std::vector<std::string>& words);

/// What `figure` can draw.
std::vector<std::string> kinds_of_figures();

}  // namespace photonlab
