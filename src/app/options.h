// What several subcommands read from the command line alike.

#pragma once

#include <CLI/CLI.hpp>

#include <map>
#include <optional>
#include <string>

#include "experiment/settings_io.h"
#include "scene/scene.h"

namespace photonlab {

/// "640x480"; InputError for anything else.
Resolution parse_resolution(const std::string& text);

/// Options of the settings of a method, one for each field, in a group of their own.
class MethodOptions {
public:
    void add_to(CLI::App& command);

    /// What was given, each checked for its range and for being used by the integrator.
    ChosenSettings settings() const;

private:
    std::map<std::string, std::string, std::less<>> texts_;  // by field; empty: not given
};

}  // namespace photonlab
