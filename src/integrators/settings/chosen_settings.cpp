#include "integrators/settings/chosen_settings.h"

#include <fmt/format.h>

#include "integrators/registry.h"

namespace photonlab {

void choose(ChosenSettings& settings, const SettingField& field, const SettingValue& value) {
    field.set(field, settings.values, value);
    settings.given.emplace(field.name);
}

void require_used(const ChosenSettings& settings, const SettingField& field) {
    if (uses_setting(settings.values, field.name)) return;
    std::string used;
    for (const SettingField& other : setting_fields())
        if (uses_setting(settings.values, other.name)) used += (used.empty() ? "" : ", ") + std::string(other.name);
    throw InputError(fmt::format("{} is not used by integrator \"{}\" with its other settings; used here: {}",
                                 field.name, settings.values.integrator, used));
}

MethodSettings resolve(const ChosenSettings& settings, int scene_max_depth) {
    MethodSettings resolved = settings.values;
    if (!settings.given.contains("max_depth")) resolved.max_depth = scene_max_depth;
    return resolved;
}

std::string setting_text(const MethodSettings& settings, const SettingField& field) {
    return uses_setting(settings, field.name) ? plain_text(field.get(settings)) : "";
}

}  // namespace photonlab
