// How long paths get, wherever they begin: the depth that the scene asks for, roulette, and a cap on what roulette
// cannot end.

#pragma once

#include <cstdint>

namespace photonlab {

/// True when a path of `edges` edges from camera to light may count; max_depth -1 is unlimited.
inline bool depth_allows(int max_depth, std::uint32_t edges) {
    return max_depth < 0 || edges <= static_cast<std::uint32_t>(max_depth);
}

/// Ends light that is trapped between mirrors or in glass; what it cuts is counted.
inline constexpr std::uint32_t largest_path_edges = 10'000;

/// The largest probability to survive roulette, so that a path among white surfaces ends, too.
inline constexpr float highest_survival = 0.99f;

}  // namespace photonlab
