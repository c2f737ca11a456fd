#include "record/merged_records.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <iterator>
#include <set>

#include "core/error.h"
#include "core/files/descriptor.h"
#include "core/files/files.h"
#include "core/files/temporary_file.h"
#include "core/hash.h"
#include "record/columns.h"
#include "record/run/run_record.h"

namespace photonlab {

const std::string probes_header =
    "schema,experiment,run,scene,seed,probe,x,y,pass,radius,photons,density,radiance_r,radiance_g,radiance_b";

namespace {

constexpr int merged_schema = 1;
constexpr const char* file_name = "merged.json";

/// A table while it is merged. As long as its text is that of the file which is there, nothing is written; from the
/// first difference on it goes to a temporary file. In memory are the rows of one run.
class Table {
public:
    Table(std::filesystem::path file, std::string header, bool is_always_there)
        : file_(std::move(file)),
          header_(std::move(header)),
          is_always_there_(is_always_there),
          before_(file_, O_RDONLY, Links::Followed) {
        append(header_ + "\n");
        has_rows_ = false;
    }

    std::string name() const { return file_.filename().string(); }
    const std::string& header() const { return header_; }

    /// Empty when there is to be no such file.
    std::optional<FileStamp> stamp() const {
        if (!is_always_there_ && !has_rows_) return std::nullopt;
        return FileStamp{size_, hash_.text()};
    }

    void append(std::string_view rows) {
        has_rows_ = has_rows_ || !rows.empty();
        if (!temporary_ && !is_at(rows)) write_from_here();
        if (temporary_) write(rows, size_);
        size_ += rows.size();
        hash_.add(rows.data(), rows.size());
    }

    /// Whether the file is not as it should be.
    bool is_to_be_replaced() const {
        if (!stamp()) return is_there(file_);
        struct stat status;
        return temporary_ || ::fstat(before_.number(), &status) != 0 ||
               static_cast<std::uint64_t>(status.st_size) != size_;
    }

    /// Replaces the file, or removes it.
    void replace() {
        if (!stamp()) return remove_if_there(file_);
        if (!temporary_) write_from_here();
        temporary_->rename();
    }

private:
    /// Whether the file has this text where it would be appended.
    bool is_at(std::string_view text) const { return before_.is_open() && read(size_, text.size()) == text; }

    std::string read(std::uint64_t position, std::size_t bytes) const {
        std::string text(bytes, '\0');
        std::size_t done = 0;
        while (done < bytes) {
            const ssize_t count =
                ::pread(before_.number(), text.data() + done, bytes - done, static_cast<off_t>(position + done));
            if (count <= 0) break;
            done += static_cast<std::size_t>(count);
        }
        text.resize(done);
        return text;
    }

    /// Begins the temporary file with what has been found in the one that is there.
    void write_from_here() {
        constexpr std::uint64_t block = std::uint64_t{1} << 20;
        temporary_.emplace(file_);
        for (std::uint64_t at = 0; at < size_; at += block) write(read(at, std::min(block, size_ - at)), at);
    }

    void write(std::string_view text, std::uint64_t position) {
        if (!temporary_->descriptor().write(text, static_cast<off_t>(position)))
            throw InputError(file_.string(), std::string("cannot be written: ") + std::strerror(errno));
    }

    std::filesystem::path file_;
    std::string header_;
    bool is_always_there_;
    Descriptor before_;
    std::optional<TemporaryFile> temporary_;
    bool has_rows_ = false;
    std::uint64_t size_ = 0;
    RunningHash hash_;
};

using Tables = std::array<Table, 2>;

/// Reads the rows that a run has for each table; what keeps it from that otherwise.
std::optional<std::string> read_rows(const Tables& tables, const std::filesystem::path& folder, const FinishedRun& run,
                                     std::vector<std::string>& rows) {
    rows.assign(tables.size(), "");
    for (std::size_t i = 0; i < tables.size(); ++i) {
        const auto stamp = run.files.find(tables[i].name());
        if (stamp == run.files.end()) continue;
        const std::filesystem::path file = folder / tables[i].name();
        if (auto fault = fault_of(file, stamp->second, Check::Sizes)) return fault;
        const std::optional<std::string> text = read_if_there(file);
        if (!text) return file.string() + ": is missing";
        if (auto fault = fault_of_text(file, *text, stamp->second)) return fault;
        const std::string start = tables[i].header() + "\n";
        if (!text->starts_with(start)) return file.string() + ": its columns are not those of this program";
        rows[i] = text->substr(start.size());
    }
    return std::nullopt;
}

/// Appends the run's rows to the tables when it is finished, and counts it as what it is.
void merge_run(Tables& tables, const RunToMerge& run, MergedRecords& merged) {
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
        for (std::size_t i = 0; i < tables.size(); ++i) tables[i].append(rows[i]);
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
void write_tables(const std::string& experiment, const std::filesystem::path& results, Tables& tables) {
    const std::optional<MergedFiles> before = read_merged_files(results);
    MergedFiles after{experiment, {}};
    for (const Table& table : tables)
        if (const auto stamp = table.stamp()) after.files[table.name()] = {*stamp};
    // A table that was never merged and is to have no rows is somebody else's, and stays.
    const auto is_to_be_replaced = [&](const Table& table) {
        return (table.stamp() || (before && before->files.contains(table.name()))) && table.is_to_be_replaced();
    };
    if (before == after && std::none_of(tables.begin(), tables.end(), is_to_be_replaced)) return;

    MergedFiles either = after;
    if (before)
        for (const auto& [name, stamps] : before->files)
            either.files[name].insert(either.files[name].end(), stamps.begin(), stamps.end());
    write_merged_files(results, either);
    for (Table& table : tables)
        if (is_to_be_replaced(table)) table.replace();
    write_merged_files(results, after);
}

}  // namespace

void CountedRuns::add(const std::filesystem::path& folder) {
    if (++count == 1) first = folder.filename().string();
}

MergedRecords merge_records(const std::string& experiment, const std::filesystem::path& results,
                            const std::vector<RunToMerge>& runs) {
    Tables tables{Table(results / "iterations.csv", csv_header(), true),
                  Table(results / "probes.csv", probes_header, false)};
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
