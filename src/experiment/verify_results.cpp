#include "experiment/verify_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "core/error.h"
#include "core/files/files.h"
#include "core/files/kept_files.h"
#include "core/text/number_in.h"
#include "core/text/text.h"
#include "experiment/results_folder.h"
#include "image/exr.h"
#include "record/images/ensemble.h"
#include "record/merged_records.h"
#include "record/run/run_record.h"
#include "reference/reference.h"
#include "render/checkpoint.h"

namespace photonlab {

namespace {

constexpr const char* run_again = "`photonlab run` makes the run again";
constexpr const char* merge_again = "`photonlab run` merges the records again";

/// What processes keep beside the files that they make, and leave when they are killed.
bool is_of_work(const std::filesystem::path& file) {
    const std::string name = file.filename().string();
    return name == "lock" || name == "checkpoint" || name == "checkpoint.old" || name.ends_with(".lock") ||
           name.find(".partial-") != std::string::npos;
}

/// The sums of a point.
struct Sums {
    std::string key;
    std::map<std::uint64_t, std::string> slots;  // name by seed
};

/// What is found, one part of the folder after another.
class Verifier {
public:
    explicit Verifier(const std::filesystem::path& results) : results_(results) {}

    Verification verify() {
        for (const std::filesystem::path& folder : entries_of(results_ / "runs")) guarded([&] { check_run(folder); });
        guarded([&] {
            for (const std::filesystem::path& folder : entries_of(results_ / "ensembles"))
                guarded([&] { check_ensemble(folder); });
        });
        guarded([&] { check_experiment(); });
        guarded([&] { check_merged(); });
        for (const auto& run : finished_)
            if (run.second.reference) guarded([&] { check_reference(run.first, *run.second.reference); });
        if (unfinished_ > 0) note(results_ / "runs", fmt::format("{} runs are not finished", unfinished_));
        return std::move(found_);
    }

private:
    void fault(const std::filesystem::path& file, const std::string& what) {
        found_.faults.push_back(file.string() + ": " + what);
    }

    void note(const std::filesystem::path& file, const std::string& what) {
        found_.notes.push_back(file.string() + ": " + what);
    }

    /// What cannot be read is a fault, and the rest is gone on with.
    template <typename Step>
    void guarded(const Step& step) {
        try {
            step();
        } catch (const InputError& error) {
            found_.faults.push_back(error.what());
        }
    }

    void check_run(const std::filesystem::path& folder) {
        if (!is_folder(folder)) return fault(folder, "is no folder of a run");
        const std::filesystem::path description = folder / "run.json";
        if (is_there(folder / "checkpoint")) guarded([&] { require_whole_checkpoint(folder / "checkpoint"); });
        std::size_t sound_files = 0;
        const FoundRun found =
            look_at_run(folder, [&](const FinishedRun& run) { return check_files_of(folder, run, sound_files); });
        if (found.is_described && !found.run)
            return fault(description, fmt::format("is damaged, or another program's; {}", run_again));
        if (!found.run) {
            ++unfinished_;
            return;
        }
        const std::string name = folder.filename().string();
        if (found.run->run != valid_text(name))
            return fault(description,
                         fmt::format("is of the run {}, which is not called as its folder", found.run->run));
        found_.files += 1 + sound_files;
        found_.faults.insert(found_.faults.end(), found.faults.begin(), found.faults.end());
        finished_.emplace(name, *found.run);
        found_.runs = finished_.size();
    }

    /// What is wrong with them; counts those with which nothing is.
    static std::vector<std::string> check_files_of(const std::filesystem::path& folder, const FinishedRun& run,
                                                   std::size_t& sound_files) {
        std::vector<std::string> faults;
        sound_files = 0;
        for (const auto& [name, stamp] : run.files) {
            const std::filesystem::path file = folder / name;
            const auto wrong = fault_of(file, stamp, Check::Everything);
            // Before it skips a run, the program reads its records and looks at the sizes of other files.
            const bool is_seen = wrong && fault_of(file, stamp, Check::Records);
            if (wrong)
                faults.push_back(fmt::format("{}; {}{}", *wrong, is_seen ? "" : "remove it, and ", run_again));
            else
                ++sound_files;
        }
        for (const std::filesystem::path& file : files_below(folder)) {
            const std::string name = file.lexically_relative(folder).generic_string();
            if (name != "run.json" && !run.files.contains(name) && !is_of_work(file))
                faults.push_back(file.string() + ": is no file of this run");
        }
        return faults;
    }

