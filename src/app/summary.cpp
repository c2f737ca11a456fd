#include "app/summary.h"

#include <fmt/format.h>

#include "core/text/messages.h"
#include "core/text/progress.h"
#include "integrators/registry.h"

namespace photonlab {

void print_summary(const RunState& state, const RunSettings& settings, const Scene& scene, std::size_t hit_points,
                   const std::optional<ErrorMetrics>& errors) {
    const std::string ranges = describe(state.ranges);
    print_output("{}: {} passes{} of {}, {} hit points, seed {}\n", scene.name, count_passes(state.ranges),
                 ranges.empty() ? "" : fmt::format(", {},", ranges), settings.method.integrator, hit_points,
                 settings.seed);
    const Needs needs = needs_of(settings.method);
    const auto time_of = [&](Stage stage) { return describe_duration(state.times.of(stage)); };
    print_output("time        {} (CPU {}): trace {}, build {}, gather {}, direct light {}{}{}\n",
                 describe_duration(state.times.total()), describe_duration(state.times.cpu_total()),
                 time_of(Stage::Trace), time_of(Stage::Build), time_of(Stage::Gather), time_of(Stage::Direct),
                 needs.new_points ? ", hit points " + time_of(Stage::Points) : "",
                 needs.holds_photons ? ", relaxation " + time_of(Stage::Relax) : "");
    if (state.paths_emitted > 0)
        print_output("photons     {} stored of {} paths, {} gathered\n", state.photons_stored, state.paths_emitted,
                     state.report.photons_gathered);
    if (state.paths_seen)
        print_output("paths       {} traced; of the last pass's {:.3g}% were seen{}\n", state.paths_traced,
                     100.0 * *state.paths_seen,
                     state.mutations_accepted
                         ? fmt::format(", and {:.3g}% of the mutations", 100.0 * *state.mutations_accepted)
                         : "");
    if (state.report.radius_mean && state.initial_radius)
        print_output("radius      {:.6g} at first, {:.6g} at the end (mean over hit points, scene units)\n",
                     *state.initial_radius, *state.report.radius_mean);
    if (state.paths_cut > 0) print_output("cut         {} photon paths ended by the cap on edges\n", state.paths_cut);
    if (state.report.photons_left_out > 0)
        print_output("left out    {} photons that found none of the first pass to bring their flux to\n",
                     state.report.photons_left_out);
    if (state.report.inexact_additions > 0)
        print_output("sums        {} additions were not exact: other ranges of passes may differ in last bits\n",
                     state.report.inexact_additions);
    if (errors) {
        print_output("rmse        {}\n", describe_rmse(*errors));
        const std::optional<double> unbiased = errors->of("mse_unbiased");
        if (unbiased)
            print_output("mse         {:.6g}; without the reference's noise {:.6g}\n", *errors->of("mse"), *unbiased);
    }
}

void print_reference(const std::filesystem::path& folder, const Json& json) {
    print_output("{}: {} samples a half and sample position, {}x{}, {} so far\n", folder.string(),
                 json.at("samples_per_half").get<std::uint64_t>(), json.at("width").get<int>(),
                 json.at("height").get<int>(), describe_duration(json.at("seconds").get<double>()));
    for (const auto& [component, floor] : json.at("floor_mse").items())
        if (floor.is_number()) print_output("noise floor (MSE) of {:<9} {:.6g}\n", component, floor.get<double>());
    const Json& check = json.at("check");
    print_output("light by photons: {}: {}\n", check.at("verdict").get<std::string>(),
                 check.at("why").get<std::string>());
    if (check.at("verdict") == "disputed")
        print_output(
            "what is missing is in no noise floor; --integrator ppm, into another folder, makes a reference of "
            "photons\n");
}

std::filesystem::path columns_file(std::filesystem::path csv) {
    return csv.replace_extension(".columns.json");
}

}  // namespace photonlab
