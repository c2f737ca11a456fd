// The files that a command is asked to write, and what is asked of their names before hours are spent.

#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace photonlab {

/// A kind of file that commands write: what is written is what the name says.
struct FileKind {
    std::string_view name;
    std::string_view extension;  ///< in any case
    std::string_view option;     ///< of `render`, that writes it
    std::string_view begins;     ///< how such a file does
};
inline constexpr FileKind file_kinds[] = {{"OpenEXR", ".exr", "-o", "\x76\x2f\x31\x01"},
                                          {"PNG", ".png", "--png", "\x89PNG"},
                                          {"CSV", ".csv", "--csv", "schema,"},
                                          {"PLY", ".ply", "--photons-out", "ply\n"}};

/// The kind that a name ends as; nullptr for none.
const FileKind* kind_named(const std::string& name);

/// What is read of a reference, which is a folder or an EXR; nothing where its name is empty.
std::vector<std::filesystem::path> files_of_reference(const std::filesystem::path& reference);

/// A file that is to be written.
struct WrittenFile {
    std::string option;  ///< that asks for it
    std::filesystem::path file;
    const FileKind* kind;  ///< nullptr: a state, or what belongs to another file
};

/// Throws InputError where one of them cannot have its name: no file can, or it is one of the inputs, or is written
/// twice, or is a file of another kind, such as a mesh of the scene, or ends as another kind does; or where it cannot
/// be written.
void require_sound_outputs(const std::vector<std::filesystem::path>& inputs, const std::vector<WrittenFile>& written);

}  // namespace photonlab
