#include "experiment/file/toml_nesting.h"

#include <algorithm>

namespace photonlab {

namespace {

/// Position behind the quoted text that begins at `begin`; one that has no end goes on to the file's.
std::size_t end_of_quoted(std::string_view toml, std::size_t begin) {
    const char quote = toml[begin];
    const std::string_view three = toml.substr(begin, 3);
    const bool has_lines = three.size() == 3 && std::count(three.begin(), three.end(), quote) == 3;
    const std::string_view end = has_lines ? three : three.substr(0, 1);
    for (std::size_t i = begin + end.size(); i < toml.size(); ++i) {
        if (quote == '"' && toml[i] == '\\')
            ++i;
        else if (toml.substr(i, end.size()) == end)
            return i + end.size();
        else if (!has_lines && toml[i] == '\n')
            return i;
    }
    return toml.size();
}

bool is_in_name(char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == '-' ||
           c == ' ' || c == '\t' || static_cast<unsigned char>(c) >= 0x80;
}

}  // namespace

std::optional<std::size_t> line_nested_too_deeply(std::string_view toml) {
    std::size_t line = 1;
    std::size_t names = 1;
    for (std::size_t i = 0; i < toml.size();) {
        const char c = toml[i];
        std::size_t next = i + 1;
        if (c == '"' || c == '\'')
            next = end_of_quoted(toml, i);
        else if (c == '#')
            next = std::min(toml.find('\n', i), toml.size());
        else if (c == '.')
            ++names;
        else if (!is_in_name(c))
            names = 1;
        if (names > most_joined_names) return line;
        line += static_cast<std::size_t>(std::count(toml.begin() + i, toml.begin() + next, '\n'));
        i = next;
    }
    return std::nullopt;
}

}  // namespace photonlab
