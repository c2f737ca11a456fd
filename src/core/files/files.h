// Files that are whole or absent: text goes to a temporary name beside its own and is renamed, so that whoever reads
// it, or is interrupted, never meets a half.

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/descriptor.h"
#include "core/files/state_archive.h"

namespace photonlab {

/// Throws InputError unless `file` is an ordinary file that can be opened. Asked before anything else opens it: a pipe
/// would wait for a writer, and a device may have no end, as may files that the kernel makes up when they are read.
void require_ordinary_file(const std::filesystem::path& file);

/// Throws InputError when it is no ordinary file, cannot be read, or has more than `largest` bytes.
std::string read_text_file(const std::filesystem::path& file, std::uintmax_t largest = std::uintmax_t{1} << 31);

/// The same; empty when there is no such file, or no longer.
std::optional<std::string> read_if_there(const std::filesystem::path& file,
                                         std::uintmax_t largest = std::uintmax_t{1} << 31);

/// True when there is a file, folder or device of this name. Throws InputError when that cannot be known: the name is
/// too long, or a folder on the way may not be looked into.
bool is_there(const std::filesystem::path& name);

/// True of a folder; false also where that cannot be known, which opening it says.
bool is_folder(const std::filesystem::path& name);

/// Its size in bytes. Throws InputError when that cannot be known.
std::uintmax_t size_of_file(const std::filesystem::path& file);

/// What is directly in a folder, in the order of names; nothing where there is none. Throws InputError when it cannot
/// be read.
std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder);

/// The same of what is no folder, at any depth.
std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder);

/// Removes the file, or the folder with all that is in it, if it is there. Throws InputError when it stays.
void remove_if_there(const std::filesystem::path& name);

/// The folder that the program was started in; empty when it is not there any more.
std::string working_directory();

/// Replaces the file by `text` at once. Throws InputError when it cannot be written.
void write_text_file(const std::filesystem::path& file, std::string_view text);

/// Makes the folder and those above it; throws InputError with its name when that fails.
void make_folder(const std::filesystem::path& folder);

/// Throws InputError unless `file` can be written, making its folder where needed: asked before hours are spent on what
/// is to go there.
void require_writable(const std::filesystem::path& file);

/// Throws InputError when `what` can take more bytes than are free on the folder's file system.
void require_space(const std::filesystem::path& folder, std::uint64_t bytes, const std::string& what);

/// A file that grows by whole pieces: of one that finds no room, nothing stays.
class AppendedFile {
public:
    /// Made, or replaced at once, by the first append().
    explicit AppendedFile(std::filesystem::path file) : file_(std::move(file)) {}

    /// Throws InputError when it cannot be written wholly, or when somebody else removed, replaced or
    /// changed the file.
    void append(std::string_view text);

    bool is_empty() const { return size_ == 0; }
    std::uint64_t size() const { return size_; }
    std::string hash() const { return hash_.text(); }  ///< of what was appended (hash.h)

    /// Saves how far the file has grown, or cuts a file that has grown since back to that. Throws InputError when it is
    /// not the same up to there.
    void exchange(StateArchive& archive);

private:
    [[noreturn]] void fail(const std::string& what) const;

    std::filesystem::path file_;
    std::optional<FileIdentity> identity_;  // of what the first append() made
    std::uint64_t size_ = 0;
    RunningHash hash_;  // of what was appended
};

}  // namespace photonlab
