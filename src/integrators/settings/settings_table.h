// The one table of settings. A line says of a field of MethodSettings what it is called, what it can be, and when it
// matters; experiment files, the command line, run.json, image metadata, the columns of the records, what the analysis
// calls it and the manual are all made from it, so that they cannot disagree.
//
// Adding a setting: a field of MethodSettings with its default, a line here, and its name in the list of each
// integrator that uses it.

#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "integrators/settings/settings.h"

namespace photonlab {

/// A value as an experiment file or the command line gives it, and as the records show it.
using SettingValue = std::variant<bool, std::int64_t, double, std::string>;

/// What the command line gives: an integer, a number or a word.
SettingValue parse_setting_value(std::string_view text);

/// As a person would type it: `0.7`, `"disc"`.
std::string describe(const SettingValue& value);

/// As a table has it: a text without quotes, a number with the fewest digits that read back the same.
std::string plain_text(const SettingValue& value);

/// The numbers that a setting can be.
struct Range {
    double least = -std::numeric_limits<double>::max();
    double most = std::numeric_limits<double>::max();
    bool has_least = true;                                    ///< false: above it
    std::string_view also = "";                               ///< one more number, and what it means: "-1 (unlimited)"
    double other = std::numeric_limits<double>::quiet_NaN();  ///< that number

    bool holds(double number) const;
};

/// "a number in (0, 1]", "at least 2", "from 1e-12 to 1".
std::string describe(const Range& range);

struct SettingField {
    std::string_view name;    ///< in experiment files and records
    std::string_view option;  ///< on the command line
    std::string_view unit = "";
    std::string_view label = "";                ///< how figures name it; empty: its values say what it is
    std::string_view meaning;                   ///< for --help and the manual; `max_radius` in it names another setting
    std::optional<Range> range = std::nullopt;  ///< of numbers; lengths are all above 0
    std::string_view default_words = "";        ///< where the default is no value of its own: "the scene file's"
    /// False where it changes nothing, given the other settings of an integrator that uses it.
    bool (*applies)(const MethodSettings&) = [](const MethodSettings&) { return true; };

    // What follows from the type of the field.
    enum class Type { Text, Integer, Number, Length } type = Type::Text;
    std::vector<std::string_view> choices = {};  ///< that it can be; empty: not a choice
    SettingValue (*get)(const MethodSettings&) = nullptr;
    /// Throws InputError when the value is of another type.
    void (*set)(const SettingField&, MethodSettings&, const SettingValue&) = nullptr;
};

/// In the order of MethodSettings; a setting stands after those that decide whether it applies.
const std::vector<SettingField>& setting_fields();

/// nullptr when there is none of that name.
const SettingField* find_setting_field(std::string_view name);

/// As a table shows it: 0.7, auto, the scene file's.
std::string default_of(const SettingField& field);

/// What it can be, as a message or a table says it; empty where any name is taken.
std::string describe_values(const SettingField& field);

/// Throws InputError when the field's value is out of its range.
void require_in_range(const SettingField& field, const MethodSettings& settings);

}  // namespace photonlab
