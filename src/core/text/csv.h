// Tables as comma-separated values, RFC 4180.

#pragma once

#include <string>

namespace photonlab {

/// A value as it stands in a table: in quotes when it holds a comma, a quote or a line end, as RFC 4180 wants it. What
/// a spreadsheet would take for a formula, a text that begins with = + - @, a tab or a carriage return and is no
/// number, gets an apostrophe in front, as does what begins so behind apostrophes: whoever takes one away again has the
/// text back. [OWASP, "CSV Injection"]
std::string csv_cell(const std::string& text);

}  // namespace photonlab
