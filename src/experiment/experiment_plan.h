// What an experiment will make, before it makes any of it: which runs, which of them are finished, which go together,
// and what memory they take. Scenes, settings, regions and references that do not fit are refused here.

#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/files/kept_files.h"
#include "experiment/file/experiment_file.h"
#include "experiment/run_group.h"
#include "reference/reference.h"
#include "render/estimates/memory.h"
#include "scene/scene.h"

namespace photonlab {

/// Which runs are asked for; all where nothing is said.
struct RunSelection {
    std::optional<std::string> name = std::nullopt;  ///< or a shell pattern
    std::optional<GroupRange> groups = std::nullopt;
};

struct PreparedExperiment {
    std::vector<std::optional<Scene>> scenes;  ///< by index of Experiment::scenes; only those that a selected run needs
    std::vector<PreparedRun> runs;             ///< the selected ones
    std::vector<std::string> faults;           ///< of what had finished and is made again, one line each
};

/// Loads scenes and checks references of the runs that are selected, and looks at the files of no others. Throws
/// InputError before anything is run or written, also when the results folder is not the experiment's. How closely
/// the files of finished runs are looked at is `check`. `experiment` must outlive the result, and stay where it is.
PreparedExperiment prepare_experiment(const Experiment& experiment, const std::filesystem::path& results,
                                      const RunSelection& selection = {}, Check check = Check::Records);

/// All runs of an experiment, none of which is looked at: they are not `finished`, whether they are or not.
PreparedExperiment prepare_all_keys(const Experiment& experiment, const std::filesystem::path& results);

/// True when the run finished with its key, its files are as they were then, and the ensemble has its images.
bool is_made(const Experiment& experiment, const PreparedRun& run, const std::filesystem::path& results);

/// Everything that changes what the runs of a point record, but their seed: so neither threads nor the title.
std::string point_key(const Experiment& experiment, const ExperimentPoint& point, const RunSettings& settings,
                      const Scene& scene, const std::string& reference_key);

/// By which a finished run is recognised.
std::string run_key(const std::string& point_key, const ExperimentRun& run);

/// The settings of a run on its scene.
RunSettings settings_of(const Experiment& experiment, const ExperimentRun& run, const Scene& scene);

/// What a reference of the scene must be of.
ReferenceSubject subject_of(const Scene& scene, int samples_per_pixel, const MethodSettings& method);

/// Most runs of a group: each has a lock while it is made, which is an open file, and many systems allow 1024.
inline constexpr std::size_t most_runs_together = 256;

/// Runs that share their photons and hit points; never empty.
using RunsTogether = std::vector<const PreparedRun*>;

/// Whether two runs of one scene can.
using RunsFit = std::function<bool(const RunSettings&, const RunSettings&)>;

/// What is not finished, in groups. They are in the order that they would have if nothing was finished, whatever is:
/// sums over seeds then go into the same slots.
std::vector<RunsTogether> runs_together(const std::vector<PreparedRun>& runs, const RunsFit& fit = can_run_together);

struct GroupMemory {
    std::string first_run;
    MemoryEstimate estimate;
};

/// Of the group that takes most; empty without groups. Seeds do not change it.
std::optional<GroupMemory> largest_memory(const Experiment& experiment, const PreparedExperiment& prepared,
                                          const std::vector<RunsTogether>& groups);

}  // namespace photonlab
