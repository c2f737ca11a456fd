// Names of choices: an enumeration's spelling in experiment files, on the command line and in records. One table a
// choice, used both ways, so that what is written can always be read.

#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "core/text/nearest.h"

namespace photonlab {

/// One choice of an enumeration and how users spell it. A choice's table is a constexpr array of these, found by
/// `choice_names(Enumeration)` beside the enumeration.
template <typename Enumeration>
struct ChoiceName {
    Enumeration value;
    std::string_view name;
};

/// The spelling of `value`.
template <typename Enumeration>
std::string name_of(Enumeration value) {
    for (const auto& choice : choice_names(value))
        if (choice.value == value) return std::string(choice.name);
    return "?";
}

/// Every spelling.
template <typename Enumeration>
std::vector<std::string_view> all_names() {
    std::vector<std::string_view> names;
    for (const auto& choice : choice_names(Enumeration{})) names.push_back(choice.name);
    return names;
}

/// The choice spelled `name`; `what` names the setting in the InputError that anything else raises.
template <typename Enumeration>
Enumeration parse_choice(std::string_view what, std::string_view name) {
    for (const auto& choice : choice_names(Enumeration{}))
        if (choice.name == name) return choice.value;
    throw InputError(unknown_name(what, name, all_names<Enumeration>()));
}

}  // namespace photonlab
