#include "experiment/experiment_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <thread>

#include "core/file_lock.h"
#include "core/files.h"
#include "core/messages.h"
#include "experiment/merged_records.h"
#include "experiment/progress.h"
#include "experiment/reference.h"
#include "transport/plain_images.h"

namespace photonlab {

namespace {

/// Refuses a folder that holds runs of another experiment, or of this one at its full size when it is run in small:
/// they have the same names and would be made again.
void require_same_experiment(const Experiment& experiment, const std::filesystem::path& results) {
    for (const ExperimentRun& run : experiment.runs) {
        const std::filesystem::path file = results / "runs" / run.name / "run.json";
        if (!std::filesystem::exists(file)) continue;
        const Json json = Json::parse(read_text_file(file), nullptr, false);
        if (!json.is_object() || json.value("experiment", Json(experiment.name)) == experiment.name) continue;
        throw InputError(file.string(), fmt::format("this is a run of the experiment {}, not of \"{}\"; choose another "
                                                    "folder for the results",
                                                    json.at("experiment").dump(), experiment.name));
    }
}

/// Runs of a group that this process may make, while their locks are held.
struct LockedRuns {
    std::vector<const PreparedRun*> runs;
    std::vector<FileLock> locks;
    std::vector<const PreparedRun*> of_others;
};

LockedRuns lock_runs(const RunsTogether& group) {
    LockedRuns locked;
    for (const PreparedRun* run : group) {
        if (auto lock = FileLock::try_lock(run->folder / "lock")) {
            locked.locks.push_back(std::move(*lock));
            locked.runs.push_back(run);
        } else {
            locked.of_others.push_back(run);
        }
    }
    return locked;
}

/// Most that runs which are not finished add to the disk: images are counted without their compression.
std::uint64_t bytes_on_disk(const Experiment& experiment, const PreparedExperiment& prepared,
                            const std::vector<RunsTogether>& groups) {
    std::uint64_t bytes = 0;
    std::uint64_t largest_group = 0;
    std::map<std::string, std::size_t> slots;  // by point
    for (const auto& group : groups) {
        std::uint64_t checkpoints = 0;
        for (const PreparedRun* run : group) {
            const Camera& camera = prepared.scenes[run->run->scene]->camera;
            const std::uint64_t layer =
                sizeof(Color) * static_cast<std::uint64_t>(camera.width) * static_cast<std::uint64_t>(camera.height);
            const std::uint64_t recorded = run->run->plan.recorded.size();
            bytes += 4 * layer * run->run->plan.snapshots.size();
            if (experiment.decomposition && slots[run->run->point]++ < ensemble_slots)
                bytes += layer * (2 + 2 * recorded);
            // Statistics at hit points, of which there is one at least a pixel where there is anything.
            checkpoints += layer * (6 + (experiment.decomposition ? 3 * recorded : 0));
        }
        largest_group = std::max(largest_group, checkpoints);
    }
    return bytes + largest_group;
}

/// The hit points and the reference of the runs at hand, kept as long as the next ones want the same.
class GroupSurroundings {
public:
    GroupSurroundings(const Experiment& experiment, const PreparedExperiment& prepared)
        : experiment_(experiment), prepared_(prepared) {}

    /// Says of a new scene why its images are plain, if they are, and of a new reference that it is disputed, if it is.
    void move_to(const PreparedRun& run, Progress& progress) {
        const std::size_t scene_index = run.run->scene;
        const SceneEntry& entry = experiment_.scenes[scene_index];
        const Scene& scene = *prepared_.scenes[scene_index];
        const int max_depth = run.settings.method.max_depth;
        const double cutoff = run.settings.method.branch_cutoff;
        if (scene_ != scene_index) reference_.reset();
        if (scene_ != scene_index || cutoff_ != cutoff)
            hit_points_ = trace_hit_points(scene, experiment_.samples_per_pixel, experiment_.threads, cutoff);
        if (scene_ != scene_index)
            for (const std::string& reason : why_images_are_plain(scene, hit_points_))
                progress.finished(entry.name + ": " + reason);
        if (entry.reference && (!reference_ || depth_ != max_depth))
            load_reference_of(entry, subject_of(scene, experiment_.samples_per_pixel, max_depth), progress);
        scene_ = scene_index;
        cutoff_ = cutoff;
        depth_ = max_depth;
    }

    const HitPoints& hit_points() const { return hit_points_; }
    const Reference* reference() const { return reference_ ? &*reference_ : nullptr; }

private:
    void load_reference_of(const SceneEntry& entry, const ReferenceSubject& subject, Progress& progress) {
        reference_ = load_reference(*entry.reference, subject);
        const auto warning = warning_about(*reference_);
        if (warning && warned_of_.insert(*entry.reference).second) progress.finished(entry.name + ": " + *warning);
    }

