#include "record/run/run_record.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <unistd.h>

#include "core/files/files.h"
#include "core/machine/host.h"
#include "core/machine/version.h"
#include "integrators/registry.h"
#include "integrators/settings/chosen_settings.h"

namespace photonlab {

namespace {

constexpr int run_schema = 2;

std::string utc(std::chrono::system_clock::time_point time) {
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::chrono::system_clock::to_time_t(time)));
}

/// What run.json says; empty when it is damaged or another program's.
std::optional<FinishedRun> finished_run_in(const std::string& text) {
    const std::optional<Json> json = checked_json(text);
    if (!json || json->value("schema", Json()) != run_schema || json->value("finished", Json()) != true)
        return std::nullopt;
    FinishedRun run;
    try {
        run.experiment = json->at("experiment").get<std::string>();
        run.run = json->at("run").get<std::string>();
        run.key = json->at("key").get<std::string>();
        run.seed = json->at("seed").get<std::uint64_t>();
        if (const Json& ensemble = json->at("ensemble"); !ensemble.is_null())
            run.ensemble = {ensemble.at("folder").get<std::string>(), ensemble.at("key").get<std::string>()};
        if (const Json& reference = json->at("reference"); !reference.is_null())
            run.reference = {reference.at("path").get<std::string>(), reference.at("key").get<std::string>(),
                             json->at("working_directory").get<std::string>()};
        for (const auto& [name, value] : json->at("files").items()) {
            const std::optional<FileStamp> stamp = stamp_from(value);
            if (!stamp) return std::nullopt;
            run.files.emplace(name, *stamp);
        }
    } catch (const Json::exception&) {
        return std::nullopt;
    }
    return run;
}

Json optional_json(const std::optional<double>& value) {
    return value ? Json(*value) : Json();
}

}  // namespace

Session this_session(int threads) {
    return {host_name(), ::getpid(), slurm_job(), processor_name(), threads, 0};
}

Json run_json(const RunRecord& record, const Recorder& recorder, const RunState& last, const Scene& scene,
              const HitPoints& hit_points, const Reference* reference) {
    const RunIdentity& identity = recorder.identity();
    const MethodSettings& method = identity.settings.method;
    const ProgramVersion program = program_version();

    Json nonfinite_pixels = Json::array();
    for (const NonfinitePixel& pixel : recorder.first_nonfinite_pixels())
        nonfinite_pixels.push_back(
            {{"pass", pixel.pass}, {"component", pixel.component}, {"x", pixel.x}, {"y", pixel.y}});
    Json snapshots = Json::array();
    for (const Snapshot& snapshot : record.snapshots)
        snapshots.push_back({{"pass", snapshot.pass}, {"file", snapshot.file}});
    Json sessions = Json::array();
    for (const Session& session : record.sessions)
        sessions.push_back({{"host", session.host},
                            {"process", session.process},
                            {"job", session.job.empty() ? Json() : Json(session.job)},
                            {"processor", session.processor},
                            {"threads", session.threads},
                            {"until_pass", session.until_pass}});
    Json files = Json::object();
    for (const auto& [name, stamp] : record.files) files[name] = stamp_json(stamp);
    const bool has_radius = uses_setting(method, "radius");

    return Json{
        {"schema", run_schema},
        {"finished", true},
        {"key", record.key},
        {"experiment", identity.experiment},
        {"title", record.title},
        {"run", identity.run},
        {"method", record.method},
        {"settings", settings_json(method)},
        {"seed", identity.settings.seed},
        {"passes", identity.settings.passes},
        {"recorded", record.recorded},
        {"threads", identity.settings.threads},
        {"width", identity.width},
        {"height", identity.height},
        {"samples_per_pixel", identity.samples_per_pixel},
        {"scene",
         {{"name", identity.scene},
          {"file", record.scene_file.string()},
          {"hash", scene.hash},
          {"unit_length", scene.unit_length},
          {"bounding_radius", scene.bounding_radius * scene.unit_length},
          {"total_power", scene.total_power * scene.unit_length * scene.unit_length}}},
        {"reference", reference
                          ? Json{{"path", reference->path.string()},
                                 {"key", reference->key},
                                 {"floor_mse", optional_json(reference->floor_mse)},
                                 {"check", {{"verdict", reference->check.verdict}, {"why", reference->check.why}}}}
                          : Json()},
        {"radius",
         {{"rule", has_radius ? Json(method.radius ? "given" : "auto") : Json()},
          {"initial_mean", has_radius ? optional_json(last.initial_radius) : Json()},
          {"maximum", uses_setting(method, "max_radius") ? optional_json(last.initial_radius) : Json()}}},
        {"counters",
         {{"hit_points", identity.hit_points},
          {"paths_emitted", last.paths_emitted},
          {"paths_traced", last.paths_traced},
          {"photons_stored", last.photons_stored},
          {"photons_gathered", last.report.photons_gathered},
          {"paths_cut", last.paths_cut},
          {"power_cut", last.power_cut},
          {"photons_left_out", last.report.photons_left_out},
          {"inexact_additions", last.report.inexact_additions},
          {"camera_weight_cut", hit_points.weight_cut},
          {"raised_radii", count_raised_radii(method, hit_points)},
          {"nonfinite_camera_paths", hit_points.nonfinite},
          {"nonfinite_photons", last.nonfinite_photons + last.nonfinite_in_maps},
          {"nonfinite_pixels", recorder.nonfinite_pixels()}}},
        {"nonfinite_pixels", nonfinite_pixels},
        {"snapshots", snapshots},
        {"ensemble",
         record.ensemble ? Json{{"folder", record.ensemble->folder}, {"key", record.ensemble->key}} : Json()},
        {"files", files},
        {"program",
         {{"name", "photonlab"},
          {"version", program.version},
          {"commit", program.commit},
          {"compiler", program.compiler},
          {"compiler_flags", program.compiler_flags}}},
        {"processor", processor_name()},
        {"sessions", sessions},
        {"resumed", record.sessions.size() - 1},
        {"started", utc(record.started)},
        {"seconds", record.seconds},
        {"runs_together", record.runs_together},
        {"working_directory", working_directory()},
    };
}

