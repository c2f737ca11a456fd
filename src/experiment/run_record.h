// run.json and the metadata of images: everything needed to repeat a run, taken from the objects that ran.

#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "experiment/recorder.h"
#include "experiment/settings_io.h"
#include "image/exr.h"
#include "scene/scene.h"
#include "transport/hit_points.h"

namespace photonlab {

/// An image that a run kept.
struct Snapshot {
    std::uint64_t pass = 0;
    std::string file;  ///< relative to the run's folder
};

/// What a run says of itself beside its rows.
struct RunRecord {
    std::string title;  ///< of the experiment
    std::string method;
    std::string key;  ///< by which a finished run is recognised
    std::filesystem::path scene_file;
    std::chrono::system_clock::time_point started;
    double seconds = 0.0;  ///< from start to end of all runs that shared the photons, metrics and files included
    std::size_t runs_together = 1;  ///< that shared them, this one included
    std::vector<std::uint64_t> recorded;
    std::vector<Snapshot> snapshots;
};

Json run_json(const RunRecord& record, const Recorder& recorder, const RunState& last, const Scene& scene,
              const HitPoints& hit_points, const Reference* reference);

/// Attributes of an image after `state.pass` passes.
Metadata image_metadata(const RunIdentity& identity, const RunState& state, const Scene& scene);

/// Name of a snapshot: pass-000064.exr.
std::string snapshot_name(std::uint64_t pass);

}  // namespace photonlab
