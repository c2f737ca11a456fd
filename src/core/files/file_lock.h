// A lock between processes: whoever holds the file's lock works on what it stands for. A process that ends, however it
// ends, gives its locks up. The file is empty, and there only while somebody holds it or was killed.

#pragma once

#include <filesystem>
#include <functional>
#include <optional>

#include "core/files/descriptor.h"

namespace photonlab {

class FileLock {
public:
    /// Makes the file, and its folder, where needed; empty when another process holds it. Throws InputError when there
    /// can be no lock, or when the file holds something and so is somebody else's.
    static std::optional<FileLock> try_lock(const std::filesystem::path& file);

    /// Waits for it; empty when it was interrupted before that.
    static std::optional<FileLock> wait_for(const std::filesystem::path& file,
                                            const std::function<bool()>& is_interrupted);

    FileLock(FileLock&&) = default;
    FileLock& operator=(FileLock&&) = delete;

    /// Removes the file.
    ~FileLock();

private:
    FileLock(std::filesystem::path file, Descriptor descriptor)
        : file_(std::move(file)), descriptor_(std::move(descriptor)) {}

    std::filesystem::path file_;
    Descriptor descriptor_;
};

}  // namespace photonlab
