// Hashes by which a run and a reference are recognised again: XXH3 of 128 bits, written in hexadecimal. They guard
// against mistakes, not against forgery.

#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace photonlab {

std::string hash_text(std::string_view text);

/// Throws InputError when the file cannot be read.
std::string hash_file(const std::filesystem::path& file);

}  // namespace photonlab
