// What an experiment's runs are and will take, told before any of them is made: as text, and as JSON for what hands
// them out to machines.
//
//     {"schema": 1, "experiment": "alpha-study", "title": ..., "threads": 1,
//      "groups": [
//     {"group": 1, "scene": "cornell-box", "seed": 1, "runs": 9, "unfinished": 9, "seconds": 812.5, "mebibytes": 310},
//     ...],
//      "runs": [
//     {"name": "cornell-box_ppm_alpha-0.5_seed-1", "group": 1, "scene": "cornell-box", "method": "ppm", "settings":
//     {...},
//      "passes": 64, "seed": 1, "state": "unfinished", "seconds": 95.1, "mebibytes": 290},
//     ...]}
//
// A group is a scene and a seed: its runs share photons where their methods allow, so that all of them together take
// less time than each alone. `seconds` and `mebibytes` are of what is not finished; those of a run are of that run
// alone. A state is "finished", "saved" (there is a checkpoint to go on from) or "unfinished". Each group and each run
// is a line.

#pragma once

#include <string>

#include "experiment/experiment_plan.h"
#include "render/estimates/time_estimate.h"

namespace photonlab {

/// One line a run: name, estimated time and memory, or that it is finished; then the sums.
/// Points are estimated once, however many seeds they have.
std::string list_runs(const Experiment& experiment, const PreparedExperiment& prepared,
                      const TimeEstimator& estimate = estimate_time);

/// The same as JSON.
std::string list_runs_json(const Experiment& experiment, const PreparedExperiment& prepared,
                           const TimeEstimator& estimate = estimate_time);

}  // namespace photonlab
