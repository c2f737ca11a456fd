// What an experiment will make, before it makes any of it: which runs, which of them are finished, which go together,
// and what they take. Scenes, settings, regions and references that do not fit are refused here.

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment_file.h"
#include "experiment/memory.h"
#include "experiment/reference.h"
#include "experiment/run_group.h"
#include "scene/scene.h"

namespace photonlab {

struct PreparedExperiment {
    std::vector<std::optional<Scene>> scenes;  ///< by index of Experiment::scenes; only those that a selected run needs
    std::vector<PreparedRun> runs;             ///< the selected ones
};

/// Loads scenes and checks references for the runs whose name matches `only` (a shell pattern; empty: all). Throws
/// InputError before anything is run or written, also when the results folder is not the experiment's. `experiment`
/// must outlive the result.
PreparedExperiment prepare_experiment(const Experiment& experiment, const std::filesystem::path& results,
                                      const std::optional<std::string>& only = std::nullopt);

/// The same of these runs, whosever the folder is.
PreparedExperiment prepare_runs(const Experiment& experiment, const std::filesystem::path& results,
                                const std::vector<const ExperimentRun*>& runs);

/// True when the folder holds a run that finished with this key, and its records are as they were then.
bool is_finished(const std::filesystem::path& folder, const std::string& key);

/// The same, and that the ensemble has the run's images.
bool is_made(const Experiment& experiment, const PreparedRun& run, const std::filesystem::path& results);

/// What a reference of the scene must be of.
ReferenceSubject subject_of(const Scene& scene, int samples_per_pixel, int max_depth);

/// Runs that share their photons and hit points; never empty.
using RunsTogether = std::vector<const PreparedRun*>;

/// What is not finished, in groups. They are in the order that they would have if nothing was finished, whatever is:
/// sums over seeds then go into the same slots.
std::vector<RunsTogether> runs_together(const std::vector<PreparedRun>& runs);

struct GroupMemory {
    std::string first_run;
    MemoryEstimate estimate;
};

/// Of the group that takes most; empty without groups. Seeds do not change it.
std::optional<GroupMemory> largest_memory(const Experiment& experiment, const PreparedExperiment& prepared,
                                          const std::vector<RunsTogether>& groups);

/// One line a run: name, estimated time and memory, or that it is finished; then the sums.
std::string list_runs(const Experiment& experiment, const PreparedExperiment& prepared);

}  // namespace photonlab
