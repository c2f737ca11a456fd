#include "record/run/settings_json.h"

#include "integrators/registry.h"
#include "integrators/settings/settings_table.h"

namespace photonlab {

Json settings_json(const MethodSettings& settings) {
    Json json = Json::object();
    for (const SettingField& field : setting_fields())
        json[std::string(field.name)] =
            uses_setting(settings, field.name)
                ? std::visit([](const auto& value) { return Json(value); }, field.get(settings))
                : Json();
    return json;
}

}  // namespace photonlab
