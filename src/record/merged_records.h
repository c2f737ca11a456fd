// The records of an experiment, merged from those of its finished runs:
//
//     RESULTS/iterations.csv, RESULTS/probes.csv    their rows, in the order of the experiment
//     RESULTS/columns.json                          what the columns of iterations.csv are (columns.h)
//     RESULTS/merged.json                           what the two tables are
//
//     {"schema": 1, "experiment": "alpha-study",
//      "files": {"iterations.csv": [{"bytes": 51200, "hash": "..."}], "probes.csv": [...]},
//      "checksum": "..."}                           kept_files.h
//
// Each file is replaced at once. Before that merged.json says what it was and what it will be, a stamp each, and
// afterwards what it is: whenever the program ends, the file is one of those that are listed. Who reads while a program
// merges reads the table first and merged.json second, and both again where they do not fit. What is not listed is not
// there: an experiment without probes has no probes.csv.

#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/files/kept_files.h"

namespace photonlab {

/// A run whose rows belong into the records when it is finished.
struct RunToMerge {
    std::filesystem::path folder;
    std::string key;
};

/// Finished runs of one kind.
struct CountedRuns {
    std::size_t count = 0;
    std::string first;  ///< name of its folder

    void add(const std::filesystem::path& folder);
};

struct MergedRecords {
    std::size_t runs = 0;             ///< whose rows are there
    std::vector<std::string> faults;  ///< of finished runs that were left out, one line each
    CountedRuns of_other_settings;    ///< left out: what they were made with is not what is asked for now
    CountedRuns of_no_run;            ///< left out: the experiment has no run that is called so
};

/// Merges the runs that are finished. What it merges it checks: a run that is not what it was when it finished is left
/// out, and named. Others that are finished and left out are counted. One pass over the folder, in which every file is
/// opened once and no more than a run is in memory. Writes nothing where nothing has changed. For whoever holds the
/// folder's lock, beside processes that make runs.
MergedRecords merge_records(const std::string& experiment, const std::filesystem::path& results,
                            const std::vector<RunToMerge>& runs);

/// A sentence on finished runs that were left out and are sound; empty where there are none.
std::string describe_left_out(const MergedRecords& merged);

/// What merged.json says.
struct MergedFiles {
    std::string experiment;
    std::map<std::string, std::vector<FileStamp>> files;  ///< by name; never empty

    bool operator==(const MergedFiles&) const = default;
};

/// Empty when it is not there or damaged.
std::optional<MergedFiles> read_merged_files(const std::filesystem::path& results);

/// The header of probes.csv, without its end.
extern const std::string probes_header;

}  // namespace photonlab
