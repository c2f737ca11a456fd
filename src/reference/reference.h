// A reference to judge by: two independent halves in a folder (reference_store.h makes them), or a single EXR of
// another renderer. Its sample positions, resolution and depth are part of what it is a reference of, so they must be
// those of the image; a folder of halves knows its own and refuses others.

#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/files/json.h"
#include "image/image.h"
#include "image/metrics.h"
#include "transport/camera/camera_pass.h"

namespace photonlab {

/// What a reference is a reference of: everything that changes the image it converges to.
struct ReferenceSubject {
    std::string scene_hash;
    int width = 0;
    int height = 0;
    int samples_per_pixel = 1;
    int max_depth = -1;
    Positions positions =
        Positions::Grid;  ///< "box": of the pixels' areas, and then samples_per_pixel is of no account
};

/// Raised whenever what a reference converges to changes with the program.
inline constexpr int reference_version = 1;

/// Hash of the subject and the version; not of seed or threads.
std::string reference_key(const ReferenceSubject& subject);

/// Whether photons agree with the paths of a reference on how much light there is: see reference_check.h.
struct ReferenceCheck {
    std::string verdict = "not compared";  ///< also of an EXR, and of a folder made before there was a comparison
    std::string why;                       ///< a sentence with the numbers
};

struct Reference {
    std::filesystem::path path;
    std::string key;  ///< of a folder: reference_key() and the samples in it; of an EXR: the file's hash
    std::optional<double> floor_mse;  ///< of the whole image; empty for an EXR
    ReferenceCheck check;
    Image half_a;
    Image half_b;  ///< no layers: half_a is the whole reference
};

/// The components that errors are taken of, in the order of the records.
inline constexpr std::string_view total_component = "total";
inline const std::vector<std::string> components{"total", "emission", "direct", "gathered"};

/// Checks that the reference fits: one of pixel areas judges every method, and shows what a grid of positions misses of
/// them; one of a grid judges methods on the same grid. It does so
/// without reading pixels where that can be told sooner. Returns its key. The
/// InputError says what differs.
std::string check_reference(const std::filesystem::path& path, const ReferenceSubject& subject);

/// Reads a folder or an EXR; with a subject, refuses what is not a reference of it. An EXR has to hold what `component`
/// needs (image/exr.h).
Reference load_reference(const std::filesystem::path& path, const std::optional<ReferenceSubject>& subject,
                         const std::string& component = "total");

/// What whoever judges by a reference should be told once: that it is disputed. Empty where it is not.
std::optional<std::string> warning_about(const Reference& reference);

/// What a component is judged by; empty when the reference does not have it, and as judge() says.
std::optional<ReferencePixels> reference_pixels(const Reference& reference, std::string_view component,
                                                bool photons_carry_direct);

/// Errors of one component of an image; empty when the reference does not have it, and for `direct` when photons carry
/// direct light: `gathered` is then judged against the reference's direct + gathered.
std::optional<ErrorMetrics> judge(const Image& image, const Reference& reference, std::string_view component,
                                  bool photons_carry_direct);

/// A component's pixels in double; empty when the image does not have it.
std::vector<ColorD> component_pixels(const Image& image, std::string_view component);

}  // namespace photonlab
