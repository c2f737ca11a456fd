// A file that gets its name only when it is complete: it is written under a temporary name in the same folder and
// renamed at the end, so that an interrupted program or a full disk never leaves half a file under the final name,
// and a reader sees either the old file or the new one.

#pragma once

#include <unistd.h>

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
