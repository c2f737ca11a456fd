// Lights as the scene has them: a shape that shines, alike everywhere or by a texture, or one of the kinds that no
// shape bears, which src/scene/CMakeLists.txt lists. To add one of those: a file with a struct that answers what
// SceneLightKind in light_kind.h asks, its name in the list, and a test.

#pragma once

#include <utility>

#include "scene/emitters/area_light.h"
#include "scene/emitters/scene_light_list.h"
#include "scene/emitters/textured_area_light.h"

namespace photonlab {

template <typename... Kinds>
std::variant<typename Kinds::Description...> described_light(const std::variant<Kinds...>&);
template <typename... Kinds>
std::variant<AreaLight, TexturedAreaLight, Kinds...> any_light(const std::variant<Kinds...>&);

/// A light that no shape bears, in scene units.
using LightDescription = decltype(described_light(std::declval<SceneLight>()));
/// Any light, in the unit box.
using Light = decltype(any_light(std::declval<SceneLight>()));

struct Emitter {
    Light kind;
    ColorD power;                      ///< of the whole emitter
    double choice_probability;         ///< with which lights are chosen: by mean_channel(power) * sampling weight
    double choice_cdf;                 ///< running sum of choice_probability, the last emitter's is 1
    Color photon_power = Color(0.0f);  ///< what a photon starts with in the mean: power / (choice_probability *
                                       ///< total_power)
};

/// The kind of light, as scene files call it.
inline const char* emitter_kind(const Emitter& emitter) {
    return std::visit([]<typename Kind>(const Kind&) { return Kind::name; }, emitter.kind);
}

/// Index of the shape that bears it, where one does.
inline std::optional<std::uint32_t> shape_of(const Light& light) {
    return std::visit(
        []<typename Kind>(const Kind& kind) -> std::optional<std::uint32_t> {
            if constexpr (requires { kind.shape; })
                return kind.shape;
            else
                return std::nullopt;
        },
        light);
}

/// False when no ray from the camera can find it, but by shadow rays.
inline bool is_met_by_rays(const Emitter& emitter) {
    return std::visit([]<typename Kind>(const Kind&) { return Kind::is_met_by_rays; }, emitter.kind);
}

/// Throws InputError for what cannot be rendered.
void require_valid(const LightDescription& light);

/// "file:line" for messages.
const std::string& place_of(const LightDescription& light);

/// How often it is chosen for its power: 1 unless the scene file says otherwise.
double sampling_weight_of(const LightDescription& light);

/// True for a light around the scene, of which there can be one.
bool is_environment(const LightDescription& light);
bool is_environment(const Light& light);

/// Throws InputError at the second light around the scene.
void require_one_environment(const std::vector<LightDescription>& lights);

/// Scene units; empty when it lies at infinity.
Bounds bounds_of(const LightDescription& light);

Light place_light(const LightDescription& light, const SceneExtent& extent);

}  // namespace photonlab
