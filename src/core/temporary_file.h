// A file that gets its name only when it is complete and on the disk: it is written under a temporary name in the same
// folder and renamed at the end, so that an interrupted program, a full disk or a power cut never leaves half a file
// under the final name, and a reader sees either the old file or the new one.

#pragma once

#include <filesystem>

namespace photonlab {

class TemporaryFile {
public:
    /// Removes what processes that were killed left of the same file.
    explicit TemporaryFile(const std::filesystem::path& final_name);
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    /// Where to write until `rename`.
    const std::filesystem::path& path() const { return path_; }

    /// Gives the complete file its final name, in place of a file that had it. Throws InputError.
    void rename();

private:
    std::filesystem::path final_name_;
    std::filesystem::path path_;
    bool renamed_ = false;
};

/// Removes what processes that were killed left of a file under its temporary names.
void remove_leftovers(const std::filesystem::path& final_name);

}  // namespace photonlab
