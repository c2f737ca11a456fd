#include "experiment/experiment_runs.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <set>
#include <thread>

#include "core/file_lock.h"
#include "core/files.h"
#include "core/hash.h"
#include "experiment/memory.h"
#include "experiment/progress.h"
#include "experiment/recorder.h"
#include "experiment/reference.h"
#include "experiment/time_estimate.h"
#include "experiment/version.h"
#include "integrators/registry.h"
#include "scene/loader.h"
#include "transport/plain_images.h"

namespace photonlab {

namespace {

std::vector<const ExperimentRun*> select_runs(const Experiment& experiment, const std::optional<std::string>& only) {
    std::vector<const ExperimentRun*> selected;
    std::string names;
    for (const ExperimentRun& run : experiment.runs) {
        names += "\n  " + run.name;
        if (!only || run.name == *only || fnmatch(only->c_str(), run.name.c_str(), 0) == 0) selected.push_back(&run);
    }
    if (selected.empty())
        throw InputError(fmt::format("--only {}: no run is called that; the runs are{}", *only, names));
    return selected;
}

/// Everything that changes what the runs of a point record, but their seed.
std::string point_key(const Experiment& experiment, const ExperimentRun& run, const RunSettings& settings,
                      const Scene& scene, const std::string& reference_key) {
    const SceneEntry& entry = experiment.scenes[run.scene];
    Json probes = Json::array();
    for (const Probe& probe : entry.probes) probes.push_back({probe.name, probe.x, probe.y});
    return hash_text(Json{
        {"program", program_version().version},
        {"experiment", experiment.name},
        {"title", experiment.title},
        {"point", run.point},
        {"settings", settings_json(settings.method)},
        {"passes", settings.passes},
        {"recorded", run.plan.recorded},
        {"threads", settings.threads},
        {"width", scene.camera.width},
        {"height", scene.camera.height},
        {"samples_per_pixel", experiment.samples_per_pixel},
        {"scene", scene.hash},
        {"probes", probes},
        {"reference",
         reference_key}}.dump());
}

/// True when the folder holds a run that finished with this key, and its records are as they were then.
bool is_finished(const std::filesystem::path& folder, const std::string& key) {
    const std::filesystem::path file = folder / "run.json";
    if (!std::filesystem::exists(file) || !std::filesystem::exists(folder / "iterations.csv")) return false;
    const Json json = Json::parse(read_text_file(file), nullptr, false);
    if (!json.is_object()) return false;
    const auto finished = json.find("finished");
    const auto stored = json.find("key");
    const Json checksum = json.value("/checksums/iterations.csv"_json_pointer, Json());
    return finished != json.end() && *finished == true && stored != json.end() && *stored == key &&
           checksum == hash_file(folder / "iterations.csv");
}

/// The same, and that the ensemble has the run's images.
bool is_made(const Experiment& experiment, const PreparedRun& run, const std::filesystem::path& results) {
    return is_finished(run.folder, run.key) &&
           (!experiment.decomposition || ensemble_of(experiment, run, results).contains(run.run->seed));
}

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

ReferenceSubject subject_of(const Scene& scene, int samples_per_pixel, int max_depth) {
    return {scene.hash, scene.camera.width, scene.camera.height, samples_per_pixel, max_depth};
}

/// The rows of a run's file, without its header, which must be `header`.
std::string rows_of(const std::filesystem::path& file, const std::string& header) {
    const std::string text = read_text_file(file);
    const std::size_t header_end = text.find('\n');
    if (header_end == std::string::npos || text.substr(0, header_end) != header)
        throw InputError(file.string(), "its columns are not those of this program; delete it");
    return text.substr(header_end + 1);
}

/// The rows of every finished run, in the experiment's order; returns how many runs there are.
std::size_t merge_records(const Experiment& experiment, const std::filesystem::path& results,
                          const std::map<std::string, std::string>& keys) {
    std::string records = csv_header() + "\n";
    std::string probes;
    std::size_t count = 0;
    for (const ExperimentRun& run : experiment.runs) {
        const auto key = keys.find(run.name);
        const std::filesystem::path folder = results / "runs" / run.name;
        if (key == keys.end() || !is_finished(folder, key->second)) continue;
        records += rows_of(folder / "iterations.csv", csv_header());
        if (std::filesystem::exists(folder / "probes.csv")) probes += rows_of(folder / "probes.csv", probes_header);
        ++count;
    }
    write_text_file(results / "iterations.csv", records);
    if (!probes.empty()) write_text_file(results / "probes.csv", probes_header + "\n" + probes);
    return count;
}

/// Refuses regions and probes outside the image.
void require_inside(const std::filesystem::path& experiment_file, const SceneEntry& entry, const Scene& scene) {
    const int width = scene.camera.width;
    const int height = scene.camera.height;
    for (const Region& region : entry.regions)
        if (region.right > width || region.bottom > height)
            throw InputError(experiment_file.string(),
                             fmt::format("region {} of {}: expected pixels inside {}x{}, got up to {} {}", region.name,
                                         entry.name, width, height, region.right, region.bottom));
    for (const Probe& probe : entry.probes)
        if (probe.x >= width || probe.y >= height)
            throw InputError(experiment_file.string(),
                             fmt::format("probe {} of {}: expected a pixel inside {}x{}, got {} {}", probe.name,
                                         entry.name, width, height, probe.x, probe.y));
}

/// What is not finished, in groups that share their photons and hit points. They are in the order that they would have
/// if nothing was finished, whatever is: sums over seeds then go into the same slots.
std::vector<std::vector<const PreparedRun*>> runs_together(const std::vector<PreparedRun>& runs) {
    std::vector<std::vector<const PreparedRun*>> groups;
    for (const PreparedRun& run : runs) {
        const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& candidate) {
            return candidate[0]->run->scene == run.run->scene && can_run_together(candidate[0]->settings, run.settings);
        });
        if (group != groups.end())
            group->push_back(&run);
        else
            groups.push_back({&run});
    }
    for (auto& group : groups) std::erase_if(group, [](const PreparedRun* run) { return run->finished; });
    std::erase_if(groups, [](const auto& group) { return group.empty(); });
    return groups;
}

