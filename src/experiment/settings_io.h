// How the settings of a method are written and read: one table of the fields of MethodSettings, from which experiment
// files, the command line, run.json, image metadata and the columns of the records are all made, so that they cannot
// disagree.

#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "experiment/json.h"
#include "integrators/settings.h"

namespace photonlab {

/// A value as an experiment file or the command line gives it.
using SettingValue = std::variant<bool, std::int64_t, double, std::string>;

/// One field of MethodSettings.
struct SettingField {
    std::string_view name;     ///< in experiment files and records
    std::string_view option;   ///< on the command line
    std::string_view meaning;  ///< one line of help, with range and unit
    Json (*write)(const MethodSettings&);
    /// Sets the field called `name`; throws InputError when the value is of another type.
    void (*read)(std::string_view name, MethodSettings&, const SettingValue&);
};

/// In the order of MethodSettings; a field stands after those that decide whether it is used.
const std::vector<SettingField>& setting_fields();

/// nullptr when there is none of that name.
const SettingField* find_setting_field(std::string_view name);

/// What the command line gives: an integer, a number or a word.
SettingValue parse_setting_value(std::string_view text);

/// As a person would type it: `0.7`, `"disc"`.
std::string describe(const SettingValue& value);

/// A JSON scalar as plain text: a string without its quotes, a number with the fewest digits that read back the same,
/// nothing for null.
std::string plain_text(const Json& scalar);

/// The field's value as text; empty when the method does not use it.
std::string setting_text(const MethodSettings& settings, const SettingField& field);

/// Every field by name; null where the method does not use it.
Json settings_json(const MethodSettings& settings);

/// Settings and which of them somebody chose; the others are defaults.
struct ChosenSettings {
    MethodSettings values;
    std::set<std::string, std::less<>> given;
};

/// Sets a field and remembers that it was given.
void choose(ChosenSettings& settings, const SettingField& field, const SettingValue& value);

/// Throws InputError when a setting was given that the method does not use: it would change nothing, silently.
void require_used(const ChosenSettings& settings, const SettingField& field);

/// The settings for a scene: max_depth is the scene file's own unless it was given.
MethodSettings resolve(const ChosenSettings& settings, int scene_max_depth);

}  // namespace photonlab
