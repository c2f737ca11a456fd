// What a rendering method is: it says what it needs, takes passes, and gives an image. It knows no file, no clock and
// no reference, and it makes no hit points, photons or maps: the loop over passes does (render/pass_loop.h), so that
// what methods share is made once and what each costs is known.

#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "core/files/state_archive.h"
#include "core/random.h"
#include "gather/areas/accepting_discs.h"
#include "gather/map/photon_map.h"
#include "image/image.h"
#include "integrators/settings/settings.h"
#include "scene/scene.h"
#include "transport/camera/camera_pass.h"

namespace photonlab {

/// What a method needs of the loop; it follows from the settings.
struct Needs {
    enum class Photons {
        None,
        OfPass,       ///< a map over the photons of the pass
        OfAllPasses,  ///< maps over the photons of all passes so far, when an image is asked for
    };
    enum class Direct {
        ByLoop,    ///< direct light is sampled at the hit points in every pass, as the settings say
        ByItself,  ///< the method brings the layer
    };
    enum class Passes {
        Ordered,        ///< a pass depends on those before it
        AfterLearning,  ///< on those that emission learns from alone: independent once that is frozen
        Independent,    ///< passes can be taken from any number on; the image is a mean over those that were taken
    };

    /// Other hit points in every pass; empty: the same in all, so that the image converges to radiance at these.
    std::optional<NewPoints> new_points = std::nullopt;
    Photons photons = Photons::None;
    bool has_own_photons = false;  ///< they follow from where it gathers, or from what it found there before: no other
                                   ///< method can share them
    bool holds_photons = false;    ///< between passes, as many as the first brought; what take() does with them is a
                                   ///< stage of its own
    Direct direct = Direct::ByLoop;
    Passes passes = Passes::Ordered;
    std::string_view ordered_since = "";  ///< why they are, as the end of a sentence

    /// States of disjoint passes can be joined, to the bits of a run of all.
    bool can_be_joined() const { return passes != Passes::Ordered; }
};

/// What a method takes of one pass.
struct Pass {
    std::uint64_t number = 1;  ///< counted from 1
    const HitPoints& points;
    const PhotonMap* photons = nullptr;  ///< with Needs::Photons::OfPass
    double paths = 0.0;  ///< that the flux of these is divided by: those emitted, or where only seen ones are there as
                         ///< many as had to be emitted for as many to be seen; infinite where none was
    std::span<std::uint32_t> accepted = {};  ///< one a photon of the map, to which the method adds a 1 for every hit
                                             ///< point that accepts it; empty: nobody asks
};

/// The photons of all passes so far, in two disjoint maps.
struct PhotonsOfAllPasses {
    const PhotonMap& global;
    const PhotonMap& caustic;         ///< light that came by mirrors and glass alone
    std::uint64_t paths_emitted = 0;  ///< in all passes
};

/// The layers that a method makes, a value a pixel.
struct MethodLayers {
    std::vector<Color> gathered;
    std::vector<Color> direct = {};  ///< with Needs::Direct::ByItself
    std::optional<EstimatedError> estimated_error = std::nullopt;
};

/// What a method can say of itself between two passes. Radii in scene units; empty where it has no such thing.
struct IntegratorReport {
    std::uint64_t photons_gathered = 0;   ///< photons accepted at hit points, summed over points and passes
    std::uint64_t bytes = 0;              ///< of its statistics
    std::uint64_t photons_left_out = 0;   ///< where photons bring their flux to others: those that found none
    std::uint64_t inexact_additions = 0;  ///< where sums are exact: those that were not, of channels
    std::optional<double> radius_min =
        std::nullopt;  ///< over hit points, of the last gather (photonmapper) or for the next (ppm)
    std::optional<double> radius_mean = std::nullopt;
    std::optional<double> radius_max = std::nullopt;
};

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
    const HitPoints& hit_points;  ///< of the grid of sample positions: those of every pass where they are fixed
    std::uint64_t seed = 1;
    int threads = 1;
    RandomPurpose path_purpose = RandomPurpose::CameraPaths;  ///< of `path`; a reference's half has its own
};

class Integrator {
public:
    virtual ~Integrator() = default;

    /// Called pass by pass, from 1 on where passes are ordered.
    virtual void take(const Pass& pass) = 0;

    /// The image after the passes so far, before the first too. `photons` is there with Needs::Photons::OfAllPasses.
    /// Changes nothing that later passes depend on.
    virtual MethodLayers image(const PhotonsOfAllPasses* photons) = 0;

    /// Writes or reads everything that the passes so far left here, between two passes. One made from the same settings
    /// and context that reads it goes on as this one would have, to the bit; photons are not in it. Where passes can be
    /// joined, an archive that joins adds those of the state that it reads.
    virtual void exchange(StateArchive& archive) = 0;

    virtual IntegratorReport report() const = 0;

    /// Where the next take() accepts photons, asked before it with the same number and points; of methods whose photons
    /// are paths that are seen.
    virtual AcceptingDiscs accepting_discs(const Pass& pass) {
        static_cast<void>(pass);
        return {};
    }

    /// Of the hit point with this index; empty for a method that gathers nothing.
    virtual std::optional<GatherState> gather_state(std::size_t hit_point) const {
        static_cast<void>(hit_point);
        return std::nullopt;
    }
};

}  // namespace photonlab