std::optional<FinishedRun> read_finished_run(const std::filesystem::path& folder) {
    const std::optional<std::string> text = read_if_there(folder / "run.json");
    return text ? finished_run_in(*text) : std::nullopt;
}

std::vector<std::string> faults_of(const std::filesystem::path& folder, const FinishedRun& run, Check check) {
    std::vector<std::string> faults;
    for (const auto& [name, stamp] : run.files)
        if (auto fault = fault_of(folder / name, stamp, check)) faults.push_back(std::move(*fault));
    return faults;
}

FoundRun look_at_run(const std::filesystem::path& folder,
                     const std::function<std::vector<std::string>(const FinishedRun&)>& find_faults) {
    const std::filesystem::path file = folder / "run.json";
    std::optional<std::string> text = read_if_there(file);
    while (true) {
        FoundRun found{text.has_value(), text ? finished_run_in(*text) : std::nullopt, {}};
        if (!found.run) return found;
        found.faults = find_faults(*found.run);
        if (found.faults.empty()) return found;
        std::optional<std::string> now = read_if_there(file);
        if (now == text) return found;
        text = std::move(now);
    }
}

Metadata image_metadata(const RunIdentity& identity, const RunState& state, const Scene& scene) {
    const RunSettings& settings = identity.settings;
    const ProgramVersion program = program_version();
    Metadata metadata{
        {"photonlab.experiment", identity.experiment},
        {"photonlab.run", identity.run},
        {"photonlab.scene", identity.scene},
        {"photonlab.scene_hash", scene.hash},
        {"photonlab.seed", std::to_string(settings.seed)},
        {"photonlab.pass", std::to_string(count_passes(state.ranges))},
        {"photonlab.paths_emitted", std::to_string(state.paths_emitted)},
        {"photonlab.samples_per_pixel", std::to_string(identity.samples_per_pixel)},
        {"photonlab.threads", std::to_string(settings.threads)},
        {"photonlab.version", std::string(program.version)},
        {"photonlab.commit", std::string(program.commit)},
    };
    for (const SettingField& field : setting_fields())
        if (uses_setting(settings.method, field.name))
            metadata[fmt::format("photonlab.{}", field.name)] = setting_text(settings.method, field);
    if (state.initial_radius) metadata["photonlab.radius_initial"] = fmt::format("{}", *state.initial_radius);
    return metadata;
}

std::string snapshot_name(std::uint64_t pass) {
    return fmt::format("pass-{:06}.exr", pass);
}

}  // namespace photonlab
