// Ranges of passes: what one of several nodes takes of a run, and what a state is of.

#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <vector>

namespace photonlab {

/// Passes `first` to `last`, both included; 1 <= first <= last.
struct PassRange {
    std::uint64_t first = 1;
    std::uint64_t last = 1;

    std::uint64_t count() const { return last - first + 1; }
    bool operator==(const PassRange&) const = default;
};

inline std::uint64_t count_passes(const std::vector<PassRange>& ranges) {
    std::uint64_t count = 0;
    for (const PassRange& range : ranges) count += range.count();
    return count;
}

/// "17..32", as --passes takes it.
inline std::string describe(const PassRange& range) {
    return fmt::format("{}..{}", range.first, range.last);
}

/// "1..16 17..32"; empty for passes from the first on that were made in one piece.
inline std::string describe(const std::vector<PassRange>& ranges) {
    if (ranges.empty() || (ranges.size() == 1 && ranges[0].first == 1)) return "";
    std::string text;
    for (const PassRange& range : ranges) {
        if (!text.empty()) text += ' ';
        text += describe(range);
    }
    return text;
}

}  // namespace photonlab
