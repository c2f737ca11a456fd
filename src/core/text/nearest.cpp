#include "core/text/nearest.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>

namespace photonlab {

namespace {

std::string without_case(std::string_view name) {
    std::string plain(name);
    for (char& c : plain) {
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
        if (c == '_') c = '-';
    }
    return plain;
}

/// Letters added, dropped, replaced, or exchanged with their neighbour.
/// [Damerau 1964, "A technique for computer detection and correction of spelling errors"; each letter changed once]
std::size_t changes_between(const std::string& a, const std::string& b) {
    // Three rows of the table of changes between the beginnings of both.
    std::vector<std::size_t> before(b.size() + 1), above(b.size() + 1), row(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        row[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
        std::swap(before, above);
        std::swap(above, row);
    }
    return above[b.size()];
}

}  // namespace

std::string_view nearest_name(std::string_view written, const std::vector<std::string_view>& known) {
    constexpr std::size_t longest = 100;  // no name here is longer, and the table grows with both
    if (written.size() > longest) return {};
    const std::string plain = without_case(written);
    std::string_view nearest;
    std::size_t fewest = longest;
    for (const std::string_view name : known) {
        const std::size_t changes = changes_between(plain, without_case(name));
        if (changes < fewest && 3 * changes <= std::max(written.size(), name.size())) {
            nearest = name;
            fewest = changes;
        }
    }
    if (!nearest.empty() || written.size() < 2) return nearest;
    const auto begun = std::find_if(known.begin(), known.end(),
                                    [&](std::string_view name) { return without_case(name).starts_with(plain); });
    return begun == known.end() ? std::string_view() : *begun;
}

std::string did_you_mean(std::string_view written, const std::vector<std::string_view>& known) {
    const std::string_view nearest = nearest_name(written, known);
    return nearest.empty() ? "" : fmt::format("; did you mean \"{}\"?", nearest);
}

std::string unknown_name(std::string_view what, std::string_view written, const std::vector<std::string_view>& known) {
    const std::string guess = did_you_mean(written, known);
    return fmt::format("unknown {} \"{}\"{}{}{}", what, written, guess,
                       guess.empty() ? "; known here: " : " Known here: ", fmt::join(known, ", "));
}

}  // namespace photonlab
