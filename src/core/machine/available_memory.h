// How much memory this process can still have: the least of what the machine has available, what the control groups
// that the process is in leave (control_group.h), and what its own limits do, `ulimit -v` (addresses) and `ulimit -d`
// (data). Asked before much is allocated, so that what does not fit is refused by name: beyond some of these limits the
// kernel ends the program without a word.

#pragma once

#include <cstdint>
#include <string>

namespace photonlab {

struct AvailableMemory {
    double mebibytes = 0.0;
    std::string limit;  ///< what leaves no more: "the machine", "the control group /a", "ulimit -v", "ulimit -d"
};

AvailableMemory available_memory();

/// What the process holds now.
double resident_mebibytes();

/// "812 MiB are left by ulimit -v".
std::string describe(const AvailableMemory& available);

/// Throws InputError, said of `place`, when that many bytes more cannot be had. Little is not asked for: less than a
/// mebibyte.
void require_memory_for(const std::string& place, std::uint64_t bytes);

}  // namespace photonlab
