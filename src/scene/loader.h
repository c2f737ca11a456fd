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

/// Reads an OBJ mesh: all its objects as one, polygons cut into fans around their first corner as in Mitsuba, vertices
/// with different normals or texture coordinates kept apart. With `face_normals` there are no vertex normals; otherwise
/// they are the file's, or computed as Mitsuba does when any corner has none. Texture coordinates are the file's, v up,
/// and left out when any corner has none.
MeshDescription load_obj_mesh(const std::filesystem::path& file, bool face_normals);

}  // namespace photonlab
