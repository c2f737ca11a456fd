#include "integrators/registry.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/nearest.h"
#include "integrators/density_estimate.h"
#include "integrators/integrator_list.h"

namespace photonlab {

const std::vector<IntegratorKind>& integrator_kinds() {
    static const std::vector<IntegratorKind> kinds = listed_integrator_kinds();
    return kinds;
}

const IntegratorKind& find_integrator_kind(std::string_view name, const std::vector<IntegratorKind>& kinds) {
    std::vector<std::string_view> known;
    for (const IntegratorKind& kind : kinds) {
        if (kind.name == name) return kind;
        known.push_back(kind.name);
    }
    throw InputError(unknown_name("integrator", name, known));
}

Needs needs_of(const MethodSettings& settings) {
    return find_integrator_kind(settings.integrator).needs(settings);
}

bool uses_setting(const MethodSettings& settings, std::string_view field) {
    if (field == "integrator") return true;
    const auto& used = find_integrator_kind(settings.integrator).settings;
    if (std::find(used.begin(), used.end(), field) == used.end()) return false;
    if (field == "k" || field == "max_radius" || field == "caustic_k" || field == "caustic_max_radius")
        return settings.mode == GatherMode::Nearest;
    if (field == "footprints") return uses_setting(settings, "radius") && !settings.radius;
    if (field == "radius" || field == "caustic_radius") return settings.mode == GatherMode::Radius;
    if (field == "direct_samples") return settings.direct == DirectMode::Sampled;
    return true;
}

namespace {

void require_in_range(const MethodSettings& settings) {
    const auto require = [](bool valid, const std::string& expectation) {
        if (!valid) throw InputError(expectation);
    };
    const auto is_length = [](const std::optional<double>& length) {
        return !length || (std::isfinite(*length) && *length > 0.0);
    };
    require_alpha(settings.alpha);
    require(settings.k >= fewest_nearest, "k: expected at least 2 photons, got " + std::to_string(settings.k));
    require(is_length(settings.radius), "radius: expected \"auto\" or a length above 0 in scene units");
    require(std::isfinite(settings.footprints) && settings.footprints > 0.0,
            fmt::format("footprints: expected a number above 0, got {}", settings.footprints));
    require(is_length(settings.max_radius), "max_radius: expected \"auto\" or a length above 0 in scene units");
    require(settings.caustic_k >= fewest_nearest,
            "caustic_k: expected at least 2 photons, got " + std::to_string(settings.caustic_k));
    require(is_length(settings.caustic_radius), "caustic_radius: expected \"auto\" or a length above 0 in scene units");
    require(is_length(settings.caustic_max_radius),
            "caustic_max_radius: expected \"auto\" or a length above 0 in scene units");
    require(settings.direct_samples >= 1,
            "direct_samples: expected at least 1, got " + std::to_string(settings.direct_samples));
    require(settings.max_depth == -1 || settings.max_depth >= 1,
            "max_depth: expected -1 (unlimited) or at least 1, got " + std::to_string(settings.max_depth));
    require(std::isfinite(settings.eps) && settings.eps >= 0.0,
            fmt::format("eps: expected at least 0, which is exact, got {}", settings.eps));
    require(settings.branch_cutoff >= smallest_branch_cutoff && settings.branch_cutoff <= largest_branch_cutoff,
            fmt::format("branch_cutoff: expected a throughput from {:g} to {:g}, got {}", smallest_branch_cutoff,
                        largest_branch_cutoff, settings.branch_cutoff));
    constexpr std::uint64_t most_photons = std::uint64_t{1} << 32;
    require(settings.photons_per_pass >= 1 && settings.photons_per_pass <= most_photons,
            fmt::format("photons_per_pass: expected from 1 to {}, got {}", most_photons, settings.photons_per_pass));
}

/// A radius that float32 geometry cannot resolve would give an image that is merely wrong.
void require_resolvable(std::string_view name, const std::optional<double>& radius, const Scene& scene) {
    if (!radius) return;
    const double share = *radius / scene.unit_length;
    if (!(share >= smallest_initial_radius && share <= largest_length))
        throw InputError(
            fmt::format("{}: expected from {:g} to {:g} of the scene, which is {:g} scene units large, got {:g}", name,
                        smallest_initial_radius, largest_length, scene.unit_length, *radius));
}

}  // namespace

void require_valid(const MethodSettings& settings) {
    find_integrator_kind(settings.integrator);
    require_in_range(settings);
}

void require_resolvable(const MethodSettings& settings, const Scene& scene) {
    require_resolvable("radius", settings.radius, scene);
    require_resolvable("max_radius", settings.max_radius, scene);
    require_resolvable("caustic_radius", settings.caustic_radius, scene);
    require_resolvable("caustic_max_radius", settings.caustic_max_radius, scene);
}

std::unique_ptr<Integrator> make_integrator(const IntegratorKind& kind, const MethodSettings& settings,
                                            const IntegratorContext& context) {
    require_in_range(settings);
    require_resolvable(settings, context.scene);
    return kind.make(settings, context);
}

}  // namespace photonlab
