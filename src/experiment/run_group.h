// Runs of one scene that share their photons, made side by side, each into a folder of its own (experiment_runs.h).
//
// A run's checkpoint is its own, whoever it shares photons with: a group that was cut between two saves, or that is
// put together differently the next time, goes on from several passes. What a run writes is repeated to the bit from
// its checkpoint on: rows are cut back to it, snapshots replaced, and the ensemble is added to last of all.

#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/file_lock.h"
#include "experiment/checkpoint.h"
#include "experiment/ensemble.h"
#include "experiment/experiment_file.h"
#include "experiment/reference.h"
#include "render/run_methods.h"
#include "scene/scene.h"
#include "transport/camera_pass.h"

namespace photonlab {

/// A run that is ready to start: its scene is there, its reference fits.
struct PreparedRun {
    const ExperimentRun* run = nullptr;
    RunSettings settings;
    std::string key;
    std::string point_key;  ///< the same without the seed
    std::string reference_key;  ///< empty without a reference
    std::filesystem::path folder;
    bool finished = false;  ///< with this key
};

struct ContinuationOptions {
    double seconds_between_saves = default_seconds_between_saves;
    bool fresh = false;  ///< begin anew; checkpoints that are there are set aside
    /// Asked after every pass: true ends it there, with a checkpoint.
    std::function<bool()> is_interrupted = [] { return false; };
};

/// What a group of runs shares.
struct RunGroup {
    const Experiment& experiment;
    const Scene& scene;
    const HitPoints& hit_points;
    const Reference* reference;     ///< or nullptr
    std::filesystem::path results;  ///< folder
    std::vector<const PreparedRun*> runs;
};

struct GroupOutcome {
    bool is_finished = false;  ///< false: interrupted, and saved
    std::string summary;       ///< a line a run
};

/// Makes the runs, each from its checkpoint if it has one. run.json goes first and comes last, so that no half-made
/// run looks finished.
GroupOutcome run_group(const RunGroup& group, const ContinuationOptions& options, const PassListener& on_pass);

/// Where a run's state is kept while it is not finished.
Checkpoint checkpoint_of(const Experiment& experiment, const PreparedRun& prepared);

/// The sums over seeds that a run's images belong to.
Ensemble ensemble_of(const Experiment& experiment, const PreparedRun& prepared, const std::filesystem::path& results);

/// Their lock, for whoever writes to them; empty when it was interrupted while another process held it.
std::optional<FileLock> lock_ensemble(const PreparedRun& prepared, const std::filesystem::path& results,
                                      const std::function<bool()>& is_interrupted);

}  // namespace photonlab