    const Experiment& experiment_;
    const PreparedExperiment& prepared_;
    HitPoints hit_points_;
    std::optional<Reference> reference_;
    std::set<std::filesystem::path> warned_of_;
    std::optional<std::size_t> scene_;
    double cutoff_ = 0.0;
    int depth_ = -1;
};

}  // namespace

ExperimentOutcome run_experiment(const Experiment& experiment, const PreparedExperiment& prepared,
                                 const std::filesystem::path& results, const ContinuationOptions& options) {
    ExperimentOutcome outcome;
    outcome.records = results / "iterations.csv";
    require_writable(outcome.records);
    require_same_experiment(experiment, results);
    for (const PreparedRun& ready : prepared.runs) {
        const Checkpoint checkpoint = checkpoint_of(experiment, ready);
        if (ready.finished) {  // perhaps by a process that was killed before it had cleared up
            discard(checkpoint);
            if (std::filesystem::exists(ready.folder / "lock")) FileLock::try_lock(ready.folder / "lock");
        } else if (!options.fresh) {
            is_usable(checkpoint);
        }
    }

    std::vector<RunsTogether> groups = runs_together(prepared.runs);
    require_space(results, bytes_on_disk(experiment, prepared, groups),
                  "what this experiment still writes (snapshots, sums over seeds, checkpoints)");
    if (const auto largest = largest_memory(experiment, prepared, groups)) {
        require_memory(largest->first_run, largest->estimate);
        print_message("memory: {}\n", describe(largest->estimate));
    }
    for (const PreparedRun& ready : prepared.runs) outcome.skipped += ready.finished;
    std::uint64_t passes = 0;
    for (const auto& group : groups) passes += group[0]->settings.passes;
    Progress progress(passes);
    std::uint64_t passes_before = 0;
    GroupSurroundings surroundings(experiment, prepared);
    const std::size_t group_count = groups.size();
    // What another process is making is asked for again, until all is made: it may end without finishing.
    while (!groups.empty() && !outcome.is_interrupted) {
        std::vector<RunsTogether> of_others;
        bool is_anything_done = false;
        for (const auto& group : groups) {
            LockedRuns locked = lock_runs(group);
            if (!locked.of_others.empty()) of_others.push_back(locked.of_others);
            const auto first_made =
                std::stable_partition(locked.runs.begin(), locked.runs.end(),
                                      [&](const PreparedRun* run) { return !is_made(experiment, *run, results); });
            const auto made_by_others = static_cast<std::size_t>(locked.runs.end() - first_made);
            std::for_each(first_made, locked.runs.end(),
                          [&](const PreparedRun* run) { discard(checkpoint_of(experiment, *run)); });
            outcome.skipped += made_by_others;
            is_anything_done = is_anything_done || !locked.runs.empty();
            locked.runs.erase(first_made, locked.runs.end());
            if (locked.runs.empty()) {
                if (locked.of_others.empty()) passes_before += group[0]->settings.passes;
                progress.skip(passes_before);
                continue;
            }

            const PreparedRun& first = *locked.runs[0];
            surroundings.move_to(first, progress);
            const std::string others =
                locked.runs.size() > 1 ? fmt::format(" and {} more", locked.runs.size() - 1) : "";
            const std::string counted = fmt::format("{}{}, one of {} groups", first.run->name, others, group_count);
            progress.show(passes_before, counted);
            const GroupOutcome made =
                run_group({experiment, *prepared.scenes[first.run->scene], surroundings.hit_points(),
                           surroundings.reference(), results, locked.runs},
                          options, [&](std::uint64_t pass, bool is_new) {
                              if (!is_new) progress.skip(passes_before + pass);
                              progress.show(passes_before + pass, counted);
                          });
            outcome.is_interrupted = !made.is_finished;
            if (outcome.is_interrupted) break;
            if (locked.of_others.empty()) passes_before += first.settings.passes;
            outcome.ran += locked.runs.size();
            progress.finished(made.summary);
        }
        groups = std::move(of_others);
        if (groups.empty() || is_anything_done || outcome.is_interrupted) continue;
        progress.skip(passes_before);
        progress.show(passes_before, "waiting for runs that another process is making");
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        outcome.is_interrupted = options.is_interrupted();
    }
    progress.clear();
    if (experiment.decomposition)
        for (const PreparedRun& ready : prepared.runs) ensemble_of(experiment, ready, results).describe();

    // Runs outside the selection may be finished too: their keys need their scenes, so all are prepared for the merge.
    const bool is_all = prepared.runs.size() == experiment.runs.size();
    const PreparedExperiment all = is_all ? PreparedExperiment{} : prepare_experiment(experiment, results);
    std::vector<RunToMerge> runs;
    for (const PreparedRun& ready : is_all ? prepared.runs : all.runs) runs.push_back({ready.folder, ready.key});
    const FileLock lock = FileLock::wait_for(results / "lock");
    MergedRecords merged = merge_records(experiment.name, results, runs);
    outcome.merged = merged.runs;
    outcome.left_out = std::move(merged.faults);
    return outcome;
}

}  // namespace photonlab
