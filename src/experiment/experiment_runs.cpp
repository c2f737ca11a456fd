#include "experiment/experiment_runs.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <numeric>
#include <set>
#include <thread>

#include "core/error.h"
#include "core/files/file_lock.h"
#include "core/files/files.h"
#include "core/text/messages.h"
#include "core/text/progress.h"
#include "experiment/results_folder.h"
#include "record/merged_records.h"
#include "record/run/run_record.h"
#include "reference/reference.h"
#include "transport/camera/plain_images.h"

namespace photonlab {

namespace {

/// Runs of a group that this process may make, while their locks are held.
struct LockedRuns {
    std::vector<const PreparedRun*> runs;
    std::vector<FileLock> locks;
    std::vector<const PreparedRun*> of_others;
    std::vector<LockHolder> holders;  // of those
};

LockedRuns lock_runs(const RunsTogether& group) {
    LockedRuns locked;
    for (const PreparedRun* run : group) {
        LockHolder holder;
        if (auto lock = FileLock::try_lock(run->folder / "lock", &holder)) {
            locked.locks.push_back(std::move(*lock));
            locked.runs.push_back(run);
        } else {
            locked.of_others.push_back(run);
            locked.holders.push_back(holder);
        }
    }
    return locked;
}

/// Most that runs which are not finished add to the disk: images are counted without their compression.
std::uint64_t bytes_on_disk(const Experiment& experiment, const PreparedExperiment& prepared,
                            const std::vector<RunsTogether>& groups) {
    std::uint64_t bytes = 0;
    std::uint64_t largest_group = 0;
    std::map<const ExperimentPoint*, std::size_t> slots;
    for (const auto& group : groups) {
        std::uint64_t checkpoints = 0;
        for (const PreparedRun* run : group) {
            const Camera& camera = prepared.scenes[run->run.point->scene]->camera;
            const std::uint64_t layer =
                sizeof(Color) * static_cast<std::uint64_t>(camera.width) * static_cast<std::uint64_t>(camera.height);
            const std::uint64_t recorded = run->run.point->plan.recorded.size();
            bytes += 4 * layer * run->run.point->plan.snapshots.size();
            if (experiment.decomposition && slots[run->run.point]++ < ensemble_slots)
                bytes += layer * (2 + 2 * recorded);
            // Statistics at hit points, of which there is one at least a pixel where there is anything.
            checkpoints += layer * (6 + (experiment.decomposition ? 3 * recorded : 0));
        }
        largest_group = std::max(largest_group, checkpoints);
    }
    return bytes + largest_group;
}

/// Says of finished runs that were judged by a reference as it was before why they are made again.
void tell_changed_references(const Experiment& experiment, const PreparedExperiment& prepared) {
    std::map<std::filesystem::path, std::size_t> runs;
    for (const PreparedRun& ready : prepared.runs) {
        if (ready.finished || ready.reference_key.empty()) continue;
        const auto made = read_finished_run(ready.folder);
        if (made && made->reference && made->reference->key != ready.reference_key)
            ++runs[*experiment.scenes[ready.run.point->scene].reference];
    }
    for (const auto& [reference, count] : runs)
        print_message("{}: has changed since {} finished runs were judged by it; they are made again\n",
                      reference.string(), count);
}

/// The hit points and the reference of the runs at hand, kept as long as the next ones want the same.
class GroupSurroundings {
public:
    GroupSurroundings(const Experiment& experiment, const PreparedExperiment& prepared)
        : experiment_(experiment), prepared_(prepared) {}

