#include "experiment/experiment_plan.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <map>
#include <set>
#include <tuple>

#include "core/hash.h"
#include "core/machine/version.h"
#include "core/text/nearest.h"
#include "experiment/results_folder.h"
#include "integrators/registry.h"
#include "record/recorder.h"
#include "record/run/run_record.h"
#include "record/run/settings_json.h"
#include "reference/reference.h"
#include "scene/loader.h"

namespace photonlab {

namespace {

/// Those that are called `name`, or as the shell pattern that it is.
std::vector<ExperimentRun> called(const std::string& name, const std::vector<ExperimentRun>& runs) {
    std::vector<ExperimentRun> found;
    std::copy_if(runs.begin(), runs.end(), std::back_inserter(found), [&](const ExperimentRun& run) {
        return run.name == name || fnmatch(name.c_str(), run.name.c_str(), 0) == 0;
    });
    return found;
}

/// What is said where none of all runs is called so.
std::string no_run_called(const std::string& only, const std::vector<ExperimentRun>& runs) {
    constexpr std::size_t most = 1000;  // of which the nearest is sought
    std::vector<std::string_view> names;
    for (std::size_t i = 0; i < std::min(most, runs.size()); ++i) names.push_back(runs[i].name);
    return "--only: " + unknown_name("run", only, names);
}

std::vector<ExperimentRun> select_runs(const Experiment& experiment, const RunSelection& selection) {
    const auto& [name, groups] = selection;
    if (groups && groups->last > experiment.group_count())
        throw InputError(fmt::format("--group: expected groups from 1 to {}, as many as scenes times seeds, got {}",
                                     experiment.group_count(), groups->last));
    std::vector<ExperimentRun> selected = runs_of(experiment, groups);
    if (!name) return selected;
    selected = called(*name, selected);
    if (!selected.empty()) return selected;
    const std::vector<ExperimentRun> all = runs_of(experiment);
    if (called(*name, all).empty()) throw InputError(no_run_called(*name, all));
    throw InputError(
        fmt::format("--only, --group: expected runs that are in both, got none that is called {} in {}", *name,
                    groups->first == groups->last ? fmt::format("group {}", groups->first)
                                                  : fmt::format("groups {} to {}", groups->first, groups->last)));
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
    return experiment.decomposition ? run.run.point->plan.recorded.size() : 0;
}

}  // namespace

bool is_made(const Experiment& experiment, const PreparedRun& run, const std::filesystem::path& results) {
    const std::optional<FinishedRun> finished = read_finished_run(run.folder);
    return finished && finished->key == run.key && faults_of(run.folder, *finished, Check::Records).empty() &&
           (!experiment.decomposition || ensemble_of(experiment, run, results).contains(run.run.seed));
}

std::string point_key(const Experiment& experiment, const ExperimentPoint& point, const RunSettings& settings,
                      const Scene& scene, const std::string& reference_key) {
    const SceneEntry& entry = experiment.scenes[point.scene];
    Json probes = Json::array();
    for (const Probe& probe : entry.probes) probes.push_back({probe.name, probe.x, probe.y});
    return hash_text(Json{
        {"program", program_version().version},
        {"experiment", experiment.name},
        {"point", point.name},
        {"settings", settings_json(settings.method)},
        {"columns", csv_header()},
        {"passes", settings.passes},
        {"recorded", point.plan.recorded},
        {"width", scene.camera.width},
        {"height", scene.camera.height},
        {"samples_per_pixel", entry.samples_per_pixel},
        {"scene", scene.hash},
        {"probes", probes},
        {"reference",
         reference_key}}.dump());
}

std::string run_key(const std::string& point_key, const ExperimentRun& run) {
    return hash_text(fmt::format("{} {} {}", point_key, run.seed, Json(run.point->plan.snapshots).dump()));
}

RunSettings settings_of(const Experiment& experiment, const ExperimentRun& run, const Scene& scene) {
    const PassPlan& plan = run.point->plan;
    RunSettings settings{resolve(run.point->settings, scene.max_depth), run.seed, plan.passes, experiment.threads, {}};
    std::set_union(plan.recorded.begin(), plan.recorded.end(), plan.snapshots.begin(), plan.snapshots.end(),
                   std::back_inserter(settings.shown));
    return settings;
}

ReferenceSubject subject_of(const Scene& scene, int samples_per_pixel, const MethodSettings& method) {
    return {scene.hash,          scene.camera.width,
            scene.camera.height, samples_per_pixel,
            method.max_depth,    uses_setting(method, "positions") ? limit_of(method.positions) : Positions::Grid};
}

namespace {

/// Prepares runs, each scene, reference and point once.
class Preparation {
public:
    /// How closely what is there is looked at; not at all without a `check`.
    Preparation(const Experiment& experiment, const std::filesystem::path& results, std::optional<Check> check)
        : experiment_(experiment), results_(results), check_(check) {
        prepared_.scenes.resize(experiment.scenes.size());
    }

