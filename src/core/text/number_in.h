// Numbers from text, all of it: no blanks, no sign but a minus, nothing behind.

#pragma once

#include <charconv>
#include <optional>
#include <string_view>

namespace photonlab {

/// Empty when the text is not a number of this type, or one that it cannot hold. Floating-point types take inf and nan.
template <typename Number>
std::optional<Number> number_in(std::string_view text) {
    Number number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
    return number;
}

}  // namespace photonlab