    /// Says of a new scene why its images are plain, if they are, and of a new reference that it is disputed, if it is.
    void move_to(const PreparedRun& run, Progress& progress) {
        const std::size_t scene_index = run.run.point->scene;
        const SceneEntry& entry = experiment_.scenes[scene_index];
        const Scene& scene = *prepared_.scenes[scene_index];
        const ReferenceSubject subject = subject_of(scene, entry.samples_per_pixel, run.settings.method);
        const double cutoff = run.settings.method.branch_cutoff;
        if (scene_ != scene_index) reference_.reset();
        if (scene_ != scene_index || cutoff_ != cutoff)
            hit_points_ = trace_hit_points(scene, entry.samples_per_pixel, experiment_.threads, cutoff);
        if (scene_ != scene_index)
            for (const std::string& reason : why_images_are_plain(scene, hit_points_))
                progress.finished(entry.name + ": " + reason);
        if (entry.reference && (!reference_ || depth_ != subject.max_depth || positions_ != subject.positions))
            load_reference_of(entry, subject, progress);
        scene_ = scene_index;
        cutoff_ = cutoff;
        depth_ = subject.max_depth;
        positions_ = subject.positions;
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
    Positions positions_ = Positions::Grid;
};

/// Makes the folder the experiment's, and asks whether the records can be written, while nobody else is at it. False
/// when it was interrupted while another process was. Many jobs that begin at once find it made.
bool open_results(const Experiment& experiment, const std::filesystem::path& results,
                  const ContinuationOptions& options) {
    if (options.is_part && is_claimed(experiment, results)) return true;
    const auto lock = FileLock::wait_for(results / "lock", options.is_interrupted);
    if (!lock) return false;
    claim_results(experiment, results);
    if (!options.is_part) require_writable(results / "iterations.csv");
    return true;
}

/// What a process left of a finished run that was killed before it had cleared up.
void clear_up(const PreparedRun& ready) {
    const Checkpoint& checkpoint = ready.files.checkpoint;
    const std::filesystem::path lock_file = ready.folder / "lock";
    if (!is_there(checkpoint.file) && !is_there(lock_file)) return;
    if (const auto lock = FileLock::try_lock(lock_file)) discard(checkpoint);
}

/// Makes the runs that are not finished, group by group.
class Making {
public:
    Making(const Experiment& experiment, const PreparedExperiment& prepared, const std::filesystem::path& results,
           const ContinuationOptions& options, const std::vector<RunsTogether>& groups)
        : experiment_(experiment),
          prepared_(prepared),
          results_(results),
          options_(options),
          group_count_(groups.size()),
          progress_(
              std::accumulate(groups.begin(), groups.end(), std::uint64_t{0},
                              [](std::uint64_t sum, const auto& group) { return sum + group[0]->settings.passes; })),
          surroundings_(experiment, prepared) {}

    /// What another process is making is asked for again, until all is made: it may end without finishing. A part of
    /// many jobs asks again only where it is not certain that there is such a process.
    void make_all(std::vector<RunsTogether> groups, ExperimentOutcome& outcome) {
        while (!groups.empty() && !outcome.is_interrupted) {
            std::vector<RunsTogether> of_others;
            bool is_anything_done = false;
            outcome.held.clear();
            bool is_certain = true;
            for (const auto& group : groups) {
                outcome.is_interrupted = options_.is_interrupted();
                if (outcome.is_interrupted) break;
                LockedRuns locked = lock_runs(group);
                is_anything_done = is_anything_done || !locked.runs.empty();
                const bool is_any_made = make(locked, outcome);
                if (outcome.is_interrupted) break;
                is_certain = note_holders(locked, outcome) && is_certain;
                if (locked.of_others.empty())
                    passes_before_ += group[0]->settings.passes;
                else
                    of_others.push_back(std::move(locked.of_others));
                if (!is_any_made) progress_.skip(passes_before_);
            }
            groups = std::move(of_others);
            if (groups.empty() || is_anything_done || outcome.is_interrupted) continue;
            if (options_.is_part && is_certain) break;
            progress_.skip(passes_before_);
            progress_.show(passes_before_, "waiting for runs that another process is making");
            const auto next = Clock::now() + (is_certain ? std::chrono::seconds(0) : time_between_leases);
            do {
                std::this_thread::sleep_for(std::chrono::milliseconds(100));
                outcome.is_interrupted = options_.is_interrupted();
            } while (!outcome.is_interrupted && Clock::now() < next);
        }
        progress_.clear();
    }

private:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::seconds time_between_leases{2};

    /// A lock that was touched since it was first met: its process is at work, wherever it is.
    bool is_renewed(const PreparedRun& run, const LockHolder& holder) {
        const auto [met, is_new] = leases_.try_emplace(&run, holder);
        if (is_new || met->second.nonce != holder.nonce) met->second = holder;
        return holder.touched > met->second.touched;
    }

    /// Says, once, where only leases tell that another process is at work. True when all of them are certain.
    bool note_holders(const LockedRuns& locked, ExperimentOutcome& outcome) {
        bool is_certain = true;
        for (std::size_t i = 0; i < locked.of_others.size(); ++i) {
            const LockHolder& holder = locked.holders[i];
            outcome.held.push_back(fmt::format("{}, by {}", locked.of_others[i]->run.name, describe(holder)));
            const bool is_at_work = holder.is_certain || is_renewed(*locked.of_others[i], holder);
            is_certain = is_certain && is_at_work;
            if (is_at_work || holder.host.empty() || has_told_of_leases_) continue;
            has_told_of_leases_ = true;
            progress_.finished(
                fmt::format("{}: the file system gives the lock away that {} has: that process has died within the "
                            "last {:.0f} s, or "
                            "locks do not reach from machine to machine here (docs/cluster.md); asking again until its "
                            "lease is over",
                            locked.of_others[i]->folder.string(), describe(holder), lease_seconds));
        }
        return is_certain;
    }

