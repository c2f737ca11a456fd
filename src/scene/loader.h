// Reads Mitsuba XML, the format in which the field's scenes come, with Mitsuba's semantics.

#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "scene/description.h"

namespace photonlab {

/// Reads a scene file and the files it names. Throws InputError with file and line for anything unknown, out of range
/// or missing. `parameters` are values for the file's $names, in place of its <default>s.
SceneDescription load_scene_file(const std::filesystem::path& file,
                                 const std::map<std::string, std::string>& parameters = {});

}  // namespace photonlab
