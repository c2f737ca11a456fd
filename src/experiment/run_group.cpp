#include "experiment/run_group.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>

#include "core/files/file_lock.h"
#include "core/files/files.h"
#include "core/text/csv.h"
#include "core/text/progress.h"
#include "image/exr.h"
#include "image/png.h"
#include "integrators/registry.h"
#include "record/emission_table.h"
#include "record/merged_records.h"
#include "record/recorder.h"
#include "record/run/run_record.h"

namespace photonlab {

namespace {

bool contains(const std::vector<std::uint64_t>& sorted, std::uint64_t pass) {
    return std::binary_search(sorted.begin(), sorted.end(), pass);
}

/// The hit point of a pixel that carries most of it: the only one, but for several samples a pixel, mirrors and glass.
std::optional<std::size_t> heaviest_hit_point(const HitPoints& hit_points, const Probe& probe) {
    const auto pixel = static_cast<std::uint32_t>(probe.y * hit_points.width + probe.x);
    std::optional<std::size_t> heaviest;
    for (std::size_t i = 0; i < hit_points.points.size(); ++i) {
        if (hit_points.points[i].pixel != pixel) continue;
        if (!heaviest || mean_channel(ColorD(hit_points.points[i].weight)) >
                             mean_channel(ColorD(hit_points.points[*heaviest].weight)))
            heaviest = i;
    }
    return heaviest;
}

/// What the probes of a scene show of a method, a row each.
std::string probe_rows(const RunIdentity& identity, const std::vector<Probe>& probes, const HitPoints& hit_points,
                       std::uint64_t pass, const Integrator& integrator) {
    std::string rows;
    for (const Probe& probe : probes) {
        const auto hit_point = heaviest_hit_point(hit_points, probe);
        const auto state = hit_point ? integrator.gather_state(*hit_point) : std::nullopt;
        if (!state) continue;
        rows += fmt::format("1,{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_cell(identity.experiment),
                            csv_cell(identity.run), csv_cell(identity.scene), identity.settings.seed,
                            csv_cell(probe.name), probe.x, probe.y, pass, state->radius, state->photons,
                            state->density ? fmt::format("{}", *state->density) : "", state->radiance.x,
                            state->radiance.y, state->radiance.z);
    }
    return rows;
}

/// A run while it is running.
struct OpenRun {
    const PreparedRun* prepared;
    RunRecord record;
    Recorder recorder;
    std::vector<PassImage> recorded_images;  // for the ensemble
    std::string probes;                      // rows
    std::vector<FileStamp> snapshots;        // that are written, in the order of record.snapshots
    RunState last_shown = {};

