// What `render` and `join` say at their end.

#pragma once

#include <filesystem>
#include <optional>

#include "core/files/json.h"
#include "image/metrics.h"
#include "render/pass_loop.h"
#include "scene/scene.h"

namespace photonlab {

void print_summary(const RunState& state, const RunSettings& settings, const Scene& scene, std::size_t hit_points,
                   const std::optional<ErrorMetrics>& errors);

/// What reference.json in the folder says.
void print_reference(const std::filesystem::path& folder, const Json& json);

/// What says beside a table what its columns are.
std::filesystem::path columns_file(std::filesystem::path csv);

}  // namespace photonlab
