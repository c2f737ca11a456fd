// run.json and the metadata of images: everything needed to repeat a run, taken from the objects that ran; and by what
// a run's files are known again.
//
//     "finished": true, "key": ..., ...
//     "ensemble": {"folder": "ensembles/POINT", "key": "..."}     the sums that hold its images (ensemble.h); or null
//     "sessions": [{"host": "n17", "process": 4711, "job": "88_12", "processor": "AMD EPYC 7763 64-Core Processor",
//                   "threads": 4, "until_pass": 64}, ...]         who made it, up to which pass
//     "resumed": 0
//     "files": {"iterations.csv": {"bytes": 5120, "hash": "..."}, "probes.csv": ..., "snapshots/pass-000064.exr": ...}
//     "checksum": "..."     of run.json itself (kept_files.h, as are bytes and hash)
//
// `files` has every file of the run's folder but run.json. A run is what it was when all of them are.

#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/files/kept_files.h"
#include "image/exr.h"
#include "record/recorder.h"
#include "record/run/settings_json.h"
#include "scene/scene.h"
#include "transport/camera/camera_pass.h"

namespace photonlab {

/// An image that a run kept.
struct Snapshot {
    std::uint64_t pass = 0;
    std::string file;  ///< relative to the run's folder
};

/// The sums that a run's images are in.
struct SumsOfRun {
    std::string folder;  ///< from the results' folder
    std::string key;
};

/// A process that was at work on a run.
struct Session {
    std::string host;
    std::int64_t process = 0;  ///< its id
    std::string job;           ///< of Slurm; empty outside
    std::string processor;
    std::int64_t threads = 0;
    std::uint64_t until_pass = 0;  ///< that it finished or saved last
};

/// This process's.
Session this_session(int threads);

/// What a run says of itself beside its rows.
struct RunRecord {
    std::string title;  ///< of the experiment
    std::string method;
    std::string key;  ///< by which a finished run is recognised
    std::filesystem::path scene_file;
    std::chrono::system_clock::time_point started;
    double seconds = 0.0;  ///< from start to end of all runs that shared the photons, metrics and files included
    std::size_t runs_together = 1;  ///< that shared them, this one included
    std::vector<Session> sessions;  ///< never empty
    std::vector<std::uint64_t> recorded;
    std::vector<Snapshot> snapshots;
    std::optional<SumsOfRun> ensemble;
    std::map<std::string, FileStamp> files;  ///< by name, from the run's folder
};

Json run_json(const RunRecord& record, const Recorder& recorder, const RunState& last, const Scene& scene,
              const HitPoints& hit_points, const Reference* reference);

/// What a run was judged by.
struct ReferenceOfRun {
    std::string path;  ///< from the folder that the program was started in
    std::string key;
    std::string working_directory;
};

/// What run.json says of a finished run.
struct FinishedRun {
    std::string experiment;
    std::string run;
    std::string key;
    std::uint64_t seed = 0;
    std::optional<SumsOfRun> ensemble;
    std::optional<ReferenceOfRun> reference;
    std::map<std::string, FileStamp> files;
};

/// Of a run's folder; empty when there is no run.json, or a damaged one, or one of another program.
std::optional<FinishedRun> read_finished_run(const std::filesystem::path& folder);

/// What is wrong with the run's files, one line each that begins with the file's name.
std::vector<std::string> faults_of(const std::filesystem::path& folder, const FinishedRun& run, Check check);

/// A run's folder as it was found.
struct FoundRun {
    bool is_described = false;        ///< there is a run.json
    std::optional<FinishedRun> run;   ///< empty when there is none, or it is damaged or another program's
    std::vector<std::string> faults;  ///< what was found wrong with the run's files, one line each
};

/// Looks at a run that another process may be making again: run.json goes first then, and comes last. Where the files
/// do not fit, `find_faults` is therefore asked again as long as there is another run.json by then.
FoundRun look_at_run(const std::filesystem::path& folder,
                     const std::function<std::vector<std::string>(const FinishedRun&)>& find_faults);

/// Attributes of an image after `state.pass` passes.
Metadata image_metadata(const RunIdentity& identity, const RunState& state, const Scene& scene);

/// Name of a snapshot: pass-000064.exr.
std::string snapshot_name(std::uint64_t pass);

}  // namespace photonlab
