// The list of integrators. Adding one: a file NAME.cpp that defines NAME_kind(), its name in this folder's
// CMakeLists.txt, and a test.

#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "integrators/integrator.h"

namespace photonlab {

struct IntegratorKind {
    std::string_view name;
    std::string_view label;  ///< how figures name it
    std::string_view paper;  ///< that it follows
    Needs (*needs)(const MethodSettings&);
    std::vector<std::string_view> settings;  ///< fields of MethodSettings that it uses, by their names
    std::unique_ptr<Integrator> (*make)(const MethodSettings&, const IntegratorContext&);
    void (*check)(const MethodSettings&, const Scene&) = nullptr;  ///< throws InputError for what it cannot hold
};

const std::vector<IntegratorKind>& integrator_kinds();

/// What IntegratorKind::make is for a class that is made from settings and context.
template <typename Class>
std::unique_ptr<Integrator> make_integrator_of(const MethodSettings& settings, const IntegratorContext& context) {
    return std::make_unique<Class>(settings, context);
}

/// The kind called `name`; InputError names the known ones.
const IntegratorKind& find_integrator_kind(std::string_view name,
                                           const std::vector<IntegratorKind>& kinds = integrator_kinds());

/// What the method of these settings needs.
Needs needs_of(const MethodSettings& settings);

/// True when the method uses the field of MethodSettings called `field`, given its other choices as well (k only in
/// mode "nearest", direct_samples only with direct "sampled", ...).
bool uses_setting(const MethodSettings& settings, std::string_view field);

/// Names of the integrators that have the setting, in the order of the list.
std::vector<std::string_view> users_of(std::string_view field);

/// Throws InputError when a value is out of its range.
void require_valid(const MethodSettings& settings);

/// Throws InputError when the image would merely be wrong: a length is out of what float32 geometry can resolve in the
/// scene, or the scene has light that the method cannot hold.
void require_renderable(const MethodSettings& settings, const Scene& scene);
void require_renderable(const IntegratorKind& kind, const MethodSettings& settings, const Scene& scene);

/// At how many hit points the radius from `footprints` is smaller than the scene's floats resolve and is raised to what
/// they do: there the image is coarser than its pixels.
std::uint64_t count_raised_radii(const MethodSettings& settings, const HitPoints& hit_points);

/// The same as a sentence, where there are any.
std::optional<std::string> note_of_raised_radii(const MethodSettings& settings, const Scene& scene,
                                                const HitPoints& hit_points);

/// Checks the settings and makes an integrator of the kind.
std::unique_ptr<Integrator> make_integrator(const IntegratorKind& kind, const MethodSettings& settings,
                                            const IntegratorContext& context);

}  // namespace photonlab