    const RunFiles& files() const { return prepared->files; }
};

void exchange(StateArchive& archive, PassImage& image) {
    archive.exchange(image.pass);
    archive.exchange(image.image.width);
    archive.exchange(image.image.height);
    archive.exchange_each(image.image.layers, [](StateArchive& each, Layer& layer) {
        each.exchange(layer.name);
        each.exchange(layer.pixels);
    });
}

/// A run that goes on has one more session than it had: this one.
void exchange(StateArchive& archive, std::vector<Session>& sessions) {
    const Session own = sessions.back();
    archive.exchange_each(sessions, [](StateArchive& each, Session& session) {
        each.exchange(session.host);
        each.exchange(session.process);
        each.exchange(session.job);
        each.exchange(session.processor);
        each.exchange(session.threads);
        each.exchange(session.until_pass);
    });
    if (!archive.reads()) return;
    sessions.push_back(own);
    if (sessions.size() > 1) sessions.back().until_pass = sessions[sessions.size() - 2].until_pass;
}

/// What a run holds beside the state of its method.
void exchange(StateArchive& archive, OpenRun& run) {
    exchange(archive, run.record.sessions);
    archive.exchange(run.record.started);
    archive.exchange(run.record.seconds);
    run.recorder.exchange(archive);
    archive.exchange_each(run.recorded_images, [](StateArchive& each, PassImage& image) { exchange(each, image); });
    archive.exchange(run.probes);
    archive.exchange_each(run.snapshots, [](StateArchive& each, FileStamp& stamp) {
        each.exchange(stamp.bytes);
        each.exchange(stamp.hash);
    });
}

/// The state of a method and what its run holds beside it.
StateExchange with_state_of(OpenRun& run, const StateExchange& method) {
    return [&run, &method](StateArchive& archive) {
        method(archive);
        exchange(archive, run);
    };
}

/// What a run has left elsewhere than in its rows goes, but for its checkpoint, which is set aside.
void begin_anew(const RunFiles& files) {
    for (const std::filesystem::path& file : {files.description, files.probes, files.emission, files.snapshots})
        if (!file.empty()) std::filesystem::remove_all(file);
    set_aside(files.checkpoint);
}

OpenRun open_run(const RunGroup& group, const PreparedRun& prepared) {
    const SceneEntry& entry = group.experiment.scenes[prepared.run.point->scene];
    std::vector<Snapshot> snapshots;
    for (const std::uint64_t pass : prepared.run.point->plan.snapshots)
        snapshots.push_back({pass, prepared.files.snapshot(pass).lexically_relative(prepared.folder).generic_string()});
    RunIdentity identity{group.experiment.name,      prepared.run.name,       entry.name,
                         prepared.run.point->method, prepared.settings,       group.scene.camera.width,
                         group.scene.camera.height,  entry.samples_per_pixel, group.hit_points.points.size()};
    return {&prepared,
            RunRecord{group.experiment.title,
                      prepared.run.point->method,
                      prepared.key,
                      entry.file,
                      std::chrono::system_clock::now(),
                      0.0,
                      group.runs.size(),
                      {this_session(prepared.settings.threads)},
                      prepared.run.point->plan.recorded,
                      std::move(snapshots),
                      std::nullopt,
                      {}},
            Recorder(std::move(identity), group.reference, prepared.files.rows),
            {},
            {},
            {}};
}

/// Adds the run's images to the sums over seeds; false when it was interrupted while it waited for another process that
/// adds to them.
bool add_to_ensemble(const RunGroup& group, const OpenRun& run, const ContinuationOptions& options) {
    const auto lock = lock_ensemble(*run.prepared, group.results, options.is_interrupted);
    if (!lock) return false;
    options.require_held();
    ensemble_of(group.experiment, *run.prepared, group.results)
        .add(run.prepared->run.seed, run.prepared->run.seed_place, run.recorded_images);
    return true;
}

/// What the run has written so far must be there when it is said to be finished. Where it is not, the checkpoint, which
/// goes on from later passes, is of no use any more.
void require_snapshots(const OpenRun& run) {
    for (std::size_t i = 0; i < run.snapshots.size(); ++i) {
        const std::filesystem::path file = run.files().snapshot(run.record.snapshots[i].pass);
        const auto fault = fault_of(file, run.snapshots[i], Check::Everything);
        if (!fault) continue;
        discard(run.files().checkpoint);
        throw InputError(*fault + ", a moment ago; its run begins anew the next time");
    }
}

/// How a run that is finished is told of.
std::string summary_of(const RunGroup& group, const OpenRun& run, const RunState& last) {
    std::string line = fmt::format("finished {} in {}", run.prepared->run.name, describe_duration(last.times.total()));
    if (run.recorder.last_total_errors()) line += ", rmse " + describe_rmse(*run.recorder.last_total_errors());
    if (run.recorder.nonfinite_pixels() > 0) line += ", with non-finite pixels (run.json says where)";
    if (const auto note = note_of_raised_radii(run.prepared->settings.method, group.scene, group.hit_points))
        line += "; " + *note;
    return line;
}

/// Writes what is written once all passes are done.
void finish(const RunGroup& group, OpenRun& run, const RunState& last) {
    const RunFiles& files = run.files();
    require_snapshots(run);
    if (!files.probes.empty() && !run.probes.empty()) {
        const std::string probes = probes_header + "\n" + run.probes;
        write_text_file(files.probes, probes);
        run.record.files["probes.csv"] = stamp_of_text(probes);
    }
    if (!files.emission.empty() && last.emission_map) {
        const std::string emission = emission_table(group.scene, *last.emission_map);
        write_text_file(files.emission, emission);
        run.record.files["emission.csv"] = stamp_of_text(emission);
    }
    if (!files.description.empty()) {
        run.record.files["iterations.csv"] = run.recorder.stamp();
        for (std::size_t i = 0; i < run.snapshots.size(); ++i)
            run.record.files[run.record.snapshots[i].file] = run.snapshots[i];
        if (group.experiment.decomposition)
            run.record.ensemble = {"ensembles/" + run.prepared->run.point->name, run.prepared->point_key};
        write_text_file(files.description, with_checksum(run_json(run.record, run.recorder, last, group.scene,
                                                                  group.hit_points, group.reference)));
    }
    if (!files.keeps_state) discard(files.checkpoint);
}

/// The runs of a group side by side, from their checkpoints to what is written when they are finished.
class RunningGroup {
public:
    RunningGroup(const RunGroup& group, const ContinuationOptions& options);

