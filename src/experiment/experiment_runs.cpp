#include "experiment/experiment_runs.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <map>

#include "core/files.h"
#include "core/hash.h"
#include "experiment/progress.h"
#include "experiment/reference.h"
#include "experiment/run_estimate.h"
#include "experiment/run_record.h"
#include "experiment/version.h"
#include "scene/loader.h"

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

/// Everything that changes what a run records.
std::string run_key(const Experiment& experiment, const ExperimentRun& run, const RunSettings& settings,
                    const Scene& scene, const std::string& reference_key) {
    return hash_text(Json{
        {"program", program_version().version},
        {"experiment", experiment.name},
        {"title", experiment.title},
        {"run", run.name},
        {"settings", settings_json(settings.method)},
        {"seed", settings.seed},
        {"passes", settings.passes},
        {"recorded", experiment.recorded},
        {"snapshots", experiment.snapshots},
        {"threads", settings.threads},
        {"width", scene.camera.width},
        {"height", scene.camera.height},
        {"samples_per_pixel", experiment.samples_per_pixel},
        {"scene", scene.hash},
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

bool contains(const std::vector<std::uint64_t>& sorted, std::uint64_t pass) {
    return std::binary_search(sorted.begin(), sorted.end(), pass);
}

/// Runs one run into its folder; run.json goes first and comes last, so that no half-made run looks finished.
void execute(const Experiment& experiment, const PreparedRun& prepared, const Scene& scene, const HitPoints& hit_points,
             const Reference* reference, const PassListener& on_pass, std::string& summary) {
    const SceneEntry& entry = experiment.scenes[prepared.run->scene];
    const auto began = std::chrono::steady_clock::now();
    RunRecord record{experiment.title,
                     prepared.run->method,
                     prepared.key,
                     entry.file,
                     std::chrono::system_clock::now(),
                     0.0,
                     experiment.recorded,
                     {}};
    std::filesystem::remove(prepared.folder / "run.json");
    std::filesystem::remove_all(prepared.folder / "snapshots");
    make_folder(prepared.folder / "snapshots");
    reset_peak_resident();

    Recorder recorder({experiment.name, prepared.run->name, entry.name, prepared.settings, scene.camera.width,
                       scene.camera.height, experiment.samples_per_pixel, hit_points.points.size()},
                      reference, prepared.folder / "iterations.csv");
    const RunState last = run_method(
        scene, hit_points, prepared.settings,
        [&](const RunState& state, const Image& image) {
            if (contains(experiment.recorded, state.pass)) recorder.record(state, image);
            if (!contains(experiment.snapshots, state.pass)) return;
            const std::string file = "snapshots/" + snapshot_name(state.pass);
            write_exr(prepared.folder / file, image, image_metadata(recorder.identity(), state, scene));
            record.snapshots.push_back({state.pass, file});
        },
        on_pass);
    record.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    write_text_file(prepared.folder / "run.json",
                    run_json(record, recorder, last, scene, hit_points, reference).dump(2) + "\n");

    summary = fmt::format("finished {} in {}", prepared.run->name, describe_duration(record.seconds));
    if (recorder.last_total_errors()) summary += fmt::format(", rmse {:.4g}", recorder.last_total_errors()->rmse);
    if (recorder.nonfinite_pixels() > 0) summary += ", with non-finite pixels (run.json says where)";
}

/// The rows of every finished run, in the experiment's order.
std::size_t merge_records(const Experiment& experiment, const std::filesystem::path& results,
                          const std::map<std::string, std::string>& keys) {
    std::string merged = csv_header() + "\n";
    std::size_t count = 0;
    for (const ExperimentRun& run : experiment.runs) {
        const auto key = keys.find(run.name);
        const std::filesystem::path folder = results / "runs" / run.name;
        if (key == keys.end() || !is_finished(folder, key->second)) continue;
        const std::string rows = read_text_file(folder / "iterations.csv");
        const std::size_t header_end = rows.find('\n');
        if (header_end == std::string::npos || rows.substr(0, header_end) != csv_header())
            throw InputError((folder / "iterations.csv").string(),
                             "its columns are not those of this program; delete it");
        merged += rows.substr(header_end + 1);
        ++count;
    }
    write_text_file(results / "iterations.csv", merged);
    return count;
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
        if (!scene) scene = build_scene(load_scene_file(entry.file), entry.resolution);

        PreparedRun ready;
        ready.run = run;
        ready.settings.method = resolve(run->settings, scene->max_depth);
        ready.settings.seed = run->seed;
        ready.settings.passes = experiment.passes;
        ready.settings.threads = experiment.threads;
        std::set_union(experiment.recorded.begin(), experiment.recorded.end(), experiment.snapshots.begin(),
                       experiment.snapshots.end(), std::back_inserter(ready.settings.estimated));
        std::string reference_key;
        if (entry.reference) {
            const auto [known, is_new] = reference_keys.try_emplace({run->scene, ready.settings.method.max_depth});
            if (is_new)
                known->second = check_reference(*entry.reference, subject_of(*scene, experiment.samples_per_pixel,
                                                                             ready.settings.method.max_depth));
            reference_key = known->second;
        }
        ready.key = run_key(experiment, *run, ready.settings, *scene, reference_key);
        ready.folder = results / "runs" / run->name;
        ready.finished = is_finished(ready.folder, ready.key);
        prepared.runs.push_back(std::move(ready));
    }
    return prepared;
}

ExperimentOutcome run_experiment(const Experiment& experiment, const PreparedExperiment& prepared,
                                 const std::filesystem::path& results) {
    ExperimentOutcome outcome;
    outcome.records = results / "iterations.csv";
    require_writable(outcome.records);

    const auto to_do = static_cast<std::uint64_t>(std::count_if(prepared.runs.begin(), prepared.runs.end(),
                                                                [](const PreparedRun& run) { return !run.finished; }));
    Progress progress(to_do * experiment.passes);
    std::optional<std::size_t> current_scene;
    std::optional<HitPoints> hit_points;
    std::optional<Reference> reference;
    int reference_depth = -1;
    std::uint64_t passes_before = 0;
    for (const PreparedRun& ready : prepared.runs) {
        if (ready.finished) {
            ++outcome.skipped;
            continue;
        }
        const SceneEntry& entry = experiment.scenes[ready.run->scene];
        const Scene& scene = *prepared.scenes[ready.run->scene];
        const int max_depth = ready.settings.method.max_depth;
        if (current_scene != ready.run->scene) {
            hit_points = trace_hit_points(scene, experiment.samples_per_pixel, experiment.threads);
            reference.reset();
        }
        if (entry.reference && (!reference || reference_depth != max_depth))
            reference = load_reference(*entry.reference, subject_of(scene, experiment.samples_per_pixel, max_depth));
        current_scene = ready.run->scene;
        reference_depth = max_depth;

        const std::string counted = fmt::format("run {} of {}: {}", outcome.ran + 1, to_do, ready.run->name);
        progress.show(passes_before, counted);
        std::string summary;
        execute(
            experiment, ready, scene, *hit_points, reference ? &*reference : nullptr,
            [&](std::uint64_t pass) { progress.show(passes_before + pass, counted); }, summary);
        passes_before += experiment.passes;
        ++outcome.ran;
        progress.finished(summary);
    }
    progress.clear();

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
    HitPoints hit_points;
    double seconds = 0.0;
    double mebibytes = 0.0;
    for (const PreparedRun& ready : prepared.runs) {
        if (ready.finished) {
            list += fmt::format("{:<{}}  finished\n", ready.run->name, width);
            continue;
        }
        const Scene& scene = *prepared.scenes[ready.run->scene];
        if (current_scene != ready.run->scene)
            hit_points = trace_hit_points(scene, experiment.samples_per_pixel, experiment.threads);
        current_scene = ready.run->scene;
        const auto [known, is_new] =
            estimates.try_emplace(fmt::format("{} {}", ready.run->scene, settings_json(ready.settings.method).dump()));
        if (is_new) known->second = estimate_run(scene, hit_points, ready.settings);
        const RunEstimate& estimate = known->second;
        seconds += estimate.seconds;
        mebibytes = std::max(mebibytes, estimate.mebibytes);
        list += fmt::format("{:<{}}  about {}, {:.0f} MiB\n", ready.run->name, width,
                            describe_duration(estimate.seconds), estimate.mebibytes);
    }
    list +=
        fmt::format("\n{} runs of {} passes on {} threads: about {} in all, at most {:.0f} MiB\n", prepared.runs.size(),
                    experiment.passes, experiment.threads, describe_duration(seconds), mebibytes);
    return list;
}

}  // namespace photonlab
