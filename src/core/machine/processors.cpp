#include "core/machine/processors.h"

#include <omp.h>

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <optional>
#include <string_view>

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

}  // namespace

int usable_processors() {
    if (const auto of_job = processors_of_job()) return *of_job;
    return std::max(1, omp_get_num_procs());
}

}  // namespace photonlab
