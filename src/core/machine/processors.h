// How many threads a program should start where nobody says.

#pragma once

namespace photonlab {

/// What Slurm gives the job (SLURM_CPUS_PER_TASK), else what this process may run on (its affinity mask, which
/// containers and batch systems set), else what the machine has. At least 1.
int usable_processors();

}  // namespace photonlab
