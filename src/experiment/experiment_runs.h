// Runs an experiment: whatever of it is not finished, each run into a folder of its own. Runs of one scene and seed
// with the same photons a pass run side by side and share them; what is shared is charged in full to each.
//
//     RESULTS/experiment.json                   whose folder it is: results_folder.h
//     RESULTS/iterations.csv, RESULTS/merged.json    all finished runs of the experiment: merged_records.h
//     RESULTS/runs/RUN/iterations.csv           the run's rows, appended as its passes finish
//     RESULTS/runs/RUN/snapshots/pass-000064.exr
//     RESULTS/runs/RUN/emission.csv             of emission that learns: what it has learnt
//     RESULTS/runs/RUN/run.json                 written last: a folder without it is not finished
//     RESULTS/runs/RUN/checkpoint               of a run that is not finished: what it goes on from
//     RESULTS/probes.csv, RESULTS/runs/RUN/probes.csv    of scenes with probes: what was gathered there, pass by pass
//     RESULTS/ensembles/POINT/                  with `decomposition`: ensemble.h
//
// A finished run is recognised by its key: a hash of its settings, scene, reference and the program's version, but not
// of the threads, which change nothing. One whose key differs from what the experiment asks for now is made again from
// the start.
//
// Several processes can work on one results folder: each locks the runs that it makes and leaves those of others alone.
// One that is to make all waits for them at the end, and merges the records; one of many jobs does neither, and the
// files that it opens are those of its own runs, however many others there are.

#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "experiment/experiment_plan.h"
#include "experiment/file/experiment_file.h"
#include "experiment/run_group.h"
#include "record/merged_records.h"

namespace photonlab {

struct ExperimentOutcome {
    std::size_t ran = 0;
    std::size_t skipped = 0;              ///< were finished already, or by another process
    std::filesystem::path records;        ///< the merged iterations.csv
    std::optional<MergedRecords> merged;  ///< empty when they stay as they were
    std::string why_not_merged;           ///< of runs that were not selected: what keeps their rows from being merged
    bool is_interrupted = false;          ///< what was running is saved
    std::vector<std::string> held;        ///< runs that were left to other processes, with whose they are
};

/// Runs what is not finished, from its checkpoints, and merges the records. Throws InputError before anything is run
/// when a checkpoint is damaged or of other settings.
ExperimentOutcome run_experiment(const Experiment& experiment, const PreparedExperiment& prepared,
                                 const std::filesystem::path& results, const ContinuationOptions& options = {});

/// Merges the records of all runs of the experiment that are finished, `all` of which have their keys; and writes what
/// the sums over seeds are of. Empty when it was interrupted while another process was at it.
std::optional<MergedRecords> merge_experiment(const Experiment& experiment, const PreparedExperiment& all,
                                              const std::filesystem::path& results,
                                              const std::function<bool()>& is_interrupted);

}  // namespace photonlab
