#include "core/files/json.h"

#include <fmt/format.h>

#include "core/error.h"

namespace photonlab {

namespace {

constexpr int deepest = 64;

}  // namespace

std::string json_text(const Json& json) {
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

Json parse_json(const std::string& text) {
    try {
        return Json::parse(text, [](int depth, Json::parse_event_t, Json&) {
            if (depth > deepest)
                throw InputError(fmt::format("expected at most {} lists and objects in each other", deepest));
            return true;
        });
    } catch (const Json::exception& error) {
        throw InputError(error.what());
    }
}

std::optional<Json> parse_sound_json(const std::string& text) {
    try {
        return parse_json(text);
    } catch (const InputError&) {
        return std::nullopt;
    }
}

}  // namespace photonlab
