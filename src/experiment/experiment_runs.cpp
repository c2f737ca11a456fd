#include "experiment/experiment_runs.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/files.h"
#include "core/hash.h"
#include "experiment/progress.h"
#include "experiment/recorder.h"
#include "experiment/reference.h"
#include "experiment/run_estimate.h"
#include "experiment/version.h"
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

/// True when the folder holds a run that finished with this key.
bool is_finished(const std::filesystem::path& folder, const std::string& key) {
    const std::filesystem::path file = folder / "run.json";
    if (!std::filesystem::exists(file) || !std::filesystem::exists(folder / "iterations.csv")) return false;
    const Json json = Json::parse(read_text_file(file), nullptr, false);
    if (!json.is_object()) return false;
    const auto finished = json.find("finished");
    const auto stored = json.find("key");
    return finished != json.end() && *finished == true && stored != json.end() && *stored == key;
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
void require_inside(const SceneEntry& entry, const Scene& scene) {
    const int width = scene.camera.width;
    const int height = scene.camera.height;
    for (const Region& region : entry.regions)
        if (region.right > width || region.bottom > height)
            throw InputError(entry.file.string(),
                             fmt::format("region {}: expected pixels inside {}x{}, got up to {} {}", region.name, width,
                                         height, region.right, region.bottom));
    for (const Probe& probe : entry.probes)
        if (probe.x >= width || probe.y >= height)
            throw InputError(entry.file.string(), fmt::format("probe {}: expected a pixel inside {}x{}, got {} {}",
                                                              probe.name, width, height, probe.x, probe.y));
}

/// What is not finished, in groups that share their photons and hit points.
std::vector<std::vector<const PreparedRun*>> runs_together(const std::vector<PreparedRun>& runs) {
    std::vector<std::vector<const PreparedRun*>> groups;
    for (const PreparedRun& run : runs) {
        if (run.finished) continue;
        const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& candidate) {
            return candidate[0]->run->scene == run.run->scene && can_run_together(candidate[0]->settings, run.settings);
        });
        if (group != groups.end())
            group->push_back(&run);
        else
            groups.push_back({&run});
    }
    return groups;
}

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
            require_inside(entry, *scene);
        }

        PreparedRun ready;
        ready.run = run;
        ready.settings.method = resolve(run->settings, scene->max_depth);
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
        ready.finished = is_finished(ready.folder, ready.key) &&
                         (!experiment.decomposition || ensemble_of(experiment, ready, results).contains(run->seed));
        prepared.runs.push_back(std::move(ready));
    }
    return prepared;
}