    /// Those that are not made, which others may have done since this process looked. False when none was left.
    bool make(LockedRuns& locked, ExperimentOutcome& outcome) {
        const auto first_made =
            std::stable_partition(locked.runs.begin(), locked.runs.end(),
                                  [&](const PreparedRun* run) { return !is_made(experiment_, *run, results_); });
        std::for_each(first_made, locked.runs.end(), [&](const PreparedRun* run) { discard(run->files.checkpoint); });
        outcome.skipped += static_cast<std::size_t>(locked.runs.end() - first_made);
        locked.runs.erase(first_made, locked.runs.end());
        if (locked.runs.empty()) return false;

        const PreparedRun& first = *locked.runs[0];
        surroundings_.move_to(first, progress_);
        const std::string others = locked.runs.size() > 1 ? fmt::format(" and {} more", locked.runs.size() - 1) : "";
        const std::string counted = fmt::format("{}{}, one of {} groups", first.run.name, others, group_count_);
        progress_.show(passes_before_, counted);
        ContinuationOptions options = options_;
        options.require_held = [&] {
            for (const FileLock& lock : locked.locks) lock.require_held();
        };
        options.is_interrupted = [&] {
            options.require_held();
            return options_.is_interrupted();
        };
        const GroupOutcome made =
            run_group({experiment_, *prepared_.scenes[first.run.point->scene], surroundings_.hit_points(),
                       surroundings_.reference(), results_, locked.runs},
                      options, [&](std::uint64_t pass, bool is_new) {
                          if (!is_new) progress_.skip(passes_before_ + pass);
                          progress_.show(passes_before_ + pass, counted);
                      });
        outcome.is_interrupted = !made.is_finished;
        if (outcome.is_interrupted) return true;
        outcome.ran += locked.runs.size();
        for (const FinishedRunState& run : made.runs) progress_.finished(run.summary);
        return true;
    }

    const Experiment& experiment_;
    const PreparedExperiment& prepared_;
    const std::filesystem::path& results_;
    const ContinuationOptions& options_;
    const std::size_t group_count_;
    Progress progress_;
    GroupSurroundings surroundings_;
    std::uint64_t passes_before_ = 0;
    bool has_told_of_leases_ = false;
    std::map<const PreparedRun*, LockHolder> leases_;  // as they were first met
};

/// Point by point, while nobody else is at the sums.
void describe_ensembles(const Experiment& experiment, const PreparedExperiment& all,
                        const std::filesystem::path& results, const std::function<bool()>& is_interrupted) {
    if (!experiment.decomposition) return;
    std::set<const ExperimentPoint*> described;
    for (const PreparedRun& ready : all.runs) {
        if (!described.insert(ready.run.point).second) continue;
        const auto lock = lock_ensemble(ready, results, is_interrupted);
        if (lock) ensemble_of(experiment, ready, results).describe();
    }
}

}  // namespace

ExperimentOutcome run_experiment(const Experiment& experiment, const PreparedExperiment& prepared,
                                 const std::filesystem::path& results, const ContinuationOptions& options) {
    if (!options.fresh)
        for (const PreparedRun& ready : prepared.runs)
            if (!ready.finished) is_usable(ready.files.checkpoint);
    std::vector<RunsTogether> groups = runs_together(prepared.runs);
    if (const auto largest = largest_memory(experiment, prepared, groups)) {
        require_memory(largest->first_run, largest->estimate);
        print_message("memory: {}\n", describe(largest->estimate));
    }
    require_space(results, bytes_on_disk(experiment, prepared, groups),
                  "what this experiment still writes (snapshots, sums over seeds, checkpoints)");
    tell_changed_references(experiment, prepared);

    ExperimentOutcome outcome;
    outcome.records = results / "iterations.csv";
    outcome.is_interrupted = !open_results(experiment, results, options);
    if (outcome.is_interrupted) return outcome;
    for (const PreparedRun& ready : prepared.runs) {
        if (!ready.finished) continue;
        clear_up(ready);
        ++outcome.skipped;
    }
    Making(experiment, prepared, results, options, groups).make_all(std::move(groups), outcome);
    if (options.is_part) return outcome;

    // Runs that were not selected may be finished, too; their keys need their scenes and references.
    std::optional<PreparedExperiment> all;
    try {
        if (prepared.runs.size() < experiment.run_count()) all = prepare_all_keys(experiment, results);
    } catch (const InputError& error) {
        outcome.why_not_merged = error.what();
        return outcome;
    }
    outcome.merged = merge_experiment(experiment, all ? *all : prepared, results, options.is_interrupted);
    if (!outcome.merged) outcome.is_interrupted = true;
    return outcome;
}

std::optional<MergedRecords> merge_experiment(const Experiment& experiment, const PreparedExperiment& all,
                                              const std::filesystem::path& results,
                                              const std::function<bool()>& is_interrupted) {
    const auto lock = FileLock::wait_for(results / "lock", is_interrupted);
    if (!lock) return std::nullopt;
    describe_ensembles(experiment, all, results, is_interrupted);
    std::vector<RunToMerge> runs;
    for (const PreparedRun& ready : all.runs) runs.push_back({ready.folder, ready.key});
    return merge_records(experiment.name, results, runs);
}

}  // namespace photonlab
