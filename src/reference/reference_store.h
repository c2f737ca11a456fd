// References in a folder: two halves, made with random streams of their own, that grow by as many samples as somebody
// cares to add. They are path traced, and unbiased. Where path tracing would take days or finds nothing (caustics of
// small lights, seen through glass), they are made by ppm instead, with the schedule of Knaus and Zwicker, whose passes
// can be joined, from 1.5 footprints on: consistent, not unbiased, and reference.json says so.
//
//     half_a.exr, half_b.exr    mean over the half's samples, as layers; how many and of what is in their metadata
//     reference.json            how it was made, its key, its noise floor, what photons say of its light
//                               (reference_check.h), and the halves' checksums
//
// Each half is replaced whole and knows its own number of samples, so an interruption between the two loses nothing:
// the next call brings the lagging half up first. Many nodes make one reference by a range of its samples each: a part
// is a file of its own beside the halves with the exact sums of both, and parts that are joined are, to the bit, the
// halves that one process makes. reference.json is written last; where its checksums are not the
// halves', nothing is judged by them until then.

#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/json.h"
#include "image/image.h"
#include "integrators/settings/settings.h"
#include "reference/reference.h"
#include "render/checkpoint.h"
#include "render/pass_range.h"
#include "scene/scene.h"

namespace photonlab {

/// Initial radius of references made by ppm: below what runs begin with, so that the bias is less than theirs.
inline constexpr double reference_footprints = 1.5;

struct ReferenceSettings {
    std::filesystem::path scene_file;
    std::string integrator = "path";             ///< or "ppm"
    std::uint64_t samples = 1024;                ///< to add to each half: paths a sample position (path), passes (ppm)
    std::uint64_t photons_per_pass = 1'000'000;  ///< ppm
    double alpha = 2.0 / 3.0;                    ///< ppm
    int samples_per_pixel = 1;                   ///< sample positions, a perfect square; with "box", paths a sample
    Positions positions = Positions::Grid;       ///< "box": path alone
    int max_depth = -1;
    std::uint64_t seed = 1;  ///< must be the one that is there already, when adding
    int threads = 1;
    double seconds_between_saves = default_seconds_between_saves;
    bool picture_only = false;  ///< store the sum of the layers alone, a third of the size; nothing can be added to it
    std::function<bool()> is_interrupted = [] { return false; };  ///< true: end, and save, with fewer samples
};

/// Called after every sample of a half: how many of how many are done.
using SampleListener = std::function<void(std::uint64_t done, std::uint64_t total)>;

/// Adds samples to what is in `folder`. Throws InputError when that is a reference of something else, or of another
/// seed, or when another process is adding to it. Returns what reference.json now says.
Json add_reference_samples(
    const Scene& scene, const ReferenceSettings& settings, const std::filesystem::path& folder,
    const SampleListener& on_sample = [](std::uint64_t, std::uint64_t) {});

/// How its samples are made.
MethodSettings reference_method(const ReferenceSettings& settings);

/// Makes samples `passes` of both halves, counted from 1, into `checkpoint`, from which it goes on where that is there
/// already. `on_sample` as above. False when it was interrupted, and saved.
bool make_reference_part(const Scene& scene, const ReferenceSettings& settings, const PassRange& passes,
                         const Checkpoint& checkpoint, const SampleListener& on_sample);

/// A file that it made.
struct ReferencePart {
    Checkpoint checkpoint;
    PassRange passes;
};

/// Makes the reference of the samples in the parts, which are those from the first on, in order. Throws InputError when
/// the folder holds a reference of something else, or one of more samples. Returns what reference.json now says.
Json join_reference_parts(const Scene& scene, const ReferenceSettings& settings,
                          const std::vector<ReferencePart>& parts, const std::filesystem::path& folder);

/// Compares what is in `folder` with photons once more, and adds nothing: reference.json alone is written anew, with
/// the same key. Returns what it now says.
Json compare_reference_with_photons(const Scene& scene, const ReferenceSettings& settings,
                                    const std::filesystem::path& folder);

/// Reads reference.json; InputError when it is missing or not one.
Json read_reference_json(const std::filesystem::path& folder);

/// Reads a half, "half_a" or "half_b", after checking its checksum and size against reference.json.
Image read_reference_half(const std::filesystem::path& folder, const Json& json, std::string_view half);

}  // namespace photonlab
