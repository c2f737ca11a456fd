// What several subcommands read from the command line alike.

#pragma once

#include <CLI/CLI.hpp>

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "integrators/settings/chosen_settings.h"
#include "record/merged_records.h"
#include "render/pass_range.h"
#include "scene/scene.h"

namespace photonlab {

/// "640x480"; InputError for anything else.
Resolution parse_resolution(const std::string& text);

/// What --passes says: how many, or a range of them, of which others take the rest.
struct PassesOption {
    PassRange range;
    bool is_part = false;  ///< A..B
};

/// "64" or "17..32"; InputError for anything else.
PassesOption parse_passes(const std::string& text);

/// Values for the $names of a scene file, in place of its <default>s.
class SceneParameters {
public:
    void add_to(CLI::App& command);

    /// By name. InputError for what is not NAME=VALUE, and for a name that is given twice.
    std::map<std::string, std::string> values() const;

private:
    std::vector<std::string> texts_;
};

/// Checks of CLI11, which by itself takes numbers that are too large for the largest, and NaN for any: a whole number
/// of 64 bits; a number of seconds, finite and at least 0. Empty where it is sound.
std::string require_whole_number(const std::string& text);
std::string require_seconds(const std::string& text);

/// A message on a setting, said of its option: "alpha: expected ..." becomes "--alpha: expected ...".
std::string named_by_option(const std::string& message);

/// Runs a check of settings, whose InputErrors are then so said.
template <typename Check>
void check_options(const Check& check) {
    try {
        check();
    } catch (const InputError& error) {
        throw InputError(named_by_option(error.what()));
    }
}

/// A check of CLI11 for a folder that is to be made: it is not called as a file is. Empty where it is sound.
std::string require_folder_name(const std::string& text);

/// Says which finished runs are not in the merged records. Throws InputError where those are damaged.
void say_what_was_left_out(const MergedRecords& merged, const std::filesystem::path& records);

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
