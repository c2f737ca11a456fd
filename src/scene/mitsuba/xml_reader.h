// The XML of a Mitsuba scene file without its meaning: includes followed, defaults and $names put in, both spellings of
// names folded into one, and every element knowing the file and line where it stands and which Mitsuba it speaks to.
// What elements mean is in scene/loader.cpp.

#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/hash.h"

namespace photonlab {

/// Which Mitsuba a file was written for, by the version in its <scene>. The two read some files differently: whoever
/// gives an element its meaning asks for its family.
enum class MitsubaFamily {
    Version06,  ///< 0.4 to 0.6
    Version3    ///< 2 and 3
};

/// A file that elements stand in.
struct SceneFile {
    std::filesystem::path folder;
    MitsubaFamily family = MitsubaFamily::Version3;
    std::vector<std::filesystem::path> search_folders;  ///< of its <path>s, in their order
    std::shared_ptr<const SceneFile> includer;          ///< null: the scene file that was asked for
};

struct XmlElement {
    std::string tag;                                ///< as written: "shape", "rgb", ...
    std::map<std::string, std::string> attributes;  ///< $names replaced; `name` in snake_case ("toWorld" is "to_world")
    std::vector<XmlElement> children;
    std::string place;                      ///< "file:line"
    std::shared_ptr<const SceneFile> file;  ///< never null

    MitsubaFamily family() const { return file->family; }

    /// The attribute's value, or "" when there is none.
    std::string attribute(std::string_view name) const;

    /// The attribute's value; InputError when there is none.
    const std::string& require(std::string_view name) const;

    /// The file that the element names: the first that exists in the folders of <path>s (the last one first), the
    /// scene's folder, and its own file's.
    std::filesystem::path file_called(const std::string& name) const;
};

/// What a scene was read from: all bytes of the scene file and of those that it names, in the order of reading.
struct BytesRead {
    RunningHash hash;
    std::uintmax_t size = 0;

    void add(std::string_view bytes) {
        hash.add(bytes.data(), bytes.size());
        size += bytes.size();
    }
};

/// Reads `file` and what it includes. Returns its <scene>, the children of included scenes in place of each <include>,
/// <default>s removed, and of <path>s those left whose folder is not there. `parameters` replace the values of
/// defaults. Every byte read is added to `bytes_read`.
XmlElement read_scene_xml(const std::filesystem::path& file, const std::map<std::string, std::string>& parameters,
                          BytesRead& bytes_read);

/// Whole file as text; InputError at `place` when it cannot be read or is larger than 2 GiB.
std::string read_whole_file(const std::filesystem::path& file, const std::string& place);

/// A file that a scene names, which is also added to `bytes_read`: all of them together have at most 2 GiB, for a
/// small scene can name a large file any number of times. InputError at `place`.
std::string read_part(const std::filesystem::path& file, const std::string& place, BytesRead& bytes_read);

/// For messages: the first line, and of a long one its beginning.
std::string excerpt(std::string_view text);

// Values. Each throws InputError at `place` unless the whole text is one.

double parse_number(std::string_view text, const std::string& place);
long parse_integer(std::string_view text, const std::string& place);
bool parse_boolean(std::string_view text, const std::string& place);

/// Numbers separated by white space or commas.
std::vector<double> parse_numbers(std::string_view text, const std::string& place);

}  // namespace photonlab
