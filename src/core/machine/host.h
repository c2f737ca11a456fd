// Where this process is at work: what a lock and a record say of it.

#pragma once

#include <string>

namespace photonlab {

/// As the machine, or the container, calls itself.
std::string host_name();

/// Of the kernel that runs, since it began: the same in all containers of a machine and on no other. The name of the
/// host where there is none.
std::string boot_id();

/// "AMD EPYC 7763 64-Core Processor"; "unknown" where the system does not say.
std::string processor_name();

/// The job of Slurm that this process is part of, as squeue shows it: "4711", of an array "4711_12"; empty outside.
std::string slurm_job();

}  // namespace photonlab
