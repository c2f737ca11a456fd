#include "experiment/results_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <string>

#include "core/files/files.h"
#include "core/files/json.h"
#include "core/files/kept_files.h"
#include "core/machine/version.h"
#include "core/text/csv.h"
#include "record/recorder.h"

namespace photonlab {

namespace {

constexpr int schema = 1;
constexpr std::uintmax_t largest_json = std::uintmax_t{1} << 24;  // bytes
constexpr const char* advice = "choose another folder for the results";

std::filesystem::path description_file(const std::filesystem::path& results) {
    return results / "experiment.json";
}

std::string quoted(const std::string& name) {
    return json_text(name);
}

std::string whole_path(const std::filesystem::path& file) {
    return std::filesystem::absolute(file).lexically_normal().string();
}

/// What a JSON file says of its experiment; empty when it is not there, or says nothing.
std::optional<std::string> experiment_in(const std::filesystem::path& file) {
    const std::optional<std::string> text = read_if_there(file);
    const Json json = text ? parse_sound_json(*text).value_or(Json()) : Json();
    const auto found = json.is_object() ? json.find("experiment") : json.end();
    if (found == json.end() || !found->is_string()) return std::nullopt;
    return found->get<std::string>();
}

/// True of a folder that is not empty, and of a file.
bool holds_anything(const std::filesystem::path& name) {
    return is_folder(name) ? !entries_of(name).empty() : is_there(name);
}

/// Refuses a description that is there and is not of the experiment.
void require_own_json(const Experiment& experiment, const std::filesystem::path& file) {
    if (!is_there(file)) return;
    const auto named = experiment_in(file);
    if (named && *named == experiment.name) return;
    throw InputError(file.string(), fmt::format("is there already, and says nothing of the experiment {}; {}",
                                                quoted(experiment.name), advice));
}

/// Refuses a table that is there and has no rows of the experiment.
void require_own_table(const Experiment& experiment, const std::filesystem::path& file) {
    if (!is_there(file)) return;
    require_ordinary_file(file);
    std::ifstream stream(file, std::ios::binary);
    std::string start(std::size_t{1} << 16, '\0');  // the header and the first row are in it
    stream.read(start.data(), static_cast<std::streamsize>(start.size()));
    start.resize(static_cast<std::size_t>(stream.gcount()));
    const std::string row = start.substr(std::min(start.find('\n'), start.size() - 1) + 1);
    const bool is_of_this =
        row.substr(std::min(row.find(','), row.size())).starts_with(fmt::format(",{},", csv_cell(experiment.name)));
    if (start.empty()) return;
    if (!start.starts_with("schema,experiment,run,") || (!row.empty() && !is_of_this))
        throw InputError(file.string(), fmt::format("is there already, and is no table of the experiment {}; {}",
                                                    quoted(experiment.name), advice));
}

/// Refuses a folder that is there and holds something, unless one of its own folders at least says in `file` that it is
/// the experiment's, and none says that it is another's.
void require_own_folders(const Experiment& experiment, const std::filesystem::path& folder, const std::string& file) {
    if (!holds_anything(folder)) return;
    bool is_ours = false;
    const auto entries = is_folder(folder) ? entries_of(folder) : std::vector<std::filesystem::path>{};
    for (const std::filesystem::path& entry : entries) {
        const auto named = experiment_in(entry / file);
        if (named && *named != experiment.name)
            throw InputError((entry / file).string(), fmt::format("this is of the experiment {}, not of {}; {}",
                                                                  quoted(*named), quoted(experiment.name), advice));
        is_ours = is_ours || named;
    }
    if (!is_ours)
        throw InputError(folder.string(), fmt::format("is there already, and holds nothing of the experiment {}; {}",
                                                      quoted(experiment.name), advice));
}

/// What experiment.json should be.
std::string description_of(const Experiment& experiment) {
    return with_checksum({{"schema", schema},
                          {"experiment", experiment.name},
                          {"smoke", experiment.is_smoke},
                          {"title", experiment.title},
                          {"file", whole_path(experiment.file)},
                          {"program", {{"name", "photonlab"}, {"version", program_version().version}}}});
}

/// What experiment.json is; an empty object when it is not there or damaged.
Json description_in(const std::filesystem::path& results) {
    return checked_json(read_if_there(description_file(results), largest_json).value_or("")).value_or(Json::object());
}

bool has_any_run_of(const Experiment& experiment, const std::filesystem::path& results) {
    const std::vector<ExperimentRun> runs = runs_of(experiment);
    return std::any_of(runs.begin(), runs.end(),
                       [&](const ExperimentRun& run) { return is_there(results / "runs" / run.name); });
}

/// Refuses what experiment.json says, if it is not of this experiment.
void require_own_description(const Experiment& experiment, const std::filesystem::path& results) {
    const std::filesystem::path file = description_file(results);
    const Json json = description_in(results);
    const auto text = [&](const char* name) {
        const auto found = json.find(name);
        return found != json.end() && found->is_string() ? std::optional(found->get<std::string>()) : std::nullopt;
    };
    const auto name = text("experiment");
    if (!name || json.value("schema", Json()) != schema)
        throw InputError(file.string(), fmt::format("does not say whose results these are; {}, or remove this file if "
                                                    "they are of the experiment {}",
                                                    advice, quoted(experiment.name)));
    const bool is_smoke = json.value("smoke", Json(false)) == true;
    if (*name != experiment.name)
        throw InputError(file.string(), fmt::format("these are results of the experiment {}, not of {}; {}",
                                                    quoted(*name), quoted(experiment.name), advice));
    if (is_smoke != experiment.is_smoke)
        throw InputError(file.string(),
                         fmt::format("these are results {} --smoke; {}", is_smoke ? "of" : "without", advice));
    // The file may have been moved, or be mounted elsewhere; but one that shares nothing with these but its name is
    // another.
    const std::string here = whole_path(experiment.file);
    const auto there = text("file");
    if (there && *there != here && holds_anything(results / "runs") && !has_any_run_of(experiment, results))
        throw InputError(file.string(), fmt::format("these are results of {}, which has no run in common with {}; {}",
                                                    *there, here, advice));
}

/// Refuses a folder without a description that has results of somebody else.
void require_unclaimed(const Experiment& experiment, const std::filesystem::path& results) {
    require_own_json(experiment, results / "merged.json");
    require_own_table(experiment, results / "iterations.csv");
    require_own_table(experiment, results / "probes.csv");
    require_own_folders(experiment, results / "runs", "run.json");
    require_own_folders(experiment, results / "ensembles", "ensemble.json");
}

}  // namespace

void require_own_results(const Experiment& experiment, const std::filesystem::path& results) {
    if (!is_there(description_file(results))) {
        try {
            return require_unclaimed(experiment, results);
        } catch (const InputError&) {
            if (!is_there(description_file(results))) throw;  // else another job has begun there meanwhile
        }
    }
    require_own_description(experiment, results);
}

void claim_results(const Experiment& experiment, const std::filesystem::path& results) {
    require_own_results(experiment, results);
    make_folder(results);
    if (!is_claimed(experiment, results)) write_text_file(description_file(results), description_of(experiment));
}

bool is_claimed(const Experiment& experiment, const std::filesystem::path& results) {
    return read_if_there(description_file(results), largest_json) == description_of(experiment);
}

std::optional<std::string> experiment_of_results(const std::filesystem::path& results) {
    const Json name = description_in(results).value("experiment", Json());
    return name.is_string() ? std::optional(name.get<std::string>()) : std::nullopt;
}

Experiment read_experiment_of_results(const std::filesystem::path& results,
                                      const std::optional<std::filesystem::path>& file) {
    if (!is_folder(results)) throw InputError(results.string(), "is no folder");
    const Json description = description_in(results);
    const Json named = description.value("file", Json());
    if (!named.is_string() || description.value("schema", Json()) != schema)
        throw InputError(description_file(results).string(),
                         "expected the description of an experiment's results, which `photonlab run` writes");
    const std::filesystem::path read_from = file.value_or(named.get<std::string>());
    if (!is_there(read_from))
        throw InputError(read_from.string(),
                         fmt::format("is not there, and {} names it; say where it is with --experiment",
                                     description_file(results).string()));
    return read_experiment(read_from,
                           description.value("smoke", Json()) == true ? std::optional(SmokeLimits{}) : std::nullopt);
}

}  // namespace photonlab
