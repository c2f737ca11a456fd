// The subcommands. Each adds itself to the command line, with what is to be called when the user chose it.

#pragma once

#include <CLI/CLI.hpp>

namespace photonlab {

void add_render_command(CLI::App& app);
void add_run_command(CLI::App& app);
void add_reference_command(CLI::App& app);
void add_compare_command(CLI::App& app);
void add_info_command(CLI::App& app);
void add_verify_command(CLI::App& app);

}  // namespace photonlab