    void check_ensemble(const std::filesystem::path& folder) {
        if (is_of_work(folder)) return;
        if (!is_folder(folder)) return fault(folder, "is no folder of sums over seeds");
        const std::filesystem::path description = folder / "ensemble.json";
        Sums& sums = sums_[valid_text("ensembles/" + folder.filename().string())];
        const std::optional<std::string> text = read_if_there(description);
        if (!text) {
            fault(description, "is missing; `photonlab run` writes it again");
        } else if (const auto json = checked_json(*text)) {
            const Json key = json->value("key", Json());
            if (key.is_string()) sums.key = key.get<std::string>();
            ++found_.files;
        } else {
            fault(description, "is damaged, or another program's; `photonlab run` writes it again");
        }
        for (const std::filesystem::path& slot : entries_of(folder))
            if (slot != description && !is_of_work(slot)) guarded([&] { check_slot(slot, sums); });
    }

    void check_slot(const std::filesystem::path& file, Sums& sums) {
        const std::string name = file.filename().string();
        const bool is_called_slot = name.size() == 11 && name.starts_with("slot-") && name.ends_with(".exr");
        const auto number = number_in<unsigned>(is_called_slot ? std::string_view(name).substr(5, 2) : "");
        if (!number || *number >= ensemble_slots) return fault(file, "is no sum over seeds");
        SlotContent content;
        try {
            content = read_slot_content(file);
            require_seal(file);
        } catch (const InputError& error) {
            throw InputError(
                fmt::format("{}; remove it, and `photonlab run` makes the runs of its seeds again", error.what()));
        }
        if (sums.key.empty()) sums.key = content.key;
        if (content.key != sums.key) return fault(file, "is of other settings than the sums beside it");
        for (const std::uint64_t seed : content.seeds) {
            const auto [other, is_new] = sums.slots.emplace(seed, name);
            if (!is_new) fault(file, fmt::format("holds the seed {}, which {} holds as well", seed, other->second));
        }
        ++found_.sums;
        ++found_.files;
    }

    void check_experiment() {
        const std::filesystem::path description = results_ / "experiment.json";
        const std::optional<std::string> experiment = experiment_of_results(results_);
        if (experiment)
            ++found_.files;
        else if (is_there(description))
            fault(description, "is damaged; remove it, and `photonlab run` writes it again");
        else
            fault(description, "is missing; `photonlab run` writes it again");
        for (const auto& [name, run] : finished_)
            if (experiment && run.experiment != *experiment)
                fault(results_ / "runs" / name / "run.json",
                      fmt::format("is of the experiment {}, not of {}", run.experiment, *experiment));
    }

    /// The merged tables: whether they are what merged.json says, and whether their rows are those of the runs.
    void check_merged() {
        const std::filesystem::path description = results_ / "merged.json";
        const bool is_described = is_there(description);
        const std::optional<MergedFiles> merged = read_merged_files(results_);
        if (!merged && (is_described || !finished_.empty()))
            fault(description, fmt::format("is {}; {}", is_described ? "damaged" : "missing", merge_again));
        if (merged) ++found_.files;
        if (merged) check_columns();
        for (const char* name : {"iterations.csv", "probes.csv"}) {
            std::vector<FileStamp> stamps;
            if (merged && merged->files.contains(name)) stamps = merged->files.at(name);
            guarded([&] { check_table(name, stamps, merged.has_value()); });
        }
    }

    void check_columns() {
        const std::filesystem::path file = results_ / "columns.json";
        const bool is_there = std::filesystem::exists(file);
        if (is_there && checked_json(read_text_file(file)))
            ++found_.files;
        else
            fault(file, fmt::format("is {}; {}", is_there ? "damaged" : "missing", merge_again));
    }

    void check_table(const std::string& name, const std::vector<FileStamp>& stamps, bool is_described) {
        const std::filesystem::path file = results_ / name;
        const std::optional<std::string> text = read_if_there(file);
        if (!text) {
            if (!stamps.empty()) fault(file, fmt::format("is missing; {}", merge_again));
            return;
        }
        if (is_described && stamps.empty()) return fault(file, "is no table of these results");
        if (std::find(stamps.begin(), stamps.end(), stamp_of_text(*text)) != stamps.end())
            ++found_.files;
        else if (is_described)
            found_.faults.push_back(fmt::format("{}; {}", *fault_of_text(file, *text, stamps[0]), merge_again));
        const std::set<std::string> merged = check_rows(name, *text);
        if (name != "iterations.csv") return;
        check_sums_of(merged);
        if (merged.size() < finished_.size())
            note(file, fmt::format("lacks the rows of {} finished runs: not merged yet, or not of the experiment any "
                                   "more",
                                   finished_.size() - merged.size()));
    }

