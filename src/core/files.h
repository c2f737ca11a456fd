// Files that are whole or absent: text goes to a temporary name beside its own and is renamed, so that whoever reads
// it, or is interrupted, never meets a half.

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace photonlab {

/// Throws InputError when the file cannot be read.
std::string read_text_file(const std::filesystem::path& file);

/// Replaces the file by `text` at once. Throws InputError when it cannot be written.
void write_text_file(const std::filesystem::path& file, std::string_view text);

/// Makes the folder and those above it; throws InputError with its name when that fails.
void make_folder(const std::filesystem::path& folder);

/// Throws InputError unless `file` can be written, making its folder where needed: asked before hours are spent on what
/// is to go there.
void require_writable(const std::filesystem::path& file);

}  // namespace photonlab
