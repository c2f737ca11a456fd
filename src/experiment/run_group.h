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

#include "core/files/file_lock.h"
#include "experiment/file/experiment_file.h"
#include "record/images/ensemble.h"
#include "reference/reference.h"
#include "render/checkpoint.h"
#include "render/run_methods.h"
#include "scene/scene.h"
#include "transport/camera/camera_pass.h"

namespace photonlab {

/// Where a run puts what it makes. An empty name: nowhere.
struct RunFiles {
    std::filesystem::path rows;              ///< CSV
    std::filesystem::path probes = {};       ///< CSV
    std::filesystem::path emission = {};     ///< CSV: what emission that learns has learnt
    std::filesystem::path description = {};  ///< run.json
    std::filesystem::path snapshots = {};    ///< folder of its own for them
    std::function<std::filesystem::path(std::uint64_t pass)> snapshot;
    Checkpoint checkpoint = {};          ///< its state while it is not finished
    bool keeps_state = false;            ///< and after its last pass, to be joined with others
    std::filesystem::path picture = {};  ///< PNG of the last image
};

/// Those of a run in a folder of its own; `identity` is that of its checkpoint.
RunFiles files_in(const std::filesystem::path& folder, const std::string& identity);

/// A run that is ready to start: its scene is there, its reference fits.
struct PreparedRun {
    ExperimentRun run;
    RunSettings settings;
    std::string key = "";
    std::string point_key = "";      ///< the same without the seed
    std::string reference_key = "";  ///< empty without a reference
    std::filesystem::path folder = {};
    RunFiles files = {};
    bool finished = false;  ///< with this key
};

struct ContinuationOptions {
    double seconds_between_saves = default_seconds_between_saves;
    bool fresh = false;  ///< begin anew; checkpoints that are there are set aside
    /// One job of many on the folder: it looks at no files but those of its runs, merges no records, and does not wait
    /// for what another process is making; where only a lease tells of that, no longer than until it is renewed.
    bool is_part = false;
    /// Asked after every pass: true ends it there, with a checkpoint.
    std::function<bool()> is_interrupted = [] { return false; };
    /// Asked before anything is written; throws where another process makes the runs by now.
    std::function<void()> require_held = [] {};
    /// Asked after every pass with the image of the only run: true ends it there, finished. Empty: never.
    std::function<bool(const Image& image)> is_good_enough = {};
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

/// A run after its last pass.
struct FinishedRunState {
    RunState state;
    std::optional<ErrorMetrics> errors;  ///< of the whole picture; empty without a reference
    std::string summary;                 ///< a line
};

struct GroupOutcome {
    bool is_finished = false;                 ///< false: interrupted, and saved
    std::uint64_t passes = 0;                 ///< done
    std::vector<FinishedRunState> runs = {};  ///< when they are finished
};

/// Makes the runs, each from its checkpoint if it has one. The description goes first and comes last, so that no
/// half-made run looks finished.
GroupOutcome run_group(const RunGroup& group, const ContinuationOptions& options, const PassListener& on_pass);

/// The sums over seeds that a run's images belong to.
Ensemble ensemble_of(const Experiment& experiment, const PreparedRun& prepared, const std::filesystem::path& results);

/// Their lock, for whoever writes to them; empty when it was interrupted while another process held it.
std::optional<FileLock> lock_ensemble(const PreparedRun& prepared, const std::filesystem::path& results,
                                      const std::function<bool()>& is_interrupted);

}  // namespace photonlab
