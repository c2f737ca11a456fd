// How the mutations of visible light paths find their size (visible_paths.h).

#pragma once

#include <array>

#include "core/text/names.h"

namespace photonlab {

/// How the step size d follows the share a of mutations that were accepted in pass i, towards 0.234.
enum class StepRule {
    Logarithmic,      ///< d exp((a / 0.234 - 1) i^-0.6)
    HachisukaJensen,  ///< d + (A - 0.234) / i, with A the share over all passes so far
};
inline constexpr std::array step_rule_names{ChoiceName<StepRule>{StepRule::Logarithmic, "logarithmic"},
                                            ChoiceName<StepRule>{StepRule::HachisukaJensen, "hachisuka-jensen"}};
constexpr const auto& choice_names(StepRule) {
    return step_rule_names;
}

}  // namespace photonlab
