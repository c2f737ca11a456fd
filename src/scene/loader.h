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

/// Reads an OBJ mesh: polygons are cut into fans, negative indices counted from the end, vertices with different normals
/// or texture coordinates kept apart. Without normals in the file, or with `face_normals`, as Mitsuba does.
MeshDescription load_obj_mesh(const std::filesystem::path& file, bool face_normals);

}  // namespace photonlab
