#include "experiment/merged_records.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "core/files.h"
#include "experiment/recorder.h"
#include "experiment/run_record.h"

namespace photonlab {

const std::string probes_header =
    "schema,experiment,run,scene,seed,probe,x,y,pass,radius,photons,density,radiance_r,radiance_g,radiance_b";

namespace {

constexpr int schema = 1;
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

/// Appends the run's rows to the tables that it has; what keeps it from that otherwise.
std::optional<std::string> append_rows(std::vector<Table>& tables, const std::filesystem::path& folder,
                                       const FinishedRun& run) {
    std::vector<std::string> rows(tables.size());
    for (std::size_t i = 0; i < tables.size(); ++i) {
        const auto stamp = run.files.find(tables[i].name);
        if (stamp == run.files.end()) continue;
        const std::filesystem::path file = folder / tables[i].name;
        if (auto fault = fault_of(file, stamp->second, Check::Sizes)) return fault;
        std::string text = read_text_file(file);
        if (auto fault = fault_of_text(file, text, stamp->second)) return fault;
        const std::string start = tables[i].header + "\n";
        if (!text.starts_with(start)) return file.string() + ": its columns are not those of this program";
        rows[i] = text.substr(start.size());
    }
    for (std::size_t i = 0; i < tables.size(); ++i) tables[i].rows += rows[i];
    return std::nullopt;
}

void write_merged_files(const std::filesystem::path& results, const MergedFiles& merged) {
    Json files = Json::object();
    for (const auto& [name, stamps] : merged.files)
        std::transform(stamps.begin(), stamps.end(), std::back_inserter(files[name]), stamp_json);
    write_text_file(results / file_name,
                    with_checksum({{"schema", schema}, {"experiment", merged.experiment}, {"files", files}}));
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
            std::filesystem::remove(results / table.name);
    }
    write_merged_files(results, after);
}

}  // namespace

MergedRecords merge_records(const std::string& experiment, const std::filesystem::path& results,
                            const std::vector<RunToMerge>& runs) {
    std::vector<Table> tables{{"iterations.csv", csv_header(), true, ""}, {"probes.csv", probes_header, false, ""}};
    MergedRecords merged;
    for (const RunToMerge& run : runs) {
        const std::filesystem::path file = run.folder / "run.json";
        const std::optional<FinishedRun> finished = read_finished_run(run.folder);
        if (!finished) {
            if (std::filesystem::exists(file)) merged.faults.push_back(file.string() + ": is damaged");
            continue;
        }
        if (finished->key != run.key) continue;
        if (auto fault = append_rows(tables, run.folder, *finished))
            merged.faults.push_back(std::move(*fault));
        else
            ++merged.runs;
    }
    write_tables(experiment, results, tables);
    return merged;
}

std::optional<MergedFiles> read_merged_files(const std::filesystem::path& results) {
    const std::filesystem::path file = results / file_name;
    if (!std::filesystem::exists(file)) return std::nullopt;
    const std::optional<Json> json = checked_json(read_text_file(file));
    if (!json || json->value("schema", Json()) != schema) return std::nullopt;
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
