#include "core/text/text.h"

#include <algorithm>

namespace photonlab {

std::size_t find_no_text(std::string_view bytes, std::size_t from) {
    for (std::size_t i = from; i < bytes.size();) {
        const auto byte = [&](std::size_t at) -> unsigned {
            return at < bytes.size() ? static_cast<unsigned char>(bytes[at]) : 0u;
        };
        const unsigned first = byte(i);
        const std::size_t length = first < 0x80 ? 1 : first < 0xc2 ? 0 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
        if (first == 0 || length == 0 || first > 0xf4) return i;
        unsigned code = length == 1 ? first : first & (0x7fu >> length);
        for (std::size_t k = 1; k < length; ++k) {
            if ((byte(i + k) & 0xc0) != 0x80) return i;
            code = code << 6 | (byte(i + k) & 0x3f);
        }
        const bool is_too_long = (length == 3 && code < 0x800) || (length == 4 && code < 0x10000);
        const bool is_surrogate = code >= 0xd800 && code < 0xe000;
        if (is_too_long || is_surrogate || code > 0x10ffff) return i;
        i += length;
    }
    return std::string_view::npos;
}

std::string valid_text(std::string_view bytes) {
    constexpr std::string_view replacement = "\xef\xbf\xbd";  // U+FFFD
    std::string text;
    std::size_t begin = 0;
    for (std::size_t at; (at = find_no_text(bytes, begin)) != bytes.npos; begin = at + 1) {
        text += bytes.substr(begin, at - begin);
        text += replacement;
    }
    return text += bytes.substr(begin);
}

std::string printable(std::string text) {
    for (std::size_t at = 0; (at = find_no_text(text, at)) != text.npos; ++at) text[at] = '?';
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return (c < 0x20 && c != '\n') || c == 0x7f; }, ' ');
    // Control characters of two bytes, U+0080 to U+009F.
    for (std::size_t i = 0; i + 1 < text.size(); ++i)
        if (text[i] == '\xc2' && static_cast<unsigned char>(text[i + 1]) < 0xa0) text[i] = text[i + 1] = ' ';
    return text;
}

std::string_view first_columns(std::string_view text, std::size_t columns) {
    std::size_t used = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if ((byte & 0xc0) == 0x80) continue;  // goes on with a character
        const bool may_be_wide =
            byte >= 0xe2 || (byte == 0xe1 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) >= 0x84);
        used += may_be_wide ? 2 : 1;
        if (used > columns) return text.substr(0, i);
    }
    return text;
}

}  // namespace photonlab
