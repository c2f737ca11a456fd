// A file that gets its name only when it is complete and on the disk: it is written under a temporary name in the same
// folder and renamed at the end, so that an interrupted program, a full disk or a power cut never leaves half a file
// under the final name, and a reader sees either the old file or the new one.

#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <string>
#include <system_error>

#include "core/error.h"

namespace photonlab {

class TemporaryFile {
public:
    explicit TemporaryFile(const std::filesystem::path& final_name)
        : final_name_(final_name), path_(final_name.string() + ".partial-" + std::to_string(::getpid())) {}

    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    ~TemporaryFile() {
        std::error_code ignored;
        if (!renamed_) std::filesystem::remove(path_, ignored);
    }

    /// Where to write until `rename`.
    const std::filesystem::path& path() const { return path_; }

    /// Gives the complete file its final name, in place of a file that had it. Throws InputError.
    void rename() {
        const int descriptor = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
        const bool is_on_disk = descriptor >= 0 && ::fsync(descriptor) == 0;
        const int reason = errno;
        if (descriptor >= 0) ::close(descriptor);
        if (!is_on_disk)
            throw InputError(final_name_.string(), std::string("cannot be written: ") + std::strerror(reason));
        std::error_code error;
        std::filesystem::rename(path_, final_name_, error);
        if (error) throw InputError(final_name_.string(), "cannot be written: " + error.message());
        renamed_ = true;
    }

private:
    std::filesystem::path final_name_;
    std::filesystem::path path_;
    bool renamed_ = false;
};

}  // namespace photonlab
