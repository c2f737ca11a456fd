// Whether a results folder is what was written: every file of every run, every sum over seeds, the merged records and
// that their rows are those of the runs, and the references that runs name. Nothing is written.
//
// What a run left is a fault where it is missing, changed, or somebody else's. Runs that are not finished, finished
// ones whose rows are not merged (of what an experiment had before it was changed) and references that are elsewhere
// are no faults, and noted.

#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

namespace photonlab {

struct Verification {
    std::vector<std::string> faults;  ///< one line each, which begins with the file's name
    std::vector<std::string> notes;   ///< the same of what is no fault
    std::size_t runs = 0;             ///< that are finished
    std::size_t sums = 0;             ///< slots of ensembles
    std::size_t files = 0;            ///< that were read and are what was written
};

/// Throws InputError when the folder holds no results.
Verification verify_results(const std::filesystem::path& results);

}  // namespace photonlab
