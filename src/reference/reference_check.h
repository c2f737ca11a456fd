// Whether paths and photons agree on how much light there is, on the hit points of a reference.
//
// A reference's noise floor is the scatter of what its paths found. It is blind to light that none of them found: a
// small lamp behind glass, whose light a path from the camera meets once in a million, leaves a dark reference of
// little noise. Photons start at the lamp, so a short ppm is compared with the paths, by the mean over the image of
// `gathered` and of direct + gathered; there photons bring the direct light, too, so that nothing is shared with shadow
// rays.
//
// Its passes keep their radius, so they are independent, and their scatter is the standard error of its mean. Its bias
// is measured by gathering the same photons within a radius r and within r/2: where the bias is in proportion to the
// radius (at edges) or to its square (elsewhere), what is left of it at r/2 is at most the change between the two. So
// the means are disputed where the paths' is more than four standard errors below, or above, all of what photons find
// within r/2, within r, and extrapolated to no radius. That the bias is in proportion to the radius is true in the mean
// over many hit points; of few it is so give or take the root of their squared changes. Standard errors that rest on
// few numbers are larger than they look: four means what is as rare as four where they rest on many (Student's
// distribution).
//
// What goes wrong: where a path finds such a lamp after all, it is a pixel as bright as thousands, and means and
// standard errors are those of a few pixels. The mean is then more often too low than too high, and so is its standard
// error: such a reference may be disputed although more samples would mend it, and says so.

#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/files/json.h"
#include "image/image.h"
#include "scene/scene.h"
#include "transport/camera/camera_pass.h"

namespace photonlab {

inline constexpr double largest_check_footprints = 0.5;  ///< r; less for few hit points
inline constexpr double fewest_standard_errors = 4.0;    ///< of a dispute

/// What is compared.
enum class ComparedLight { Gathered, DirectAndGathered };
inline constexpr ComparedLight compared_lights[] = {ComparedLight::Gathered, ComparedLight::DirectAndGathered};

/// A mean over pixels and channels, radiance.
struct MeanByPaths {
    double mean = 0.0;
    double standard_error = 0.0;    ///< from the halves' difference, pixel by pixel: their paths are independent
    double pixels = 0.0;            ///< that have noise
    double effective_pixels = 0.0;  ///< that share it: a third of them and more, unless few are much brighter
};

struct MeanByPhotons {
    struct Estimate {
        double mean = 0.0;
        double standard_error = 0.0;  ///< from the scatter over passes
    };
    Estimate within_radius;
    Estimate within_half;
    Estimate extrapolated;        ///< within_half and once more the change: without bias where it is in proportion to r
    double change_scatter = 0.0;  ///< root of the sum of squared changes at hit points: how uncertain that is for the
                                  ///< few hit points there are
    double passes = 0.0;
    double photons = 0.0;  ///< found at hit points within r/2, over all passes
};

enum class Verdict { Agreed, Undecided, Disputed };  ///< from the mildest to the gravest

struct ComparedMeans {
    double difference = 0.0;       ///< paths' mean - photons' within r/2
    double standard_error = 0.0;   ///< of the difference
    double standard_errors = 0.0;  ///< by which the paths' mean is above, or where negative below, all that photons and
                                   ///< their change allow; as rare as so many of a normal distribution, 1000 at most
    double seen = 0.0;             ///< about the least missing light that would have been disputed
    Verdict verdict = Verdict::Undecided;
    std::string why;  ///< of what is undecided
};

ComparedMeans compare_means(const MeanByPaths& paths, const MeanByPhotons& photons);

/// The deviate of a normal distribution that is as rare as `deviate` of Student's with so many degrees of freedom.
/// [Wallace 1959, "Bounds on normal approximations to Student's and the chi-square distributions"]
double normal_deviate(double deviate, double degrees_of_freedom);

/// Light at hit points by photons alone.
struct LightByPhotons {
    std::uint64_t photons_per_pass = 0;
    double footprints = 0.0;      ///< r at each hit point, in footprints of the pixel
    double radius = 0.0;          ///< its mean over hit points, scene units
    MeanByPhotons means[2] = {};  ///< by ComparedLight
    double seconds = 0.0;
};

struct CheckSettings {
    std::uint64_t paths = 0;  ///< of the reference, over all sample positions and both halves: photons cost a share
    int max_depth = -1;
    std::uint64_t seed = 1;
    int threads = 1;
    std::function<bool()> is_interrupted = [] { return false; };
};

/// Empty when interrupted.
std::optional<LightByPhotons> measure_light_by_photons(const Scene& scene, const HitPoints& hit_points,
                                                       const CheckSettings& settings);

/// Of the two halves of a path-traced reference, which have layers.
MeanByPaths mean_by_paths(const Image& half_a, const Image& half_b, ComparedLight light);

/// What reference.json says of it: `verdict`, a sentence `why`, and all numbers.
Json check_json(const Image& half_a, const Image& half_b, const LightByPhotons& photons);

/// The same where nothing was compared.
Json not_made(const std::string& why);

}  // namespace photonlab
