// Hashes by which a run and a reference are recognised again: XXH3 of 128 bits, written in hexadecimal. They guard
// against mistakes, not against forgery.

#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace photonlab {

std::string hash_text(std::string_view text);

/// The hash of bytes that come in pieces: the same as of all of them at once.
class RunningHash {
public:
    RunningHash();
    ~RunningHash();
    RunningHash(RunningHash&&) noexcept;
    RunningHash& operator=(RunningHash&&) noexcept;

    void add(const void* bytes, std::size_t count);
    std::string text() const;  ///< of what was added so far

private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Throws InputError when the file cannot be read.
std::string hash_file(const std::filesystem::path& file);

}  // namespace photonlab
