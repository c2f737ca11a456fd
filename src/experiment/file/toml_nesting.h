// What toml++ must not be given: it makes a table for every name of a key that is joined by dots, and takes them down
// again by recursion, so that a key of 250,000 names ends the program.

#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace photonlab {

/// More than any key here has.
inline constexpr std::size_t most_joined_names = 16;

/// The first line, from 1, that joins more names by dots; empty when there is none. Text in quotes and comments hold no
/// names, and lists and tables in each other are for toml++ to count.
std::optional<std::size_t> line_nested_too_deeply(std::string_view toml);

}  // namespace photonlab
