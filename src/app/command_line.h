// What is wrong with a command line, said of the word that is wrong: CLI11 looks for what is missing first, and then
// knows nothing of what was meant.

#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <vector>

namespace photonlab {

/// The words of the command line, the program's name left out, with `help [COMMAND]` in the words that CLI11 knows it
/// by. Throws InputError unless they begin with a command, or with an option that stands alone; and when one is empty.
void require_command(const CLI::App& app, std::vector<std::string>& words);

/// After an error of CLI11: throws InputError if the command was given an option that it does not have.
void require_known_options(const CLI::App& app, const std::string& command);

}  // namespace photonlab
