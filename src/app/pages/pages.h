// What stands beside the installed program and follows from its command line.

#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace photonlab {

/// A man page of section 1, in roff: every command with every option, as --help has them.
std::string manual_page(const CLI::App& app);

/// A script for bash that completes commands, their options, what settings can be, kinds of figures, and files.
std::string bash_completion(const CLI::App& app);

}  // namespace photonlab
