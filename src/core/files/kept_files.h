// How a results folder knows its own files again, long after they were written: by their size and by the hash of their
// bytes (core/hash.h), which are written down where the files are named; and what is written down carries its own.
//
//     "files": {"iterations.csv": {"bytes": 5120, "hash": "0123456789abcdef0123456789abcdef"}, ...}
//
// A JSON file that says so ends with its checksum, the hash of every byte before the comma that precedes it:
//
//     {...,
//       "checksum": "0123456789abcdef0123456789abcdef"
//     }
//
// Who lists runs looks at sizes alone; who merges or draws checks the bytes that it reads; `photonlab verify` checks
// all of them.

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/files/json.h"

namespace photonlab {

/// A file as it was written.
struct FileStamp {
    std::uint64_t bytes = 0;
    std::string hash;

    bool operator==(const FileStamp&) const = default;
};

/// Of the file as it is. Throws InputError when it cannot be read.
FileStamp stamp_of(const std::filesystem::path& file);

FileStamp stamp_of_text(const std::string& text);

Json stamp_json(const FileStamp& stamp);

/// Empty unless it is {"bytes": ..., "hash": ...}.
std::optional<FileStamp> stamp_from(const Json& json);

/// How closely files are looked at. By Records, those that are merged, which are CSV, are read.
enum class Check { Sizes, Records, Everything };

/// What is wrong with a file, beginning with its name, or nothing: it is not there, cannot be read, or is not what it
/// was when its stamp was taken.
std::optional<std::string> fault_of(const std::filesystem::path& file, const FileStamp& stamp, Check check);

/// The same of a text that was read from the file.
std::optional<std::string> fault_of_text(const std::filesystem::path& file, const std::string& text,
                                         const FileStamp& stamp);

/// The text of a JSON object with its checksum. The object must not have a member "checksum".
std::string with_checksum(const Json& json);

/// The object of a text with its checksum, without that; empty when it is damaged or none.
std::optional<Json> checked_json(const std::string& text);

}  // namespace photonlab
