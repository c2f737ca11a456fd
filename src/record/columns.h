// The one table of the columns of the records: one row per run, recorded pass and component, in CSV that pandas reads
// without being told anything. The header and the rows are made from it, and columns.json, which says beside the
// records what each column is, so that analysis/ needs no list of its own; the manual has the same texts.
//
//     {"schema": 1,
//      "columns": [{"name": "alpha", "kind": "setting", "type": "number", "unit": "", "label": "α", "default": "0.7",
//                   "used_by": ["ppm"], "follows": [], "values": [], "error": false, "meaning": "..."}, ...],
//      "checksum": "..."}                                                                                (kept_files.h)
//
// A setting of settings_table.h and a metric of image/metrics.h are columns by being there.
//
// Numbers have the fewest digits that read back the same; what does not apply is empty.

#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/files/json.h"
#include "image/metrics.h"
#include "record/images/estimated_error.h"
#include "render/pass_loop.h"

namespace photonlab {

/// What is the same in every row of a run.
struct RunIdentity {
    std::string experiment;
    std::string run;
    std::string scene;
    std::string method;  ///< as the experiment calls it: by its name, or by the integrator
    RunSettings settings;
    int width = 0;
    int height = 0;
    int samples_per_pixel = 1;
    std::uint64_t hit_points = 0;
};

/// One row.
struct Record {
    const RunIdentity& identity;
    const RunState& state;
    std::string_view component;
    std::optional<ErrorMetrics> errors;      ///< empty without a reference for this component
    std::optional<std::uint64_t> nonfinite;  ///< pixels of the component with a non-finite channel
    double peak_rss_mib = 0.0;
    std::optional<JudgedEstimate> estimate = std::nullopt;  ///< of component "gathered", where it is asked for
};

struct Column {
    enum class Kind {
        Identity,  ///< says which row it is
        Setting,   ///< makes a method, or follows from what does
        Measure,
        Time,
    };
    enum class Type { Text, Integer, Number };

    std::string name;
    Kind kind = Kind::Measure;
    Type type = Type::Number;
    std::string unit;
    std::string label;    ///< how figures name it; empty: its values say what it is
    std::string meaning;  ///< for the manual
    std::function<std::string(const Record&)> value;
    std::string default_text = {};               ///< what a table without this column means
    std::vector<std::string_view> used_by = {};  ///< integrators whose rows have it; empty: all
    std::vector<std::string_view> follows = {};  ///< settings it follows from: no choice of its own beside them
    std::vector<std::pair<std::string_view, std::string_view>> values = {};  ///< of a choice, and how each is shown
    bool is_error = false;                                                   ///< a metric
};

std::string_view name_of(Column::Kind kind);

/// In the order of the table.
const std::vector<Column>& columns();

/// The header line, without its end.
std::string csv_header();

/// A row, without its end.
std::string csv_row(const Record& record);

/// What columns.json says.
std::string columns_json();

/// Writes it, unless the file says so already.
void write_columns(const std::filesystem::path& file);

}  // namespace photonlab
