// Every setting of a method that an experiment can choose or sweep. One flat aggregate, because it is one row of the
// records. What each means and can be is its line in settings_table.h; which integrator uses which is in its kind
// (registry.h), and what it does not use stays empty in the records.

#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "core/text/names.h"
#include "gather/areas/area_weights.h"
#include "gather/kernel.h"
#include "gather/radii/radius_rule.h"
#include "transport/camera/camera_pass.h"
#include "transport/light/step_rule.h"

namespace photonlab {

/// How photonmapper finds its photons. [Jensen 2001, chapter 7]
enum class GatherMode {
    Radius,   ///< all within a fixed radius: variance vanishes with the number of photons, bias stays
    Nearest,  ///< the k nearest within a maximum radius: bias falls with the number of photons, variance stays near 1/k
    Relaxed,  ///< within a fixed radius those of the first pass, moved apart, with the flux of later ones: memory stays
};
inline constexpr std::array gather_mode_names{ChoiceName<GatherMode>{GatherMode::Radius, "radius"},
                                              ChoiceName<GatherMode>{GatherMode::Nearest, "nearest"},
                                              ChoiceName<GatherMode>{GatherMode::Relaxed, "relaxed"}};
constexpr const auto& choice_names(GatherMode) {
    return gather_mode_names;
}

/// Whether photons of mode `relaxed` move where their flux falls off.
enum class Features {
    Protected,  ///< along the edge of a feature alone
    Ignored,    ///< anywhere
};
inline constexpr std::array features_names{ChoiceName<Features>{Features::Protected, "protected"},
                                           ChoiceName<Features>{Features::Ignored, "ignored"}};
constexpr const auto& choice_names(Features) {
    return features_names;
}

/// Where light that comes straight from a light source is found.
enum class DirectMode {
    Sampled,  ///< by shadow rays at the hit points, anew in every pass; in the `direct` layer
    Photons,  ///< by photons, as in the 2008 paper; in the `gathered` layer, and `direct` is 0
};
inline constexpr std::array direct_mode_names{ChoiceName<DirectMode>{DirectMode::Sampled, "sampled"},
                                              ChoiceName<DirectMode>{DirectMode::Photons, "photons"}};
constexpr const auto& choice_names(DirectMode) {
    return direct_mode_names;
}

/// Where light paths begin.
enum class EmissionMode {
    Plain,     ///< lights by power, and each by what it emits
    Adaptive,  ///< more where paths were seen in earlier passes (transport/light/emission_map.h)
};
inline constexpr std::array emission_mode_names{ChoiceName<EmissionMode>{EmissionMode::Plain, "plain"},
                                                ChoiceName<EmissionMode>{EmissionMode::Adaptive, "adaptive"}};
constexpr const auto& choice_names(EmissionMode) {
    return emission_mode_names;
}

/// Which light paths leave their photons.
enum class PhotonPathMode {
    Independent,  ///< all
    Visible,      ///< those that are seen, by Markov chains (transport/light/visible_paths.h)
};
inline constexpr std::array photon_path_mode_names{
    ChoiceName<PhotonPathMode>{PhotonPathMode::Independent, "independent"},
    ChoiceName<PhotonPathMode>{PhotonPathMode::Visible, "visible"}};
constexpr const auto& choice_names(PhotonPathMode) {
    return photon_path_mode_names;
}

/// Which numbers light is emitted by.
enum class LightSequenceMode {
    Independent,
    Sobol,  ///< core/sobol.h
};
inline constexpr std::array light_sequence_names{
    ChoiceName<LightSequenceMode>{LightSequenceMode::Independent, "independent"},
    ChoiceName<LightSequenceMode>{LightSequenceMode::Sobol, "sobol"}};
constexpr const auto& choice_names(LightSequenceMode) {
    return light_sequence_names;
}

/// Where the radius of a schedule that tests its disc begins.
enum class StartRadius {
    Automatic,  ///< as for the others: `radius` or `footprints`
    Nearest,    ///< the distance of the photon number `test_photons` of the first pass
};
inline constexpr std::array start_radius_names{ChoiceName<StartRadius>{StartRadius::Automatic, "auto"},
                                               ChoiceName<StartRadius>{StartRadius::Nearest, "knn"}};
constexpr const auto& choice_names(StartRadius) {
    return start_radius_names;
}

/// Whether a method says what the error of its gathered light is (error_estimate.h).
enum class ErrorEstimation { Off, On };
inline constexpr std::array error_estimation_names{ChoiceName<ErrorEstimation>{ErrorEstimation::Off, "off"},
                                                   ChoiceName<ErrorEstimation>{ErrorEstimation::On, "on"}};
constexpr const auto& choice_names(ErrorEstimation) {
    return error_estimation_names;
}

/// Largest radius of mode `nearest` in shares of the scene's bounding radius, unless given: Mitsuba 0.6's default for
/// its global map.
inline constexpr double default_max_radius_share = 0.05;

/// Largest radius of the caustic map in shares of the global map's, unless given: the ratio of Mitsuba 0.6's defaults.
inline constexpr double default_caustic_share = 0.25;

inline constexpr double smallest_branch_cutoff = 1e-12;
inline constexpr double largest_branch_cutoff = 1.0;
inline constexpr int fewest_nearest = 2;  ///< the k-th photon sets the radius and carries no flux

struct MethodSettings {
    std::string integrator = "ppm";  ///< a name of integrator_kinds()
    GatherMode mode = GatherMode::Radius;
    ScheduleName schedule = ScheduleName::Hachisuka;
    PhotonPathMode photon_paths = PhotonPathMode::Independent;
    StepRule step_rule = StepRule::Logarithmic;
    EmissionMode emission = EmissionMode::Plain;
    int learn_passes = 16;
    LightSequenceMode light_sequence = LightSequenceMode::Independent;
    double alpha = 0.7;
    double kappa = 6.0;
    double smallest_radius = 0.125;  ///< of schedule "adaptive", in initial radii
    double largest_radius = 2.0;     ///< likewise
    double laplacian_radius = 2.0;   ///< in initial radii
    TestVariant test_variant = TestVariant::Plain;
    StartRadius start = StartRadius::Automatic;
    int test_photons = 10;
    double test_shrink = 0.8;
    double test_growth = 1.5625;
    Positions positions = Positions::Grid;
    Branches branches = Branches::All;
    GlossyMode glossy = GlossyMode::Gather;
    double gather_roughness = 0.2;
    ErrorEstimation estimate_error = ErrorEstimation::Off;
    int k = 120;
    std::optional<double> radius = std::nullopt;  ///< scene units; empty: from `footprints`
    double footprints = 2.0;
    std::optional<double> max_radius = std::nullopt;  ///< scene units; empty: from default_max_radius_share
    int caustic_k = 120;
    std::optional<double> caustic_radius = std::nullopt;      ///< scene units; empty: as `radius`
    std::optional<double> caustic_max_radius = std::nullopt;  ///< scene units; empty: from default_caustic_share
    int relaxation_steps = 10;
    Features features = Features::Protected;
    Kernel kernel = Kernel::Disc;
    AreaMode area = AreaMode::Seen;
    int area_lines = default_area_lines;
    double eps = 0.0;
    DirectMode direct = DirectMode::Sampled;
    int direct_samples = 1;
    int max_depth = -1;
    double branch_cutoff = default_branch_cutoff;
    std::uint64_t photons_per_pass = 100'000;
};

inline bool is_relaxed(const MethodSettings& settings) {
    return settings.mode == GatherMode::Relaxed;
}

/// Schedule chi-square takes photons for independent, which those of chains are not.
inline bool traces_visible_paths(const MethodSettings& settings) {
    return settings.photon_paths == PhotonPathMode::Visible && settings.schedule != ScheduleName::ChiSquare;
}

/// Radii that wait for the first pass's photons; chains need radii first.
inline bool starts_at_nearest(const MethodSettings& settings) {
    return settings.start == StartRadius::Nearest && tests_its_disc(settings.schedule) &&
           !traces_visible_paths(settings);
}

/// Chains find what is seen by themselves.
inline bool emits_adaptively(const MethodSettings& settings) {
    return settings.emission == EmissionMode::Adaptive && !traces_visible_paths(settings);
}

}  // namespace photonlab
