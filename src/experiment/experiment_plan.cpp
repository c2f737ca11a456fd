#include "experiment/experiment_plan.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/hash.h"
#include "core/nearest.h"
#include "experiment/progress.h"
#include "experiment/reference.h"
#include "experiment/results_folder.h"
#include "experiment/run_record.h"
#include "experiment/settings_io.h"
#include "experiment/time_estimate.h"
#include "experiment/version.h"
#include "integrators/registry.h"
#include "scene/loader.h"

namespace photonlab {

namespace {

/// What is said where no run is called so.
std::string no_run_called(const std::string& only, const std::vector<ExperimentRun>& runs) {
    constexpr std::size_t most = 1000;  // of which the nearest is sought
    std::vector<std::string_view> names;
    for (std::size_t i = 0; i < std::min(most, runs.size()); ++i) names.push_back(runs[i].name);
    return "--only: " + unknown_name("run", only, names);
}

std::vector<const ExperimentRun*> select_runs(const Experiment& experiment, const std::optional<std::string>& only) {
    std::vector<const ExperimentRun*> selected;
    for (const ExperimentRun& run : experiment.runs)
        if (!only || run.name == *only || fnmatch(only->c_str(), run.name.c_str(), 0) == 0) selected.push_back(&run);
    if (selected.empty()) throw InputError(no_run_called(*only, experiment.runs));
    return selected;
}

/// Everything that changes what the runs of a point record, but their seed: so neither threads nor the title.
std::string point_key(const Experiment& experiment, const ExperimentRun& run, const RunSettings& settings,
                      const Scene& scene, const std::string& reference_key) {
    const SceneEntry& entry = experiment.scenes[run.scene];
    Json probes = Json::array();
    for (const Probe& probe : entry.probes) probes.push_back({probe.name, probe.x, probe.y});
    return hash_text(Json{
        {"program", program_version().version},
        {"experiment", experiment.name},
        {"point", run.point},
        {"settings", settings_json(settings.method)},
        {"passes", settings.passes},
        {"recorded", run.plan.recorded},
        {"width", scene.camera.width},
        {"height", scene.camera.height},
        {"samples_per_pixel", experiment.samples_per_pixel},
        {"scene", scene.hash},
        {"probes", probes},
        {"reference",
         reference_key}}.dump());
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

std::size_t images_kept(const Experiment& experiment, const PreparedRun& run) {
    return experiment.decomposition ? run.run->plan.recorded.size() : 0;
}

}  // namespace

bool is_finished(const std::filesystem::path& folder, const std::string& key) {
    const std::optional<FinishedRun> run = read_finished_run(folder);
    return run && run->key == key && faults_of(folder, *run, Check::Records).empty();
}

bool is_made(const Experiment& experiment, const PreparedRun& run, const std::filesystem::path& results) {
    return is_finished(run.folder, run.key) &&
           (!experiment.decomposition || ensemble_of(experiment, run, results).contains(run.run->seed));
}

ReferenceSubject subject_of(const Scene& scene, int samples_per_pixel, int max_depth) {
    return {scene.hash, scene.camera.width, scene.camera.height, samples_per_pixel, max_depth};
}

PreparedExperiment prepare_experiment(const Experiment& experiment, const std::filesystem::path& results,
                                      const std::optional<std::string>& only) {
    require_own_results(experiment, results);
    return prepare_runs(experiment, results, select_runs(experiment, only));
}

PreparedExperiment prepare_runs(const Experiment& experiment, const std::filesystem::path& results,
                                const std::vector<const ExperimentRun*>& runs) {
    PreparedExperiment prepared;
    prepared.scenes.resize(experiment.scenes.size());
    std::map<std::pair<std::size_t, int>, std::string> reference_keys;  // by scene and depth
    for (const ExperimentRun* run : runs) {
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

std::vector<RunsTogether> runs_together(const std::vector<PreparedRun>& runs) {
    std::vector<RunsTogether> groups;
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

std::optional<GroupMemory> largest_memory(const Experiment& experiment, const PreparedExperiment& prepared,
                                          const std::vector<RunsTogether>& groups) {
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
