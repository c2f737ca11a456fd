// Whose a results folder is. RESULTS/experiment.json names its experiment, and is the first file that goes into it:
//
//     {"schema": 1, "experiment": "alpha-study", "smoke": false, "title": ..., "file": ..., "program": ...,
//      "checksum": "..."}                                                                     kept_files.h
//
// A folder without it, as earlier programs left them, is an experiment's when all that is called as results are says
// so. What is there under such a name and is nobody's results is refused: it is never replaced.

#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "experiment/file/experiment_file.h"

namespace photonlab {

/// Throws InputError when the folder is another experiment's, or this one's in small or at full size when it is not run
/// so, or holds files of somebody else under the names of results. Writes nothing.
void require_own_results(const Experiment& experiment, const std::filesystem::path& results);

/// The same, and writes experiment.json where it is not as it should be. For whoever holds the folder's lock.
void claim_results(const Experiment& experiment, const std::filesystem::path& results);

/// Whether experiment.json is as it should be: then there is nothing for claim_results() to write.
bool is_claimed(const Experiment& experiment, const std::filesystem::path& results);

/// The experiment that a folder names; empty when experiment.json is not there or damaged.
std::optional<std::string> experiment_of_results(const std::filesystem::path& results);

/// The experiment that a folder is of, read from the file that it names, or from `file` where that has moved. Throws
/// InputError when it cannot be.
Experiment read_experiment_of_results(const std::filesystem::path& results,
                                      const std::optional<std::filesystem::path>& file = std::nullopt);

}  // namespace photonlab
