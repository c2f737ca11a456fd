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
#include "core/text/progress.h"
#include "experiment/results_folder.h"
#include "integrators/registry.h"
#include "record/recorder.h"
#include "record/run_record.h"
#include "record/settings_json.h"
#include "reference/reference.h"
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

bool is_made(const Experiment& experiment, const PreparedRun& run, const std::filesystem::path& results) {
    const std::optional<FinishedRun> finished = read_finished_run(run.folder);
    return finished && finished->key == run.key && faults_of(run.folder, *finished, Check::Records).empty() &&
           (!experiment.decomposition || ensemble_of(experiment, run, results).contains(run.run->seed));
}

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
        {"columns", csv_header()},
        {"passes", settings.passes},
        {"recorded", run.plan.recorded},
        {"width", scene.camera.width},
        {"height", scene.camera.height},
        {"samples_per_pixel", entry.samples_per_pixel},
        {"scene", scene.hash},
        {"probes", probes},
        {"reference",
         reference_key}}.dump());
}

std::string run_key(const std::string& point_key, const ExperimentRun& run) {
    return hash_text(fmt::format("{} {} {}", point_key, run.seed, Json(run.plan.snapshots).dump()));
}

RunSettings settings_of(const Experiment& experiment, const ExperimentRun& run, const Scene& scene) {
    RunSettings settings{resolve(run.settings, scene.max_depth), run.seed, run.plan.passes, experiment.threads, {}};
    std::set_union(run.plan.recorded.begin(), run.plan.recorded.end(), run.plan.snapshots.begin(),
                   run.plan.snapshots.end(), std::back_inserter(settings.shown));
    return settings;
}

ReferenceSubject subject_of(const Scene& scene, int samples_per_pixel, const MethodSettings& method) {
    return {scene.hash,          scene.camera.width,
            scene.camera.height, samples_per_pixel,
            method.max_depth,    uses_setting(method, "positions") ? method.positions : Positions::Grid};
}

namespace {

/// Prepares runs, each scene, reference and point once.
class Preparation {
public:
    Preparation(const Experiment& experiment, const std::filesystem::path& results, Check check)
        : experiment_(experiment), results_(results), check_(check) {
        prepared_.scenes.resize(experiment.scenes.size());
    }

    void add(const ExperimentRun& run) {
        const Point& point = point_of(run);
        PreparedRun ready{&run, point.settings, "", point.key, point.reference_key, results_ / "runs" / run.name};
        ready.settings.seed = run.seed;
        ready.key = run_key(point.key, run);
        ready.files =
            files_in(ready.folder, ready.key + (experiment_.decomposition ? ", with images for sums over seeds" : ""));
        ready.finished = is_as_it_finished(ready) && (!point.ensemble || point.ensemble->contains(run.seed));
        prepared_.runs.push_back(std::move(ready));
    }

    PreparedExperiment finish() {
        if (experiment_.decomposition) check_ensembles();
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
        const SceneEntry& entry = experiment_.scenes[run.scene];
        std::optional<Scene>& scene = prepared_.scenes[run.scene];
        if (!scene) {
            scene = build_scene(load_scene_file(entry.file), entry.resolution);
            require_inside(experiment_.file, entry, *scene);
        }
        return *scene;
    }

    /// Empty without one.
    std::string reference_key_of(const ExperimentRun& run, const Scene& scene, const MethodSettings& method) {
        const SceneEntry& entry = experiment_.scenes[run.scene];
        if (!entry.reference) return "";
        const ReferenceSubject subject = subject_of(scene, entry.samples_per_pixel, method);
        const auto [known, is_new] = reference_keys_.try_emplace({run.scene, subject.max_depth, subject.positions});
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
            require_resolvable(point.settings.method, scene);
        } catch (const InputError& error) {
            throw InputError(experiment_.file.string(), fmt::format("run {}: {}", run.name, error.what()));
        }
        point.reference_key = reference_key_of(run, scene, point.settings.method);
        point.key = point_key(experiment_, run, point.settings, scene, point.reference_key);
        if (experiment_.decomposition)
            point.ensemble = ensemble_of(experiment_, {&run, point.settings, "", point.key}, results_);
        return point;
    }

    /// Of a run that finished with this key and is damaged it says so.
    bool is_as_it_finished(const PreparedRun& ready) {
        FoundRun found = look_at_run(ready.folder, [&](const FinishedRun& run) {
            return run.key == ready.key ? faults_of(ready.folder, run, check_) : std::vector<std::string>{};
        });
        if (found.is_described && !found.run)
            found.faults.push_back((ready.folder / "run.json").string() + ": is damaged, or another program's");
        const bool is_sound = found.faults.empty();
        std::move(found.faults.begin(), found.faults.end(), std::back_inserter(prepared_.faults));
        return is_sound && found.run && found.run->key == ready.key;
    }

    /// Sums that something is still to be added to are read, where records are.
    void check_ensembles() {
        std::set<std::string> unfinished;
        for (const PreparedRun& ready : prepared_.runs)
            if (!ready.finished) unfinished.insert(ready.run->point);
        for (auto& [name, point] : points_) {
            if (check_ != Check::Sizes && unfinished.contains(name)) point.ensemble->check_slots();
            const auto& faults = point.ensemble->faults();
            prepared_.faults.insert(prepared_.faults.end(), faults.begin(), faults.end());
        }
        for (PreparedRun& ready : prepared_.runs)
            ready.finished = ready.finished && points_.at(ready.run->point).ensemble->contains(ready.run->seed);
    }

