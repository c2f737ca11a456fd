#include "scene/emitters/light.h"

#include <fmt/format.h>

#include "core/error.h"

namespace photonlab {

void require_light(const ColorD& light, const std::string& place, std::string_view what) {
    if (!is_finite(light) || light.x < 0.0 || light.y < 0.0 || light.z < 0.0)
        throw InputError(place, fmt::format("{}: expected finite values of at least 0, got {} {} {}", what, light.x,
                                            light.y, light.z));
}

void require_valid(const LightDescription& light) {
    std::visit([](const auto& description) { description.check(); }, light);
}

const std::string& place_of(const LightDescription& light) {
    return std::visit([](const auto& description) -> const std::string& { return description.place; }, light);
}

Bounds bounds_of(const LightDescription& light) {
    return std::visit([](const auto& description) { return description.bounds(); }, light);
}

double sampling_weight_of(const LightDescription& light) {
    return std::visit([](const auto& description) { return description.sampling_weight; }, light);
}

namespace {

template <typename... Kinds>
bool is_environment_of(const LightDescription& light, const std::variant<Kinds...>*) {
    return ((EnvironmentKind<Kinds> && std::holds_alternative<typename Kinds::Description>(light)) || ...);
}

}  // namespace

bool is_environment(const LightDescription& light) {
    return is_environment_of(light, static_cast<const SceneLight*>(nullptr));
}

void require_one_environment(const std::vector<LightDescription>& lights) {
    const LightDescription* first = nullptr;
    for (const LightDescription& light : lights) {
        if (!is_environment(light)) continue;
        if (first)
            throw InputError(
                place_of(light),
                fmt::format("expected one light around the scene, got a second; the first is at {}", place_of(*first)));
        first = &light;
    }
}

bool is_environment(const Light& light) {
    return std::visit([]<typename Kind>(const Kind&) { return EnvironmentKind<Kind>; }, light);
}

Light place_light(const LightDescription& light, const SceneExtent& extent) {
    return std::visit([&](const auto& description) -> Light { return description.placed(extent); }, light);
}

}  // namespace photonlab
