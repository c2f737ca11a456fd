#include "core/text/csv.h"

#include "core/text/number_in.h"
#include "core/text/text.h"

namespace photonlab {

std::string csv_cell(const std::string& text) {
    const std::size_t first = text.find_first_not_of('\'');
    const bool is_formula =
        first != std::string::npos && std::string_view("=+-@\t\r").find(text[first]) != std::string_view::npos;
    const bool is_number =
        number_in<double>(text.starts_with('+') ? std::string_view(text).substr(1) : text).has_value();
    std::string cell = valid_text(text);
    if (is_formula && !is_number) cell.insert(0, 1, '\'');
    if (cell.find_first_of(",\"\r\n") == std::string::npos) return cell;
    std::string quoted = "\"";
    for (const char c : cell) {
        if (c == '"') quoted += '"';
        quoted += c;
    }
    return quoted + '"';
}

}  // namespace photonlab
