// What the runner asks of a rendering method: take the photons of a pass, and show the image so far. An integrator
// knows no file, no clock and no reference; it says which stage it enters, and whoever runs it keeps the time.

#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "core/random.h"
#include "core/state_archive.h"
#include "image/image.h"
#include "integrators/photon_supply.h"
#include "integrators/settings.h"
#include "scene/scene.h"
#include "transport/camera_pass.h"

namespace photonlab {

/// Parts of a pass that are timed apart. For photon methods Trace and Build are the runner's own: they are shared.
enum class Stage { Trace, Build, Gather, Direct };

/// Called by an integrator when it enters a stage.
using StageListener = std::function<void(Stage)>;

/// What an integrator can say of itself after a pass or an estimate. Radii in scene units; empty where the method has
/// no such thing.
struct IntegratorReport {
    std::uint64_t photons_gathered = 0;  ///< photons accepted at hit points, summed over points and passes
    std::uint64_t map_bytes = 0;         ///< photons, their index and buffers, at their largest so far
    std::uint64_t hit_point_bytes = 0;   ///< hit points and their statistics
    std::uint64_t nonfinite = 0;         ///< photons refused because they could not be indexed
    std::optional<double> radius_min;    ///< over hit points, of the last gather (photonmapper) or for the next (ppm)
    std::optional<double> radius_mean;
    std::optional<double> radius_max;
};

inline void exchange(StateArchive& archive, IntegratorReport& report) {
    archive.exchange(report.photons_gathered);
    archive.exchange(report.map_bytes);
    archive.exchange(report.hit_point_bytes);
    archive.exchange(report.nonfinite);
    archive.exchange(report.radius_min);
    archive.exchange(report.radius_mean);
    archive.exchange(report.radius_max);
}

/// What a method holds at one hit point after its last gather.
struct GatherState {
    double radius = 0.0;   ///< scene units: of the next gather (ppm), of the last in the global map (photonmapper)
    double photons = 0.0;  ///< N of Hachisuka et al. 2008, which shrinks with the disc; for other methods those
                           ///< found, by ppm in all passes
    std::optional<double> density;  ///< photons / (pi radius^2), 1/scene unit^2; empty where the photons are not those
                                    ///< of this disc
    ColorD radiance;                ///< gathered, towards the camera
};

/// What every integrator is made from. The references must outlive it.
struct IntegratorContext {
    const Scene& scene;
    const HitPoints& hit_points;
    std::uint64_t seed = 1;
    int threads = 1;
    RandomPurpose path_purpose = RandomPurpose::CameraPaths;    ///< of `path`; a reference's half has its own
    RandomPurpose direct_purpose = RandomPurpose::DirectLight;  ///< of direct light at hit points; likewise
};

class Integrator {
public:
    virtual ~Integrator() = default;

    /// Takes pass `pass`, counted from 1 and called in order. `photons` holds what the method's PhotonNeed says.
    /// Methods whose passes do not depend on each other (`path`, `ppm` with the schedule of Knaus and Zwicker) may
    /// begin at any pass: their images are means over the passes they took, and can be joined.
    virtual void run_pass(std::uint64_t pass, const PhotonSupply& photons, const StageListener& enter) = 0;

    /// What of pass `pass` needs no photons, direct light, so that it can be done while they are being indexed: begins
    /// it and returns in how many blocks it comes. Whoever calls this calls add_direct() once for each of them, on any
    /// thread and in any order, before run_pass(), which otherwise does it all.
    virtual std::size_t begin_direct(std::uint64_t pass) {
        static_cast<void>(pass);
        return 0;
    }
    virtual void add_direct(std::size_t block) { static_cast<void>(block); }

    /// The image after the passes so far, layers "emission", "direct" and "gathered". After no pass at all: emission,
    /// and direct light sampled once for this alone. Changes nothing that later passes depend on.
    virtual Image estimate(const PhotonSupply& photons, const StageListener& enter) = 0;

    virtual IntegratorReport report() const = 0;

    /// Writes or reads everything that the passes so far left here, between two passes. One made from the same settings
    /// and context that reads it goes on as this one would have, to the bit; photons are not in it.
    virtual void exchange(StateArchive& archive) = 0;

    /// Of the hit point with this index; empty for a method that gathers nothing.
    virtual std::optional<GatherState> gather_state(std::size_t hit_point) const {
        static_cast<void>(hit_point);
        return std::nullopt;
    }
};

}  // namespace photonlab
