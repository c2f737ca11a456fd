#include "integrators/registry.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/text/nearest.h"
#include "integrators/density_estimate.h"
#include "integrators/integrator_list.h"
#include "integrators/settings/settings_table.h"

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

namespace {

bool has_setting(const IntegratorKind& kind, std::string_view field) {
    return field == "integrator" || std::find(kind.settings.begin(), kind.settings.end(), field) != kind.settings.end();
}

}  // namespace

bool uses_setting(const MethodSettings& settings, std::string_view field) {
    const SettingField* known = find_setting_field(field);
    return known && has_setting(find_integrator_kind(settings.integrator), field) && known->applies(settings);
}

std::vector<std::string_view> users_of(std::string_view field) {
    std::vector<std::string_view> users;
    for (const IntegratorKind& kind : integrator_kinds())
        if (has_setting(kind, field)) users.push_back(kind.name);
    return users;
}

namespace {

void require_all_in_range(const MethodSettings& settings) {
    for (const SettingField& field : setting_fields()) require_in_range(field, settings);
}

}  // namespace

void require_valid(const MethodSettings& settings) {
    find_integrator_kind(settings.integrator);
    require_all_in_range(settings);
}

void require_renderable(const MethodSettings& settings, const Scene& scene) {
    require_renderable(find_integrator_kind(settings.integrator), settings, scene);
}

void require_renderable(const IntegratorKind& kind, const MethodSettings& settings, const Scene& scene) {
    for (const SettingField& field : setting_fields()) {
        if (field.type != SettingField::Type::Length) continue;
        const SettingValue value = field.get(settings);
        const auto* length = std::get_if<double>(&value);
        const double share = length ? *length / scene.unit_length : 1.0;
        if (!(share >= smallest_initial_radius && share <= largest_length))
            throw InputError(
                fmt::format("{}: expected from {:g} to {:g} of the scene, which is {:g} scene units large, got {:g}",
                            field.name, smallest_initial_radius, largest_length, scene.unit_length, *length));
    }
    if (kind.check) kind.check(settings, scene);
}

std::uint64_t count_raised_radii(const MethodSettings& settings, const HitPoints& hit_points) {
    if (!uses_setting(settings, "footprints")) return 0;
    return static_cast<std::uint64_t>(
        std::count_if(hit_points.footprints.begin(), hit_points.footprints.end(), [&](float footprint) {
            return settings.footprints * static_cast<double>(footprint) < smallest_initial_radius;
        }));
}

std::optional<std::string> note_of_raised_radii(const MethodSettings& settings, const Scene& scene,
                                                const HitPoints& hit_points) {
    const std::uint64_t raised = count_raised_radii(settings, hit_points);
    if (raised == 0) return std::nullopt;
    return fmt::format(
        "at {} of {} hit points {:g} footprints of the pixel are less than {:g} of the scene, which is {:g} scene "
        "units "
        "large, and than its floats resolve: the radius there is {:.3g}",
        raised, hit_points.footprints.size(), settings.footprints, smallest_initial_radius, scene.unit_length,
        smallest_initial_radius * scene.unit_length);
}

std::unique_ptr<Integrator> make_integrator(const IntegratorKind& kind, const MethodSettings& settings,
                                            const IntegratorContext& context) {
    require_all_in_range(settings);
    require_renderable(kind, settings, context.scene);
    return kind.make(settings, context);
}

}  // namespace photonlab
