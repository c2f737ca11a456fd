// The tables of docs/manual.md that follow from the program's own: integrators, settings, columns. The target `manual`
// writes them into the page, between two lines each, and a test compares.
//
//     <!-- settings: written by the target manual -->
//     ...
//     <!-- end of settings -->

#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <regex>
#include <stdexcept>
#include <string>

#include "integrators/registry.h"
#include "integrators/settings/settings_table.h"
#include "record/columns.h"

namespace photonlab {

inline std::string in_cell(const std::string& text) {
    return std::regex_replace(text, std::regex("\\|"), "\\|");
}

inline std::string table_of_integrators() {
    std::string table = "| integrator | called | after | settings |\n| --- | --- | --- | --- |\n";
    for (const IntegratorKind& kind : integrator_kinds())
        table += fmt::format("| `{}` | {} | {} | `{}` |\n", kind.name, kind.label, kind.paper,
                             fmt::join(kind.settings, "`, `"));
    return table;
}

inline std::string table_of_settings() {
    std::string table =
        "| setting | option | unit | default | can be | meaning |\n| --- | --- | --- | --- | --- | --- |\n";
    for (const SettingField& field : setting_fields()) {
        if (field.name == "integrator") continue;
        table += fmt::format("| `{}` | `{}` | {} | {} | {} | {} |\n", field.name, field.option, field.unit,
                             default_of(field), in_cell(describe_values(field)), in_cell(std::string(field.meaning)));
    }
    return table;
}

inline std::string table_of_columns() {
    std::string table = "| column | kind | unit | meaning |\n| --- | --- | --- | --- |\n";
    for (const Column& column : columns())
        table += fmt::format("| `{}` | {} | {} | {} |\n", column.name, name_of(column.kind), column.unit,
                             in_cell(column.meaning));
    return table;
}

/// The page with its tables as they should be.
inline std::string with_tables(std::string page) {
    for (const auto& [name, table] : {std::pair{"integrators", table_of_integrators()},
                                      {"settings", table_of_settings()},
                                      {"columns", table_of_columns()}}) {
        const std::string begin = fmt::format("<!-- {}: written by the target manual -->\n\n", name);
        const std::string end = fmt::format("<!-- end of {} -->", name);
        const std::size_t from = page.find(begin);
        const std::size_t to = page.find(end, from);
        if (from == std::string::npos || to == std::string::npos)
            throw std::runtime_error(
                fmt::format("docs/manual.md: expected the table of {} between its two lines", name));
        page.replace(from + begin.size(), to - from - begin.size(), table + "\n");
    }
    return page;
}

}  // namespace photonlab