/// Runs of a group that this process may make, while their locks are held.
struct LockedRuns {
    std::vector<const PreparedRun*> runs;
    std::vector<FileLock> locks;
    std::vector<const PreparedRun*> of_others;
};

LockedRuns lock_runs(const std::vector<const PreparedRun*>& group) {
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
                            const std::vector<std::vector<const PreparedRun*>>& groups) {
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

std::size_t images_kept(const Experiment& experiment, const PreparedRun& run) {
    return experiment.decomposition ? run.run->plan.recorded.size() : 0;
}

struct GroupMemory {
    std::string first_run;
    MemoryEstimate estimate;
};

/// Of the group that takes most; empty without groups. Seeds do not change it.
std::optional<GroupMemory> largest_memory(const Experiment& experiment, const PreparedExperiment& prepared,
                                          const std::vector<std::vector<const PreparedRun*>>& groups) {
    std::optional<GroupMemory> largest;
    std::set<std::string> known;
    for (const auto& group : groups) {
        std::vector<RunSettings> settings;
        std::string points;
        for (const PreparedRun* run : group) {
            settings.push_back(run->settings);
            points += run->run->point + "\n";
        }
        if (!known.insert(points).second) continue;
        const MemoryEstimate estimate =
            estimate_memory(*prepared.scenes[group[0]->run->scene], experiment.samples_per_pixel, settings,
                            images_kept(experiment, *group[0]));
        if (!largest || estimate.total() > largest->estimate.total()) largest = {group[0]->run->name, estimate};
    }
    return largest;
}

/// The hit points and the reference of the runs at hand, kept as long as the next ones want the same.
class GroupSurroundings {
public:
    GroupSurroundings(const Experiment& experiment, const PreparedExperiment& prepared)
        : experiment_(experiment), prepared_(prepared) {}

    /// Says of a new scene why its images are plain, if they are.
    void move_to(const PreparedRun& run, const Progress& progress) {
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
            reference_ = load_reference(*entry.reference, subject_of(scene, experiment_.samples_per_pixel, max_depth));
        scene_ = scene_index;
        cutoff_ = cutoff;
        depth_ = max_depth;
    }

    const HitPoints& hit_points() const { return hit_points_; }
    const Reference* reference() const { return reference_ ? &*reference_ : nullptr; }

private:
    const Experiment& experiment_;
    const PreparedExperiment& prepared_;
    HitPoints hit_points_;
    std::optional<Reference> reference_;
    std::optional<std::size_t> scene_;
    double cutoff_ = 0.0;
    int depth_ = -1;
};

}  // namespace

