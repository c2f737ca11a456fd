// Settings that somebody chose, and which of them: the others are defaults.

#pragma once

#include <set>
#include <string>

#include "integrators/settings/settings_table.h"

namespace photonlab {

struct ChosenSettings {
    MethodSettings values;
    std::set<std::string, std::less<>> given;  ///< names
};

/// Sets a field and remembers that it was given. Throws InputError when the value is of another type.
void choose(ChosenSettings& settings, const SettingField& field, const SettingValue& value);

/// Throws InputError when a setting was given that the method does not use: it would change nothing, silently.
void require_used(const ChosenSettings& settings, const SettingField& field);

/// The settings for a scene: max_depth is the scene file's own unless it was given.
MethodSettings resolve(const ChosenSettings& settings, int scene_max_depth);

/// The field's value as text; empty when the method does not use it.
std::string setting_text(const MethodSettings& settings, const SettingField& field);

}  // namespace photonlab
