// What the program prints: answers on standard output, messages on standard error. Either may be closed, a full disk or
// a pipe whose reader has left, and no work ends because of that. A message that cannot be written is lost; of an
// answer it is remembered, so that the program can say so when all its files are written.

#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <utility>

#include "core/text/text.h"

namespace photonlab {

/// Where 0, 1 or 2 is not open, opens something there that can be neither read nor written: else the next file that the
/// program opens would be taken for its standard output. Called first of all.
void occupy_standard_streams();

/// Writes the bytes as they are.
void write_output(std::string_view bytes);
void write_message(std::string_view bytes);

/// Why something of what was printed as output did not arrive; empty when all did.
std::string output_failure();

/// Prints text, made printable().
template <typename... Values>
void print_output(fmt::format_string<Values...> format, Values&&... values) {
    write_output(printable(fmt::format(format, std::forward<Values>(values)...)));
}

template <typename... Values>
void print_message(fmt::format_string<Values...> format, Values&&... values) {
    write_message(printable(fmt::format(format, std::forward<Values>(values)...)));
}

}  // namespace photonlab
