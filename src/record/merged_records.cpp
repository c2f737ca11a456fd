#include "record/merged_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <set>

#include "core/files/files.h"
#include "record/columns.h"
#include "record/run_record.h"

namespace photonlab {

const std::string probes_header =
    "schema,experiment,run,scene,seed,probe,x,y,pass,radius,photons,density,radiance_r,radiance_g,radiance_b";

namespace {

constexpr int merged_schema = 1;
constexpr const char* file_name = "merged.json";

/// A table that is merged.
struct Table {
    std::string name;
    std::string header;
    bool is_always_there;
    std::string rows;

    bool is_there() const { return is_always_there || !rows.empty(); }
    std::string text() const { return header + "\n" + rows; }
};

/// Reads the rows that a run has for each table; what keeps it from that otherwise.
std::optional<std::string> read_rows(const std::vector<Table>& tables, const std::filesystem::path& folder,
                                     const FinishedRun& run, std::vector<std::string>& rows) {
    rows.assign(tables.size(), "");
    for (std::size_t i = 0; i < tables.size(); ++i) {
        const auto stamp = run.files.find(tables[i].name);
        if (stamp == run.files.end()) continue;
        const std::filesystem::path file = folder / tables[i].name;
        if (auto fault = fault_of(file, stamp->second, Check::Sizes)) return fault;
        const std::optional<std::string> text = read_if_there(file);
        if (!text) return file.string() + ": is missing";
        if (auto fault = fault_of_text(file, *text, stamp->second)) return fault;
        const std::string start = tables[i].header + "\n";
        if (!text->starts_with(start)) return file.string() + ": its columns are not those of this program";
        rows[i] = text->substr(start.size());
    }
    return std::nullopt;
}

/// Appends the run's rows to the tables when it is finished, and counts it as what it is.
void merge_run(std::vector<Table>& tables, const RunToMerge& run, MergedRecords& merged) {
    std::vector<std::string> rows;
    const FoundRun found = look_at_run(run.folder, [&](const FinishedRun& finished) -> std::vector<std::string> {
        if (finished.key != run.key) return {};
        const auto fault = read_rows(tables, run.folder, finished, rows);
        return fault ? std::vector{*fault} : std::vector<std::string>{};
    });
    if (found.is_described && !found.run)
        merged.faults.push_back((run.folder / "run.json").string() + ": is damaged");
    else if (found.run && found.run->key != run.key)
        merged.of_other_settings.add(run.folder);
    else if (!found.faults.empty())
        merged.faults.push_back(found.faults[0]);
    else if (found.run) {
        for (std::size_t i = 0; i < tables.size(); ++i) tables[i].rows += rows[i];
        ++merged.runs;
    }
}

/// Finished runs beside those that are asked for.
CountedRuns count_other_runs(const std::filesystem::path& results, const std::vector<RunToMerge>& runs) {
    std::set<std::filesystem::path> known;
    for (const RunToMerge& run : runs) known.insert(run.folder);
    CountedRuns others;
    for (const std::filesystem::path& folder : entries_of(results / "runs"))
        if (!known.contains(folder) && is_there(folder / "run.json")) others.add(folder);
    return others;
}

void write_merged_files(const std::filesystem::path& results, const MergedFiles& merged) {
    Json files = Json::object();
    for (const auto& [name, stamps] : merged.files)
        std::transform(stamps.begin(), stamps.end(), std::back_inserter(files[name]), stamp_json);
    write_text_file(results / file_name,
                    with_checksum({{"schema", merged_schema}, {"experiment", merged.experiment}, {"files", files}}));
}

/// Replaces the tables that are not what they should be; removes one that was merged before and is empty now.
void write_tables(const std::string& experiment, const std::filesystem::path& results,
                  const std::vector<Table>& tables) {
    const std::optional<MergedFiles> before = read_merged_files(results);
    MergedFiles after{experiment, {}};
    for (const Table& table : tables)
        if (table.is_there()) after.files[table.name] = {stamp_of_text(table.text())};
    const auto is_written = [&](const Table& table) {
        const auto stamp = after.files.find(table.name);
        return stamp == after.files.end() ? !before || !before->files.contains(table.name)
                                          : !fault_of(results / table.name, stamp->second[0], Check::Records);
    };
    if (before == after && std::all_of(tables.begin(), tables.end(), is_written)) return;

    MergedFiles either = after;
    if (before)
        for (const auto& [name, stamps] : before->files)
            either.files[name].insert(either.files[name].end(), stamps.begin(), stamps.end());
    write_merged_files(results, either);
    for (const Table& table : tables) {
        if (is_written(table)) continue;
        if (table.is_there())
            write_text_file(results / table.name, table.text());
        else
            remove_if_there(results / table.name);
    }
    write_merged_files(results, after);
}

}  // namespace

void CountedRuns::add(const std::filesystem::path& folder) {
    if (++count == 1) first = folder.filename().string();
}

MergedRecords merge_records(const std::string& experiment, const std::filesystem::path& results,
                            const std::vector<RunToMerge>& runs) {
    std::vector<Table> tables{{"iterations.csv", csv_header(), true, ""}, {"probes.csv", probes_header, false, ""}};
    MergedRecords merged;
    for (const RunToMerge& run : runs) merge_run(tables, run, merged);
    merged.of_no_run = count_other_runs(results, runs);
    write_tables(experiment, results, tables);
    write_columns(results / "columns.json");
    return merged;
}

std::string describe_left_out(const MergedRecords& merged) {
    std::string text;
    const auto add = [&](const CountedRuns& runs, const char* what) {
        if (runs.count == 0) return;
        text += fmt::format("{}{} {} ({}{})", text.empty() ? "" : ", and ", runs.count, what, runs.first,
                            runs.count > 1 ? ", ..." : "");
    };
    add(merged.of_other_settings, "of other settings than the experiment has now, or of another program");
    add(merged.of_no_run, "that the experiment does not have");
    return text.empty() ? "" : "finished runs that are left out: " + text;
}

std::optional<MergedFiles> read_merged_files(const std::filesystem::path& results) {
    const std::optional<std::string> text = read_if_there(results / file_name);
    const std::optional<Json> json = text ? checked_json(*text) : std::nullopt;
    if (!json || json->value("schema", Json()) != merged_schema) return std::nullopt;
    MergedFiles merged;
    try {
        merged.experiment = json->at("experiment").get<std::string>();
        for (const auto& [name, stamps] : json->at("files").items())
            for (const Json& one : stamps) {
                const std::optional<FileStamp> stamp = stamp_from(one);
                if (!stamp) return std::nullopt;
                merged.files[name].push_back(*stamp);
            }
    } catch (const Json::exception&) {
        return std::nullopt;
    }
    return merged;
}

}  // namespace photonlab
