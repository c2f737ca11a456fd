// Parts of a run: files with the state after a range of its passes, which `photonlab join` puts together. A part is a
// checkpoint (render/checkpoint.h) whose identity is a text that says of what run it is:
//
//     {"photonlab": "render" or "reference", "program": version,
//      "scene": {"file": ..., "parameters": {...}, "hash": ..., "width": ..., "height": ..., "samples_per_pixel": ...},
//      "settings": {...}, "seed": ..., "passes": [17, 32]}
//
// Parts fit together when all but the passes and the name of the scene file is the same.

#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "integrators/settings/settings.h"
#include "render/checkpoint.h"
#include "render/pass_loop.h"

namespace photonlab {

struct RunPart {
    std::string command;  ///< that makes it: "render" or "reference"
    std::filesystem::path scene_file;
    std::map<std::string, std::string> parameters = {};  ///< of -D
    std::string scene_hash;
    int width = 0;  ///< pixels
    int height = 0;
    int samples_per_pixel = 1;
    MethodSettings settings;  ///< with max_depth resolved
    std::uint64_t seed = 1;
    PassRange passes;
};

/// Where it is kept.
Checkpoint checkpoint_of(const RunPart& part, const std::filesystem::path& file);

struct PartFile {
    Checkpoint checkpoint;
    RunPart part;
};

/// Reads of what run and which passes the file is. Throws InputError where it is damaged, another program's, or of a
/// run of its own.
PartFile read_part(const std::filesystem::path& file);

/// Throws InputError where `part` is of another run than `first`; it says in what they differ.
void require_same_run(const PartFile& first, const PartFile& part);

/// Parts of one run, by their passes. Throws InputError where they are of several, or share a pass.
std::vector<PartFile> read_parts(const std::vector<std::filesystem::path>& files);

/// Reads the state into a loop of the run; later ones are joined to it. Throws InputError where its passes are not all
/// there yet.
void load_part(const PartFile& part, PassLoop& loop);

/// True when all passes of a part are taken; false too when the file is not there.
bool is_whole(const Checkpoint& checkpoint, const PassRange& passes);

/// Throws InputError, which says why, where the method's passes cannot be taken apart so: `passes` is what is taken.
void require_separable(const MethodSettings& settings, const PassRange& passes);

/// "17..20 and 40..64": what lies between the ranges, which are in order, and before them; empty where nothing does.
std::string gaps_of(const std::vector<PassRange>& ranges);

}  // namespace photonlab
