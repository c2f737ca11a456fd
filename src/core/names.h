// Names of choices: an enumeration's spelling in experiment files, on the command line and in records. One table a
// choice, used both ways, so that what is written can always be read.

#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/error.h"

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

/// Every spelling, separated by ", ".
template <typename Enumeration>
std::string all_names() {
    std::string list;
    for (const auto& choice : choice_names(Enumeration{}))
        list += (list.empty() ? "" : ", ") + std::string(choice.name);
    return list;
}

/// The choice spelled `name`; `what` names the setting in the InputError that anything else raises.
template <typename Enumeration>
Enumeration parse_choice(std::string_view what, std::string_view name) {
    for (const auto& choice : choice_names(Enumeration{}))
        if (choice.name == name) return choice.value;
    throw InputError("unknown " + std::string(what) + " \"" + std::string(name) +
                     "\"; known here: " + all_names<Enumeration>());
}

}  // namespace photonlab