    void add(const ExperimentRun& run) {
        const Point& point = point_of(run);
        PreparedRun ready{run, point.settings, "", point.key, point.reference_key, results_ / "runs" / run.name};
        ready.settings.seed = run.seed;
        ready.key = run_key(point.key, run);
        ready.files =
            files_in(ready.folder, ready.key + (experiment_.decomposition ? ", with images for sums over seeds" : ""));
        ready.finished = check_ && is_as_it_finished(ready) && (!point.ensemble || point.ensemble->contains(run.seed));
        prepared_.runs.push_back(std::move(ready));
    }

    PreparedExperiment finish() {
        if (check_ && experiment_.decomposition) check_ensembles();
        return std::move(prepared_);
    }

private:
    /// What runs have in common that differ in their seed alone.
    struct Point {
        RunSettings settings;
        std::string key;
        std::string reference_key;
        std::optional<Ensemble> ensemble;
    };

    const Scene& scene_of(const ExperimentRun& run) {
        const SceneEntry& entry = experiment_.scenes[run.point->scene];
        std::optional<Scene>& scene = prepared_.scenes[run.point->scene];
        if (!scene) {
            scene = build_scene(load_scene_file(entry.file), entry.resolution);
            require_inside(experiment_.file, entry, *scene);
        }
        return *scene;
    }

    /// Empty without one.
    std::string reference_key_of(const ExperimentRun& run, const Scene& scene, const MethodSettings& method) {
        const SceneEntry& entry = experiment_.scenes[run.point->scene];
        if (!entry.reference) return "";
        const ReferenceSubject subject = subject_of(scene, entry.samples_per_pixel, method);
        const auto [known, is_new] =
            reference_keys_.try_emplace({run.point->scene, subject.max_depth, subject.positions});
        if (is_new) known->second = check_reference(*entry.reference, subject);
        return known->second;
    }

    const Point& point_of(const ExperimentRun& run) {
        const auto [known, is_new] = points_.try_emplace(run.point);
        Point& point = known->second;
        if (!is_new) return point;
        const Scene& scene = scene_of(run);
        point.settings = settings_of(experiment_, run, scene);
        try {
            require_renderable(point.settings.method, scene);
        } catch (const InputError& error) {
            throw InputError(experiment_.file.string(), fmt::format("run {}: {}", run.name, error.what()));
        }
        point.reference_key = reference_key_of(run, scene, point.settings.method);
        point.key = point_key(experiment_, *run.point, point.settings, scene, point.reference_key);
        if (check_ && experiment_.decomposition)
            point.ensemble = ensemble_of(experiment_, {run, point.settings, "", point.key}, results_);
        return point;
    }

    /// Of a run that finished with this key and is damaged it says so.
    bool is_as_it_finished(const PreparedRun& ready) {
        FoundRun found = look_at_run(ready.folder, [&](const FinishedRun& run) {
            return run.key == ready.key ? faults_of(ready.folder, run, *check_) : std::vector<std::string>{};
        });
        if (found.is_described && !found.run)
            found.faults.push_back((ready.folder / "run.json").string() + ": is damaged, or another program's");
        const bool is_sound = found.faults.empty();
        std::move(found.faults.begin(), found.faults.end(), std::back_inserter(prepared_.faults));
        return is_sound && found.run && found.run->key == ready.key;
    }

