// How much memory the control groups leave that this process is in: its own group, and every one above it, for a limit
// binds all that is below. The kernel kills what goes beyond.
//
// /proc/self/cgroup says which group it is, by its path in a hierarchy; /proc/self/mountinfo where hierarchies are
// mounted, and from which of their groups on: in a container that is often the process's own, whatever its path says.
// Version 2 has one hierarchy (memory.max, and memory.high, beyond which a process is put to sleep), version 1 one for
// memory (memory.limit_in_bytes); a system may have both.
//
// What a group uses is counted without files that it has cached and not touched lately, which the kernel drops first
// (as Kubernetes counts a working set).

#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace photonlab {

/// What a group leaves.
struct MemoryLeft {
    double bytes = 0.0;
    std::string group;  ///< path in its hierarchy
};

/// Of the group that leaves least; empty when none has a limit. `root` is where the file system begins.
std::optional<MemoryLeft> memory_left_by_control_groups(const std::filesystem::path& root = "/");

}  // namespace photonlab