PreparedExperiment prepare_experiment(const Experiment& experiment, const std::filesystem::path& results,
                                      const std::optional<std::string>& only) {
    PreparedExperiment prepared;
    prepared.scenes.resize(experiment.scenes.size());
    std::map<std::pair<std::size_t, int>, std::string> reference_keys;  // by scene and depth
    for (const ExperimentRun* run : select_runs(experiment, only)) {
        const SceneEntry& entry = experiment.scenes[run->scene];
        std::optional<Scene>& scene = prepared.scenes[run->scene];
        if (!scene) {
            scene = build_scene(load_scene_file(entry.file), entry.resolution);
            require_inside(experiment.file, entry, *scene);
        }

        PreparedRun ready;
        ready.run = run;
        ready.settings.method = resolve(run->settings, scene->max_depth);
        try {
            require_resolvable(ready.settings.method, *scene);
        } catch (const InputError& error) {
            throw InputError(experiment.file.string(), fmt::format("run {}: {}", run->name, error.what()));
        }
        ready.settings.seed = run->seed;
        ready.settings.passes = run->plan.passes;
        ready.settings.threads = experiment.threads;
        std::set_union(run->plan.recorded.begin(), run->plan.recorded.end(), run->plan.snapshots.begin(),
                       run->plan.snapshots.end(), std::back_inserter(ready.settings.estimated));
        std::string reference_key;
        if (entry.reference) {
            const auto [known, is_new] = reference_keys.try_emplace({run->scene, ready.settings.method.max_depth});
            if (is_new)
                known->second = check_reference(*entry.reference, subject_of(*scene, experiment.samples_per_pixel,
                                                                             ready.settings.method.max_depth));
            reference_key = known->second;
        }
        ready.point_key = point_key(experiment, *run, ready.settings, *scene, reference_key);
        ready.key = hash_text(fmt::format("{} {} {}", ready.point_key, run->seed, Json(run->plan.snapshots).dump()));
        ready.folder = results / "runs" / run->name;
        ready.finished = is_made(experiment, ready, results);
        prepared.runs.push_back(std::move(ready));
    }
    return prepared;
}

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

    std::vector<std::vector<const PreparedRun*>> groups = runs_together(prepared.runs);
    require_space(results, bytes_on_disk(experiment, prepared, groups),
                  "what this experiment still writes (snapshots, sums over seeds, checkpoints)");
    if (const auto largest = largest_memory(experiment, prepared, groups)) {
        require_memory(largest->first_run, largest->estimate);
        fmt::print(stderr, "memory: {}\n", describe(largest->estimate));
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
        std::vector<std::vector<const PreparedRun*>> of_others;
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
                          options, [&](std::uint64_t pass) { progress.show(passes_before + pass, counted); });
            outcome.is_interrupted = !made.is_finished;
            if (outcome.is_interrupted) break;
            if (locked.of_others.empty()) passes_before += first.settings.passes;
            outcome.ran += locked.runs.size();
            progress.finished(made.summary);
        }
        groups = std::move(of_others);
        if (groups.empty() || is_anything_done || outcome.is_interrupted) continue;
        progress.show(passes_before, "waiting for runs that another process is making");
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
        outcome.is_interrupted = options.is_interrupted();
    }
    progress.clear();
    if (experiment.decomposition)
        for (const PreparedRun& ready : prepared.runs) ensemble_of(experiment, ready, results).describe();

    // Runs outside the selection may be finished too: their keys need their scenes, so all are prepared for the merge.
    std::map<std::string, std::string> keys;
    const bool is_all = prepared.runs.size() == experiment.runs.size();
    const PreparedExperiment all = is_all ? PreparedExperiment{} : prepare_experiment(experiment, results);
    for (const PreparedRun& ready : is_all ? prepared.runs : all.runs) keys[ready.run->name] = ready.key;
    const FileLock lock = FileLock::wait_for(results / "lock");
    outcome.merged = merge_records(experiment, results, keys);
    return outcome;
}