ExperimentOutcome run_experiment(const Experiment& experiment, const PreparedExperiment& prepared,
                                 const std::filesystem::path& results, const ContinuationOptions& options) {
    ExperimentOutcome outcome;
    outcome.records = results / "iterations.csv";
    require_writable(outcome.records);
    if (!options.fresh)
        for (const PreparedRun& ready : prepared.runs)
            if (!ready.finished) is_usable(checkpoint_of(experiment, ready));

    const std::vector<std::vector<const PreparedRun*>> groups = runs_together(prepared.runs);
    for (const PreparedRun& ready : prepared.runs) outcome.skipped += ready.finished;
    std::uint64_t passes = 0;
    for (const auto& group : groups) passes += group[0]->settings.passes;
    Progress progress(passes);
    std::uint64_t passes_before = 0;
    std::optional<std::size_t> current_scene;
    double current_cutoff = 0.0;
    std::optional<HitPoints> hit_points;
    std::optional<Reference> reference;
    int reference_depth = -1;
    for (std::size_t i = 0; i < groups.size(); ++i) {
        const PreparedRun& first = *groups[i].at(0);
        const SceneEntry& entry = experiment.scenes[first.run->scene];
        const Scene& scene = *prepared.scenes[first.run->scene];
        const int max_depth = first.settings.method.max_depth;
        const double cutoff = first.settings.method.branch_cutoff;
        if (current_scene != first.run->scene) reference.reset();
        if (current_scene != first.run->scene || current_cutoff != cutoff)
            hit_points = trace_hit_points(scene, experiment.samples_per_pixel, experiment.threads, cutoff);
        if (current_scene != first.run->scene)
            for (const std::string& reason : why_images_are_plain(scene, *hit_points))
                progress.finished(entry.name + ": " + reason);
        if (entry.reference && (!reference || reference_depth != max_depth))
            reference = load_reference(*entry.reference, subject_of(scene, experiment.samples_per_pixel, max_depth));
        current_scene = first.run->scene;
        current_cutoff = cutoff;
        reference_depth = max_depth;

        const std::string others = groups[i].size() > 1 ? fmt::format(" and {} more", groups[i].size() - 1) : "";
        const std::string counted = fmt::format("{} of {}: {}{}", i + 1, groups.size(), first.run->name, others);
        progress.show(passes_before, counted);
        const GroupOutcome made =
            run_group({experiment, scene, *hit_points, reference ? &*reference : nullptr, results, groups[i]}, options,
                      [&](std::uint64_t pass) { progress.show(passes_before + pass, counted); });
        outcome.is_interrupted = !made.is_finished;
        if (outcome.is_interrupted) break;
        passes_before += first.settings.passes;
        outcome.ran += groups[i].size();
        progress.finished(made.summary);
    }
    progress.clear();
    if (experiment.decomposition)
        for (const PreparedRun& ready : prepared.runs) ensemble_of(experiment, ready, results).describe();

    // Runs outside the selection may be finished too: their keys need their scenes, so all are prepared for the merge.
    std::map<std::string, std::string> keys;
    const bool is_all = prepared.runs.size() == experiment.runs.size();
    const PreparedExperiment all = is_all ? PreparedExperiment{} : prepare_experiment(experiment, results);
    for (const PreparedRun& ready : is_all ? prepared.runs : all.runs) keys[ready.run->name] = ready.key;
    outcome.merged = merge_records(experiment, results, keys);
    return outcome;
}

std::string list_runs(const Experiment& experiment, const PreparedExperiment& prepared) {
    std::size_t width = 0;
    for (const PreparedRun& ready : prepared.runs) width = std::max(width, ready.run->name.size());
    std::string list = fmt::format("{}\n\n", experiment.title);
    std::map<std::string, RunEstimate> estimates;  // by scene and settings: seeds do not change them
    std::optional<std::size_t> current_scene;
    double current_cutoff = 0.0;
    HitPoints hit_points;
    double seconds = 0.0;
    double mebibytes = 0.0;
    std::set<const PreparedRun*> first_of_group;
    for (const auto& group : runs_together(prepared.runs)) first_of_group.insert(group[0]);
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
            estimates.try_emplace(fmt::format("{} {}", ready.run->scene, settings_json(ready.settings.method).dump()));
        if (is_new) known->second = estimate_run(scene, hit_points, ready.settings);
        const RunEstimate& estimate = known->second;
        seconds += estimate.seconds - (first_of_group.contains(&ready) ? 0.0 : estimate.trace_seconds);
        mebibytes = std::max(mebibytes, estimate.mebibytes);
        list += fmt::format("{:<{}}  about {}, {:.0f} MiB\n", ready.run->name, width,
                            describe_duration(estimate.seconds), estimate.mebibytes);
    }
    const auto by_passes = [](const PreparedRun& a, const PreparedRun& b) {
        return a.settings.passes < b.settings.passes;
    };
    const auto [fewest, most] = std::minmax_element(prepared.runs.begin(), prepared.runs.end(), by_passes);
    const std::string passes = fewest->settings.passes == most->settings.passes
                                   ? fmt::format("{}", most->settings.passes)
                                   : fmt::format("{} to {}", fewest->settings.passes, most->settings.passes);
    list += fmt::format("\n{} runs of {} passes on {} threads: about {} in all, at most {:.0f} MiB\n",
                        prepared.runs.size(), passes, experiment.threads, describe_duration(seconds), mebibytes);
    return list;
}

}  // namespace photonlab
