// How a pass runs: hit points, photons, the map over them, direct light, and then each method takes the pass.
// Everything that runs passes calls this: runs of experiments (run_methods.h), references, and the tests.
//
// Methods that run in one loop share hit points and photons, so that what is shared is made once, that all see the same
// is true by construction, and each is charged for it in full, as if it were alone (stage_clock.h).

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "image/image.h"
#include "integrators/registry.h"
#include "render/loop_layers.h"
#include "render/pass_range.h"
#include "render/photon_source.h"
#include "render/photon_supply.h"
#include "render/stage_clock.h"

namespace photonlab {

/// A run of one method.
struct RunSettings {
    MethodSettings method;  ///< with max_depth resolved
    std::uint64_t seed = 1;
    std::uint64_t passes = 1;  ///< the last one
    int threads = 1;
    std::vector<std::uint64_t> shown = {};  ///< passes whose image is asked for, increasing, at most `passes`
    bool shows_counts = false;              ///< images have Image::count and Image::density
    std::uint64_t first_pass = 1;           ///< of independent passes
    std::optional<EmissionMap> learnt = std::nullopt;  ///< PassLoop::freeze_emission()
};

/// How far a run is.
struct RunState {
    std::uint64_t pass = 0;            ///< the last that was taken
    std::vector<PassRange> ranges;     ///< that were taken; where states were joined, in the order of these
    std::uint64_t paths_emitted = 0;   ///< from lights, over all passes; 0 for `path`
    std::uint64_t paths_traced = 0;    ///< to find photons for these
    std::optional<double> paths_seen;  ///< share of the last pass's emitted paths with a photon that was accepted;
                                       ///< where photons are the method's own
    std::optional<double> mutations_accepted;  ///< share, in the last pass; of visible paths
    std::optional<double> step_size;           ///< of these mutations
    std::uint64_t photons_stored = 0;
    std::uint64_t paths_cut = 0;          ///< by the cap on edges, of all that were traced
    double power_cut = 0.0;               ///< what those carried, relative to the total power, summed over paths
    std::uint64_t nonfinite_photons = 0;  ///< refused by the photon pass
    std::uint64_t nonfinite_in_maps = 0;  ///< refused because they could not be indexed
    std::uint64_t map_bytes = 0;          ///< photons, their index and buffers, at their largest so far
    std::uint64_t hit_point_bytes = 0;    ///< hit points and what is kept of them from pass to pass
    StageTimes times;                     ///< stage_clock.h
    IntegratorReport report;
    std::optional<double> initial_radius;     ///< mean over hit points before the first pass, scene units; for mode
                                              ///< `nearest` the maximum radius
    std::optional<EmissionMap> emission_map;  ///< what was learnt; only in state_now()
};

/// The random streams that a loop draws from. A reference's halves have streams of their own.
struct LoopPurposes {
    RandomPurpose paths = RandomPurpose::CameraPaths;
    RandomPurpose photons = RandomPurpose::PhotonPaths;
    RandomPurpose direct = RandomPurpose::DirectLight;
    RandomPurpose positions = RandomPurpose::CameraPositions;
};

/// True when both trace the same photons in the same passes, gather at the same hit points, and are looked at after the
/// same passes.
bool can_run_together(const RunSettings& a, const RunSettings& b);

/// The photons that a run traces in each pass, of plain emission.
PhotonSettings photon_settings(const RunSettings& settings, RandomPurpose purpose = RandomPurpose::PhotonPaths);

class PassLoop {
public:
    /// Methods that can_run_together(), or one; of the list of integrators, or of one's own. `hit_points` are those of
    /// the grid; they and the scene must outlive this.
    PassLoop(const Scene& scene, const HitPoints& hit_points, const std::vector<RunSettings>& settings,
             const LoopPurposes& purposes = {}, const std::vector<IntegratorKind>& kinds = integrator_kinds());

    /// Makes pass `pass` (counted from 1, in order) and hands it to the methods that are at the pass before it. Those
    /// that were restored from later ones wait. A method whose passes are independent may begin at any.
    void take(std::uint64_t pass);

    /// The same with photons that were traced already.
    void take(std::uint64_t pass, PhotonPass traced);

    /// The layers "emission", "direct" and "gathered" of the methods `which` after the passes so far; `listener(method,
    /// image)` is called for each with its state() as of this image.
    template <typename Listener>
    void show(const std::vector<std::size_t>& which, const Listener& listener) {
        const StageTimes indexing = begin_images(which);
        for (const std::size_t method : which) listener(method, image(method, indexing));
        photons_.drop_maps_of_all_passes();
    }

    /// show() of the only method.
    Image image();

    std::size_t method_count() const { return methods_.size(); }
    const RunState& state(std::size_t method) const { return methods_[method].state; }
    Integrator& integrator(std::size_t method) { return *methods_[method].integrator; }
    const Needs& needs(std::size_t method) const { return methods_[method].needs; }

    /// state() with what the method says of itself now, not at its last image.
    RunState state_now(std::size_t method) const;

    /// Emits by what was learnt elsewhere, and learns no more: of a method with emission "adaptive", before its first
    /// pass. With radii that follow nothing passes are independent then.
    void freeze_emission(const EmissionMap& learnt);

    /// Writes or reads what the passes so far left of a method, but for the photons: those of all passes are traced
    /// again. Of a method whose passes can be joined, also to join other passes to those that were taken.
    void exchange(std::size_t method, StateArchive& archive);

private:
    /// One of the methods that run side by side.
    struct Method {
        std::unique_ptr<Integrator> integrator;
        Needs needs;
        LoopLayers layers;
        RunState state;
        bool shows_counts = false;
        StageTimes passes_alone = {};  // without images
    };

    bool is_due(const Method& method, std::uint64_t pass) const;
    bool is_any_due(std::uint64_t pass, Needs::Photons photons) const;
    bool keeps_all_photons() const;
    void trace(std::uint64_t pass, PhotonPass& traced);
    void make_points(std::uint64_t pass);
    void index_and_light(std::uint64_t pass);
    void light(Method& method, std::uint64_t pass);
    void take(Method& method, std::uint64_t pass);
    const HitPoints* find_new_points(const NewPoints& kind) const;  // nullptr: not made in this pass
    const HitPoints& points_of(const Method& method) const;
    void describe(const Method& method, RunState& state) const;
    StageTimes begin_images(const std::vector<std::size_t>& which);
    Image image(std::size_t method, const StageTimes& indexing);
    void add_gather_states(const Method& method, Image& image) const;

    const Scene& scene_;
    const HitPoints& hit_points_;
    PhotonSource source_;
    const double branch_cutoff_;
    const int threads_;
    std::vector<Method> methods_;
    PhotonSupply photons_;
    const RandomPurpose positions_purpose_;
    std::vector<std::pair<NewPoints, HitPoints>> new_points_;  // of the pass: a set for each kind that methods want
};

}  // namespace photonlab
