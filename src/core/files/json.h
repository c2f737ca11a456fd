// JSON: what the program writes of itself, and what it reads of it again.

#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace photonlab {

using Json = nlohmann::ordered_json;

/// Its text, two blanks a level. Names of files need not be UTF-8, which JSON is: what is none becomes U+FFFD.
std::string json_text(const Json& json);

/// Throws InputError when the text is no JSON, or has more in each other than anything that is written here: the
/// library copies by recursion.
Json parse_json(const std::string& text);

/// The same; empty for what parse_json() refuses.
std::optional<Json> parse_sound_json(const std::string& text);

}  // namespace photonlab