std::string list_runs(const Experiment& experiment, const PreparedExperiment& prepared) {
    std::size_t width = 0;
    for (const PreparedRun& ready : prepared.runs) width = std::max(width, ready.run->name.size());
    std::string list = fmt::format("{}\n\n", experiment.title);
    struct Cost {
        TimeEstimate time;
        double mebibytes;
    };
    std::map<std::string, Cost> costs;  // by scene and settings: seeds do not change them
    std::optional<std::size_t> current_scene;
    double current_cutoff = 0.0;
    HitPoints hit_points;
    double seconds = 0.0;
    const auto groups = runs_together(prepared.runs);
    std::set<const PreparedRun*> first_of_group;
    for (const auto& group : groups) first_of_group.insert(group[0]);
    for (const PreparedRun& ready : prepared.runs) {
        if (ready.finished) {
            list += fmt::format("{:<{}}  finished\n", ready.run->name, width);
            continue;
        }
        const Scene& scene = *prepared.scenes[ready.run->scene];
        const double cutoff = ready.settings.method.branch_cutoff;
        if (current_scene != ready.run->scene || current_cutoff != cutoff)
            hit_points = trace_hit_points(scene, experiment.samples_per_pixel, experiment.threads, cutoff);
        current_scene = ready.run->scene;
        current_cutoff = cutoff;
        const auto [known, is_new] =
            costs.try_emplace(fmt::format("{} {}", ready.run->scene, settings_json(ready.settings.method).dump()));
        if (is_new)
            known->second = {
                estimate_time(scene, hit_points, ready.settings),
                estimate_memory(scene, experiment.samples_per_pixel, {ready.settings}, images_kept(experiment, ready))
                    .total()};
        const auto& [time, mebibytes] = known->second;
        seconds += time.seconds - (first_of_group.contains(&ready) ? 0.0 : time.trace_seconds);
        list += fmt::format("{:<{}}  about {}, up to {:.0f} MiB\n", ready.run->name, width,
                            describe_duration(time.seconds), mebibytes);
    }
    const auto by_passes = [](const PreparedRun& a, const PreparedRun& b) {
        return a.settings.passes < b.settings.passes;
    };
    const auto [fewest, most] = std::minmax_element(prepared.runs.begin(), prepared.runs.end(), by_passes);
    const std::string passes = fewest->settings.passes == most->settings.passes
                                   ? fmt::format("{}", most->settings.passes)
                                   : fmt::format("{} to {}", fewest->settings.passes, most->settings.passes);
    list += fmt::format("\n{} runs of {} passes on {} threads: about {} in all\n", prepared.runs.size(), passes,
                        experiment.threads, describe_duration(seconds));
    if (const auto largest = largest_memory(experiment, prepared, groups))
        list += fmt::format("memory of runs that share photons: {}\n", describe(largest->estimate));
    return list;
}

}  // namespace photonlab
