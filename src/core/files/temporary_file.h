// A file that gets its name only when it is complete and on the disk: it is written under a temporary name in the same
// folder and renamed at the end, so that an interrupted program, a full disk or a power cut never leaves half a file
// under the final name, and a reader sees either the old file or the new one.
//
// Temporary names are random, and a file is made under one only where there was none, so that processes which know
// nothing of each other (in other containers, on other machines) never write into one file. Who makes it holds a lock
// on it: one that nobody holds was left by a process that was killed, and whoever comes next removes it.

#pragma once

#include <filesystem>

#include "core/files/descriptor.h"

namespace photonlab {

class TemporaryFile {
public:
    /// Makes the file, empty, and removes what killed processes left in its folder. Throws InputError.
    explicit TemporaryFile(const std::filesystem::path& final_name);
    ~TemporaryFile();
    TemporaryFile(const TemporaryFile&) = delete;
    TemporaryFile& operator=(const TemporaryFile&) = delete;

    /// Where to write until `rename`: by name, or to the file as it is open.
    const std::filesystem::path& path() const { return path_; }
    const Descriptor& descriptor() const { return descriptor_; }

    /// Gives the complete file its final name, in place of a file that had it. Throws InputError.
    void rename();

private:
    std::filesystem::path final_name_;
    std::filesystem::path path_;
    Descriptor descriptor_;
    bool renamed_ = false;
};

/// Removes the temporary files in a folder that no process is writing.
void remove_leftovers(const std::filesystem::path& folder);

}  // namespace photonlab
