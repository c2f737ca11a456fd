// Text that others read: terminals, tables, JSON. What comes from outside, the names of files above all, can hold any
// byte, and none of these readers takes every byte.

#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace photonlab {

/// Position, at or after `from`, of the first byte that is not part of UTF-8 text, which a NUL is not either here; npos
/// when all is.
std::size_t find_no_text(std::string_view bytes, std::size_t from = 0);

/// `bytes` as UTF-8: what is none becomes U+FFFD, a byte each.
std::string valid_text(std::string_view bytes);

/// What any terminal can show, however hostile the file that it quotes: what is no UTF-8 becomes question marks,
/// control characters become spaces; line ends stay.
std::string printable(std::string text);

/// The beginning of `text` that is at most so many columns wide on a terminal. Characters from U+1100 on are counted as
/// two, which some are, so that the line never goes beyond.
std::string_view first_columns(std::string_view text, std::size_t columns);

}  // namespace photonlab