    /// Every row must be of a finished run that is here, and stand among all rows of it. Returns which runs those are.
    std::set<std::string> check_rows(const std::string& table, const std::string& text) {
        struct OwnRows {
            std::string run;
            std::string rows;
        };
        std::map<std::string, OwnRows> known;  // by the first of them
        for (const auto& [name, run] : finished_) {
            const auto own = run.files.contains(table) ? read_if_there(results_ / "runs" / name / table) : std::nullopt;
            if (!own) continue;
            const std::string rows = rows_after_header(*own);
            known[rows.substr(0, rows.find('\n'))] = {name, rows};
        }
        std::set<std::string> merged;
        std::set<std::string> of_no_run;
        const std::string rows = rows_after_header(text);
        for (std::size_t at = 0, line = 2; at < rows.size();) {
            const std::size_t end = std::min(rows.find('\n', at), rows.size() - 1) + 1;
            const std::string row = rows.substr(at, end - at - 1);
            const auto own = known.find(row);
            const bool is_whole =
                own != known.end() && rows.compare(at, own->second.rows.size(), own->second.rows) == 0;
            const std::size_t next = is_whole ? at + own->second.rows.size() : end;
            if (is_whole)
                merged.insert(own->second.run);
            else if (of_no_run.insert(third_cell(row)).second)
                fault(fmt::format("{}:{}", (results_ / table).string(), line),
                      fmt::format("is no row of a finished run that is here, though {} is its run; {}", third_cell(row),
                                  merge_again));
            line += static_cast<std::size_t>(std::count(rows.begin() + static_cast<std::ptrdiff_t>(at),
                                                        rows.begin() + static_cast<std::ptrdiff_t>(next), '\n'));
            at = next;
        }
        return merged;
    }

    static std::string third_cell(const std::string& row) {
        std::istringstream stream(row);
        std::string cell;
        for (int i = 0; i < 3; ++i) std::getline(stream, cell, ',');
        return cell;
    }

    static std::string rows_after_header(const std::string& text) {
        const std::size_t end = text.find('\n');
        return end == std::string::npos ? "" : text.substr(end + 1);
    }

    /// The images of a run whose rows are merged must be in the sums that it names.
    void check_sums_of(const std::set<std::string>& merged) {
        std::map<std::string, std::vector<std::string>> lacking;  // runs by folder of sums
        for (const std::string& name : merged) {
            const FinishedRun& run = finished_.at(name);
            if (!run.ensemble) continue;
            const Sums& sums = sums_[run.ensemble->folder];
            if (sums.key != run.ensemble->key || !sums.slots.contains(run.seed))
                lacking[run.ensemble->folder].push_back(name);
        }
        for (const auto& [folder, runs] : lacking)
            fault(results_ / folder,
                  fmt::format("lacks the images of {} runs, the first {}; `photonlab run` makes them "
                              "again",
                              runs.size(), runs[0]));
    }

    /// Each reference once. One that grew since, or is on another machine, makes no record wrong.
    void check_reference(const std::string& run, const ReferenceOfRun& reference) {
        if (!references_.emplace(reference.path, reference.key).second) return;
        for (const std::filesystem::path& start :
             {std::filesystem::path(reference.working_directory), std::filesystem::path("."), results_}) {
            if (!is_there(start / reference.path)) continue;
            if (load_reference(start / reference.path, std::nullopt).key != reference.key)
                note(start / reference.path, fmt::format("is not as it was when {} was judged by it", run));
            return;
        }
        note(reference.path, fmt::format("the reference of {} is not here", run));
    }

    const std::filesystem::path results_;
    Verification found_;
    std::map<std::string, FinishedRun> finished_;  // by name of its folder
    std::map<std::string, Sums> sums_;             // by folder, as run.json names it
    std::set<std::pair<std::string, std::string>> references_;
    std::size_t unfinished_ = 0;
};

}  // namespace

Verification verify_results(const std::filesystem::path& results) {
    if (!is_folder(results)) throw InputError(results.string(), "is no folder");
    if (!is_folder(results / "runs"))
        throw InputError(results.string(), "holds no results: expected the folder runs, as `photonlab run` makes it");
    return Verifier(results).verify();
}

}  // namespace photonlab
