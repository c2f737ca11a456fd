#include "core/machine/processors.h"

#include <sched.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>
#include <thread>

namespace photonlab {

namespace {

/// [sbatch(1), OUTPUT ENVIRONMENT VARIABLES: set where --cpus-per-task was given]
std::optional<int> processors_of_job() {
    const char* given = std::getenv("SLURM_CPUS_PER_TASK");
    if (!given) return std::nullopt;
    const std::string_view text(given);
    int count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc() || end != text.data() + text.size() || count < 1) return std::nullopt;
    return count;
}

/// Empty where the kernel has more processors than a cpu_set_t has bits.
std::optional<int> processors_of_mask() {
    cpu_set_t mask;
    if (sched_getaffinity(0, sizeof(mask), &mask) != 0) return std::nullopt;
    return std::max(1, CPU_COUNT(&mask));
}

}  // namespace

int usable_processors() {
    if (const auto of_job = processors_of_job()) return *of_job;
    if (const auto of_mask = processors_of_mask()) return *of_mask;
    return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
}

}  // namespace photonlab
