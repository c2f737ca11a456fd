// What the fuzz targets share: a folder for the file that is tried, and what a loader may do with it. It may read it,
// or refuse it by an InputError. Anything else that it throws ends the target, as does whatever a sanitizer finds.

#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

#include "core/error.h"

namespace photonlab::fuzz {

/// A folder of this process's own, in memory where there is such a file system.
class Folder {
public:
    Folder() {
        const std::filesystem::path memory = "/dev/shm";
        const bool has_memory = ::access(memory.c_str(), W_OK) == 0;
        folder_ = (has_memory ? memory : std::filesystem::temp_directory_path()) /
                  ("photonlab-fuzz-" + std::to_string(::getpid()));
        std::filesystem::create_directories(folder_);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    ~Folder() { std::filesystem::remove_all(folder_); }

    const std::filesystem::path& path() const { return folder_; }

    std::filesystem::path write(const std::string& name, std::string_view bytes) const {
        std::ofstream stream(folder_ / name, std::ios::binary | std::ios::trunc);
        stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
        return folder_ / name;
    }

private:
    std::filesystem::path folder_;
};

inline std::string_view text_of(const std::uint8_t* data, std::size_t size) {
    return {reinterpret_cast<const char*>(data), size};
}

template <typename Read>
void read_or_refuse(const Read& read) {
    try {
        read();
    } catch (const InputError&) {
    }
}

}  // namespace photonlab::fuzz
