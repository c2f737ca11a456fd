// A lock between processes: whoever holds the file's lock works on what it stands for. A process that ends, however it
// ends, gives its locks up.

#pragma once

#include <filesystem>
#include <optional>

namespace photonlab {

class FileLock {
public:
    /// Makes the file, and its folder, where needed; empty when another process holds it. Throws InputError when there
    /// can be no lock.
    static std::optional<FileLock> try_lock(const std::filesystem::path& file);

    /// Waits for it.
    static FileLock wait_for(const std::filesystem::path& file);

    FileLock(FileLock&& other) noexcept;
    FileLock& operator=(FileLock&&) = delete;

    /// Removes the file.
    ~FileLock();

private:
    FileLock(std::filesystem::path file, int descriptor) : file_(std::move(file)), descriptor_(descriptor) {}

    std::filesystem::path file_;
    int descriptor_;
};

}  // namespace photonlab
