#include "core/machine/available_memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "core/machine/control_group.h"

namespace photonlab {

namespace {

constexpr double mebibyte = 1024.0 * 1024.0;
constexpr double no_limit = std::numeric_limits<double>::infinity();

struct ProcessSize {
    double virtual_bytes = 0.0;
    double resident_bytes = 0.0;
    double data_bytes = 0.0;  // that only it can write
};

ProcessSize process_size() {
    std::ifstream stream("/proc/self/statm");
    ProcessSize pages;
    double shared = 0.0, text = 0.0, library = 0.0;
    stream >> pages.virtual_bytes >> pages.resident_bytes >> shared >> text >> library >> pages.data_bytes;
    const auto page = static_cast<double>(::sysconf(_SC_PAGESIZE));
    return {pages.virtual_bytes * page, pages.resident_bytes * page, pages.data_bytes * page};
}

double of_machine() {
    std::ifstream stream("/proc/meminfo");
    std::string name;
    double kibibytes = 0.0;
    for (std::string rest; stream >> name >> kibibytes && std::getline(stream, rest);)
        if (name == "MemAvailable:") return kibibytes * 1024.0;
    return no_limit;
}

/// What a limit of the process's own leaves of the bytes that it counts.
double of_own_limit(int resource, double used) {
    rlimit limit{};
    if (::getrlimit(static_cast<__rlimit_resource_t>(resource), &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
        return no_limit;
    return std::max(0.0, static_cast<double>(limit.rlim_cur) - used);
}

}  // namespace

AvailableMemory available_memory() {
    const ProcessSize size = process_size();
    AvailableMemory least{of_machine(), "the machine"};
    const auto compare = [&](double bytes, const std::string& limit) {
        if (bytes < least.mebibytes) least = {bytes, limit};
    };
    if (const auto left = memory_left_by_control_groups()) compare(left->bytes, "the control group " + left->group);
    compare(of_own_limit(RLIMIT_AS, size.virtual_bytes), "ulimit -v");
    compare(of_own_limit(RLIMIT_DATA, size.data_bytes), "ulimit -d");
    least.mebibytes /= mebibyte;
    return least;
}

double resident_mebibytes() {
    return process_size().resident_bytes / mebibyte;
}

std::string describe(const AvailableMemory& available) {
    return fmt::format("{:.0f} MiB are left by {}", available.mebibytes, available.limit);
}

void require_memory_for(const std::string& place, std::uint64_t bytes) {
    const double needed = static_cast<double>(bytes) / mebibyte;
    if (needed < 1.0) return;
    const AvailableMemory available = available_memory();
    if (needed > available.mebibytes)
        throw InputError(place, fmt::format("needs {:.0f} MiB of memory, and {}", needed, describe(available)));
}

}  // namespace photonlab
