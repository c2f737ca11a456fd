// How many threads a program should start where nobody says.

#pragma once

namespace photonlab {

/// What Slurm gives the job (SLURM_CPUS_PER_TASK), else what this process may run on when it begins (its
/// affinity mask, as cpusets and taskset make it; not a quota of time). At least 1.
int usable_processors();

}  // namespace photonlab