    /// Sums that something is still to be added to are read, where records are.
    void check_ensembles() {
        std::set<const ExperimentPoint*> unfinished;
        for (const PreparedRun& ready : prepared_.runs)
            if (!ready.finished) unfinished.insert(ready.run.point);
        for (auto& [which, point] : points_) {
            if (check_ != Check::Sizes && unfinished.contains(which)) point.ensemble->check_slots();
            const auto& faults = point.ensemble->faults();
            prepared_.faults.insert(prepared_.faults.end(), faults.begin(), faults.end());
        }
        for (PreparedRun& ready : prepared_.runs)
            ready.finished = ready.finished && points_.at(ready.run.point).ensemble->contains(ready.run.seed);
    }

    const Experiment& experiment_;
    const std::filesystem::path& results_;
    const std::optional<Check> check_;
    PreparedExperiment prepared_;
    std::map<std::tuple<std::size_t, int, Positions>, std::string> reference_keys_;  // by scene, depth and positions
    std::map<const ExperimentPoint*, Point> points_;
};

}  // namespace

PreparedExperiment prepare_experiment(const Experiment& experiment, const std::filesystem::path& results,
                                      const RunSelection& selection, Check check) {
    require_own_results(experiment, results);
    Preparation preparation(experiment, results, check);
    for (const ExperimentRun& run : select_runs(experiment, selection)) preparation.add(run);
    return preparation.finish();
}

PreparedExperiment prepare_all_keys(const Experiment& experiment, const std::filesystem::path& results) {
    require_own_results(experiment, results);
    Preparation preparation(experiment, results, std::nullopt);
    for (const ExperimentRun& run : runs_of(experiment)) preparation.add(run);
    return preparation.finish();
}

std::vector<RunsTogether> runs_together(const std::vector<PreparedRun>& runs, const RunsFit& fit) {
    std::vector<RunsTogether> groups;
    // Those that a run may fit into: of one scene and seed there are few.
    std::map<std::tuple<std::size_t, std::uint64_t, std::uint64_t, std::uint64_t>, std::vector<std::size_t>> alike;
    for (const PreparedRun& run : runs) {
        const RunSettings& settings = run.settings;
        auto& candidates =
            alike[{run.run.point->scene, settings.seed, settings.passes, settings.method.photons_per_pass}];
        const auto group = std::find_if(candidates.begin(), candidates.end(), [&](std::size_t candidate) {
            return groups[candidate].size() < most_runs_together && fit(groups[candidate][0]->settings, settings);
        });
        if (group != candidates.end()) {
            groups[*group].push_back(&run);
        } else {
            candidates.push_back(groups.size());
            groups.push_back({&run});
        }
    }
    for (auto& group : groups) std::erase_if(group, [](const PreparedRun* run) { return run->finished; });
    std::erase_if(groups, [](const auto& group) { return group.empty(); });
    return groups;
}

std::optional<GroupMemory> largest_memory(const Experiment& experiment, const PreparedExperiment& prepared,
                                          const std::vector<RunsTogether>& groups) {
    std::optional<GroupMemory> largest;
    std::set<std::string> known;
    std::map<std::size_t, MemoryEstimator> estimators;  // by scene
    for (const auto& group : groups) {
        std::vector<RunSettings> settings;
        std::string points;
        for (const PreparedRun* run : group) {
            settings.push_back(run->settings);
            points += run->run.point->name + "\n";
        }
        if (!known.insert(points).second) continue;
        const std::size_t scene = group[0]->run.point->scene;
        MemoryEstimator& estimator =
            estimators.try_emplace(scene, *prepared.scenes[scene], experiment.scenes[scene].samples_per_pixel)
                .first->second;
        const MemoryEstimate estimate = estimator.of(settings, images_kept(experiment, *group[0]));
        if (!largest || estimate.total() > largest->estimate.total()) largest = {group[0]->run.name, estimate};
    }
    return largest;
}

}  // namespace photonlab