    GroupOutcome run(const PassListener& on_pass);

private:
    void restore(std::size_t method, const StateExchange& state);
    bool goes_on(std::uint64_t pass, const std::vector<StateExchange>& states);
    void save_all(std::uint64_t pass, const std::vector<StateExchange>& states);
    void take(std::size_t method, const RunState& state, const Image& image);
    GroupOutcome outcome(const std::vector<RunState>& last);
    void count_seconds();
    void come_to(std::uint64_t pass);

    using Clock = std::chrono::steady_clock;

    const RunGroup& group_;
    const ContinuationOptions& options_;
    std::vector<OpenRun> open_;  // by the index of their methods
    std::vector<RunSettings> settings_;
    std::uint64_t ended_at_;     // the last pass, as planned or as found good enough
    Clock::time_point counted_;  // up to here, time is in the records
    CheckpointClock saves_;
    bool is_interrupted_ = false;
};

RunningGroup::RunningGroup(const RunGroup& group, const ContinuationOptions& options)
    : group_(group), options_(options), saves_(options.seconds_between_saves) {
    for (const PreparedRun* prepared : group.runs) {
        open_.push_back(open_run(group, *prepared));
        settings_.push_back(prepared->settings);
    }
    ended_at_ = settings_.at(0).passes;
    reset_peak_resident();
    counted_ = Clock::now();
}

void RunningGroup::count_seconds() {
    const auto now = Clock::now();
    for (OpenRun& run : open_) run.record.seconds += std::chrono::duration<double>(now - counted_).count();
    counted_ = now;
}

void RunningGroup::come_to(std::uint64_t pass) {
    for (OpenRun& run : open_) {
        Session& session = run.record.sessions.back();
        session.until_pass = std::max(session.until_pass, pass);  // one that was ahead of the others stays so
    }
}

void RunningGroup::restore(std::size_t method, const StateExchange& state) {
    options_.require_held();
    OpenRun& run = open_[method];
    if (options_.fresh || !load(run.files().checkpoint, with_state_of(run, state))) begin_anew(run.files());
    if (!run.files().snapshots.empty()) make_folder(run.files().snapshots);
}

void RunningGroup::save_all(std::uint64_t pass, const std::vector<StateExchange>& states) {
    count_seconds();
    come_to(pass);
    options_.require_held();
    for (std::size_t i = 0; i < open_.size(); ++i)
        save(open_[i].files().checkpoint, with_state_of(open_[i], states[i]));
    saves_.saved();
}

bool RunningGroup::goes_on(std::uint64_t pass, const std::vector<StateExchange>& states) {
    const bool is_due = saves_.is_due_after_pass();
    const bool is_last = pass == settings_[0].passes;
    if (!is_last)
        is_interrupted_ = options_.is_interrupted();
    else if (group_.experiment.decomposition)
        is_interrupted_ = !std::all_of(open_.begin(), open_.end(),
                                       [&](const OpenRun& run) { return add_to_ensemble(group_, run, options_); });
    const bool is_kept = is_last && open_[0].files().keeps_state;
    if (is_interrupted_ || (is_due && !is_last) || is_kept) save_all(pass, states);
    return !is_interrupted_;
}

/// The image of a pass that somebody asked for.
void RunningGroup::take(std::size_t method, const RunState& state, const Image& image) {
    options_.require_held();
    OpenRun& run = open_[method];
    run.last_shown = state;
    const PassPlan& plan = run.prepared->run.point->plan;
    const bool is_last = state.pass == ended_at_;
    if ((state.pass < plan.passes && is_last) || contains(plan.recorded, state.pass)) {
        run.recorder.record(state, image);
        if (group_.experiment.decomposition) run.recorded_images.push_back({state.pass, image});
    }
    if (state.pass < plan.passes && is_last && !run.record.snapshots.empty()) {  // the planned last one
        run.record.snapshots[run.snapshots.size()] = run.record.snapshots.back();
        run.record.snapshots.resize(run.snapshots.size() + 1);
    }
    if (contains(plan.snapshots, is_last ? plan.passes : state.pass)) {
        const std::filesystem::path file = run.files().snapshot(is_last ? plan.passes : state.pass);
        write_exr(file, image, image_metadata(run.recorder.identity(), state, group_.scene));
        run.snapshots.push_back(stamp_of(file));
    }
    if (is_last && !run.files().picture.empty())
        write_png(run.files().picture, image.width, image.height, total(image));
}

/// Writes what is written at the end, but for runs that were interrupted.
GroupOutcome RunningGroup::outcome(const std::vector<RunState>& last) {
    GroupOutcome outcome{.passes = last[0].pass};
    if (is_interrupted_) return outcome;
    count_seconds();
    come_to(outcome.passes);
    for (std::size_t i = 0; i < open_.size(); ++i) {
        options_.require_held();
        finish(group_, open_[i], last[i]);
        outcome.runs.push_back(
            {open_[i].last_shown, open_[i].recorder.last_total_errors(), summary_of(group_, open_[i], last[i])});
    }
    outcome.is_finished = true;
    return outcome;
}

GroupOutcome RunningGroup::run(const PassListener& on_pass) {
    const std::vector<Probe>& probes = group_.experiment.scenes[group_.runs[0]->run.point->scene].probes;
    Continuation continuation{
        .restore = [&](std::size_t method, const StateExchange& state) { restore(method, state); },
        .goes_on = [&](std::uint64_t pass, const std::vector<StateExchange>& states) { return goes_on(pass, states); },
        .is_good_enough = {}};
    if (options_.is_good_enough)
        continuation.is_good_enough = [&](std::uint64_t pass, const Image& image) {
            if (!options_.is_good_enough(image)) return false;
            ended_at_ = pass;
            return true;
        };
    return outcome(run_methods(
        group_.scene, group_.hit_points, settings_,
        [&](std::size_t method, const RunState& state, const Image& image) { take(method, state, image); }, on_pass,
        [&](std::size_t method, std::uint64_t pass, const Integrator& integrator) {
            OpenRun& run = open_[method];
            run.probes += probe_rows(run.recorder.identity(), probes, group_.hit_points, pass, integrator);
        },
        continuation));
}

}  // namespace

RunFiles files_in(const std::filesystem::path& folder, const std::string& identity) {
    return {folder / "iterations.csv",
            folder / "probes.csv",
            folder / "emission.csv",
            folder / "run.json",
            folder / "snapshots",
            [folder](std::uint64_t pass) { return folder / "snapshots" / snapshot_name(pass); },
            {folder / "checkpoint", identity, "remove it, or begin anew beside it with --fresh"}};
}

Ensemble ensemble_of(const Experiment& experiment, const PreparedRun& prepared, const std::filesystem::path& results) {
    const SceneEntry& entry = experiment.scenes[prepared.run.point->scene];
    Json regions = Json::object();
    for (const Region& region : entry.regions)
        regions[region.name] = {region.left, region.top, region.right, region.bottom};
    return Ensemble(results / "ensembles" / prepared.run.point->name, prepared.point_key,
                    {{"experiment", experiment.name},
                     {"title", experiment.title},
                     {"point", prepared.run.point->name},
                     {"scene", entry.name},
                     {"method", prepared.run.point->method},
                     {"photons_carry_direct", photons_carry_direct(prepared.settings.method)},
                     {"reference", entry.reference ? Json{{"path", entry.reference->string()}} : Json()},
                     {"working_directory", working_directory()},
                     {"regions", regions},
                     {"passes", prepared.run.point->plan.recorded}});
}

std::optional<FileLock> lock_ensemble(const PreparedRun& prepared, const std::filesystem::path& results,
                                      const std::function<bool()>& is_interrupted) {
    return FileLock::wait_for(results / "ensembles" / (prepared.run.point->name + ".lock"), is_interrupted);
}

GroupOutcome run_group(const RunGroup& group, const ContinuationOptions& options, const PassListener& on_pass) {
    return RunningGroup(group, options).run(on_pass);
}

}  // namespace photonlab
