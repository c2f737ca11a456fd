// What somebody meant who misspelt a name: the known one that is the fewest changes away.

#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace photonlab {

/// The known name that `written` is taken for: at most one change for every three letters away (a letter too many, too
/// few or wrong, or two neighbours exchanged), or begun by it. Capitals, - and _ make no difference. Empty when there
/// is none.
std::string_view nearest_name(std::string_view written, const std::vector<std::string_view>& known);

/// `; did you mean "disc"?`, or nothing.
std::string did_you_mean(std::string_view written, const std::vector<std::string_view>& known);

/// `unknown kernel "disk"; did you mean "disc"? Known here: disc, cone`, with `what` in place of kernel.
std::string unknown_name(std::string_view what, std::string_view written, const std::vector<std::string_view>& known);

}  // namespace photonlab