    const Experiment& experiment_;
    const std::filesystem::path& results_;
    const Check check_;
    PreparedExperiment prepared_;
    std::map<std::tuple<std::size_t, int, Positions>, std::string> reference_keys_;  // by scene, depth and positions
    std::map<std::string, Point> points_;                                            // by name
};

}  // namespace

PreparedExperiment prepare_experiment(const Experiment& experiment, const std::filesystem::path& results,
                                      const std::optional<std::string>& only, Check check) {
    require_own_results(experiment, results);
    Preparation preparation(experiment, results, check);
    for (const ExperimentRun* run : select_runs(experiment, only)) preparation.add(*run);
    return preparation.finish();
}

std::vector<RunsTogether> runs_together(const std::vector<PreparedRun>& runs, const RunsFit& fit) {
    std::vector<RunsTogether> groups;
    // Those that a run may fit into: of one scene and seed there are few.
    std::map<std::tuple<std::size_t, std::uint64_t, std::uint64_t, std::uint64_t>, std::vector<std::size_t>> alike;
    for (const PreparedRun& run : runs) {
        const RunSettings& settings = run.settings;
        auto& candidates = alike[{run.run->scene, settings.seed, settings.passes, settings.method.photons_per_pass}];
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
            points += run->run->point + "\n";
        }
        if (!known.insert(points).second) continue;
        const std::size_t scene = group[0]->run->scene;
        MemoryEstimator& estimator =
            estimators.try_emplace(scene, *prepared.scenes[scene], experiment.scenes[scene].samples_per_pixel)
                .first->second;
        const MemoryEstimate estimate = estimator.of(settings, images_kept(experiment, *group[0]));
        if (!largest || estimate.total() > largest->estimate.total()) largest = {group[0]->run->name, estimate};
    }
    return largest;
}

namespace {

struct Cost {
    TimeEstimate time;
    double mebibytes = 0.0;
};

/// What each run takes, estimated once a point.
class Costs {
public:
    Costs(const Experiment& experiment, const PreparedExperiment& prepared, const TimeEstimator& estimate)
        : experiment_(experiment), prepared_(prepared), estimate_(estimate) {}

    const Cost& of(const PreparedRun& run) {
        const auto [known, is_new] = costs_.try_emplace(run.run->point);
        if (!is_new) return known->second;
        const std::size_t index = run.run->scene;
        const Scene& scene = *prepared_.scenes[index];
        const int samples_per_pixel = experiment_.scenes[index].samples_per_pixel;
        MemoryEstimator& memory = memory_.try_emplace(index, scene, samples_per_pixel).first->second;
        const double cutoff = run.settings.method.branch_cutoff;
        const auto [view, is_view_new] = views_.try_emplace({index, cutoff});
        if (is_view_new) view->second = trace_coarse_view(scene, samples_per_pixel, experiment_.threads, cutoff);
        known->second = {estimate_(scene, view->second, run.settings),
                         memory.of({run.settings}, images_kept(experiment_, run)).total()};
        return known->second;
    }

private:
    const Experiment& experiment_;
    const PreparedExperiment& prepared_;
    const TimeEstimator& estimate_;
    std::map<std::string, Cost> costs_;                           // by point
    std::map<std::size_t, MemoryEstimator> memory_;               // by scene
    std::map<std::pair<std::size_t, double>, CoarseView> views_;  // by scene and cutoff
};

/// "64", or "16 to 64"; never of no runs.
std::string passes_text(const std::vector<PreparedRun>& runs) {
    const auto [fewest, most] = std::minmax_element(
        runs.begin(), runs.end(),
        [](const PreparedRun& a, const PreparedRun& b) { return a.settings.passes < b.settings.passes; });
    return fewest->settings.passes == most->settings.passes
               ? fmt::format("{}", most->settings.passes)
               : fmt::format("{} to {}", fewest->settings.passes, most->settings.passes);
}

}  // namespace

std::string list_runs(const Experiment& experiment, const PreparedExperiment& prepared, const TimeEstimator& estimate) {
    std::size_t width = 0;
    for (const PreparedRun& ready : prepared.runs) width = std::max(width, ready.run->name.size());
    std::string list = fmt::format("{}\n\n", experiment.title);
    Costs costs(experiment, prepared, estimate);
    double seconds = 0.0;
    const auto groups = runs_together(prepared.runs);
    std::set<const PreparedRun*> first_of_group;
    for (const auto& group : groups) first_of_group.insert(group[0]);
    for (const PreparedRun& ready : prepared.runs) {
        if (ready.finished) {
            list += fmt::format("{:<{}}  finished\n", ready.run->name, width);
            continue;
        }
        const auto& [time, mebibytes] = costs.of(ready);
        seconds += time.seconds - (first_of_group.contains(&ready) ? 0.0 : time.trace_seconds);
        list += fmt::format("{:<{}}  about {}, up to {:.0f} MiB\n", ready.run->name, width,
                            describe_duration(time.seconds), mebibytes);
    }
    list += fmt::format("\n{} runs of {} passes on {} threads: about {} in all\n", prepared.runs.size(),
                        passes_text(prepared.runs), experiment.threads, describe_duration(seconds));
    if (const auto largest = largest_memory(experiment, prepared, groups))
        list += fmt::format("memory of runs that share photons: {}\n", describe(largest->estimate));
    return list;
}

}  // namespace photonlab
