#include "record/columns.h"

#include <fmt/format.h>

#include "core/files/files.h"
#include "core/files/kept_files.h"
#include "core/text/csv.h"
#include "integrators/registry.h"
#include "integrators/settings/chosen_settings.h"

namespace photonlab {

namespace {

constexpr int columns_schema = 1;

using Kind = Column::Kind;
using Type = Column::Type;

template <typename Number>
std::string number(Number value) {
    return fmt::format("{}", value);
}

template <typename Number>
std::string number(const std::optional<Number>& value) {
    return value ? fmt::format("{}", *value) : "";
}

const MethodSettings& method_of(const Record& record) {
    return record.identity.settings.method;
}

bool uses(const Record& record, std::string_view setting) {
    return uses_setting(method_of(record), setting);
}

std::string max_radius(const Record& record) {
    if (!uses(record, "max_radius")) return "";
    return number(method_of(record).max_radius ? method_of(record).max_radius : record.state.initial_radius);
}

std::string caustic_radius(const Record& record) {
    if (!uses(record, "caustic_radius")) return "";
    return number(method_of(record).caustic_radius ? method_of(record).caustic_radius : record.state.initial_radius);
}

std::string caustic_max_radius(const Record& record) {
    if (!uses(record, "caustic_max_radius")) return "";
    const MethodSettings& method = method_of(record);
    if (method.caustic_max_radius) return number(method.caustic_max_radius);
    const std::optional<double>& largest = method.max_radius ? method.max_radius : record.state.initial_radius;
    return largest ? number(*largest * default_caustic_share) : "";
}

/// A column of the photons that a method has: empty for the others.
template <typename Value>
auto of_photons(const Value& value) {
    return [value](const Record& record) { return uses(record, "photons_per_pass") ? number(value(record)) : ""; };
}

// ---------------------------------------------------------------------------------------------------------------------
// Settings. A length that can be automatic is recorded as what it came to in the scene.

const std::vector<std::string_view> settings_of_hit_points{"samples_per_pixel", "width", "height", "branch_cutoff"};

Column column_of(const SettingField& field) {
    Column column{.name = std::string(field.name),
                  .kind = Kind::Setting,
                  .type = field.type == SettingField::Type::Text      ? Type::Text
                          : field.type == SettingField::Type::Integer ? Type::Integer
                                                                      : Type::Number,
                  .unit = std::string(field.unit),
                  .label = std::string(field.label),
                  .meaning = std::string(field.meaning),
                  .value = [&field](const Record& record) { return setting_text(method_of(record), field); },
                  .default_text = plain_text(field.get(MethodSettings{}))};
    for (const std::string_view choice : field.choices) column.values.emplace_back(choice, choice);
    if (field.name == "integrator")
        for (const IntegratorKind& kind : integrator_kinds()) column.values.emplace_back(kind.name, kind.label);
    column.used_by = users_of(field.name);
    return column;
}

/// The columns of the settings that are recorded as what they came to; of the others their own column.
std::vector<Column> columns_of(const SettingField& field) {
    Column column = column_of(field);
    if (field.type == SettingField::Type::Length) column.default_text.clear();
    if (field.name == "radius") {
        Column rule = column;
        rule.name = "radius_rule";
        rule.type = Type::Text;
        rule.unit = rule.label = "";
        rule.meaning = "whether the initial radius is automatic or given";
        rule.value = [](const Record& record) {
            return uses(record, "radius") ? (method_of(record).radius ? "given" : "auto") : "";
        };
        rule.follows = {"radius_initial"};
        column.name = "radius_initial";
        column.label = "initial radius";
        column.meaning = "mean initial radius over hit points";
        column.value = [](const Record& record) {
            return uses(record, "radius") ? number(record.state.initial_radius) : "";
        };
        column.follows = {"footprints"};
        column.follows.insert(column.follows.end(), settings_of_hit_points.begin(), settings_of_hit_points.end());
        return {rule, column};
    }
    if (field.name == "max_radius") column.value = max_radius;
    if (field.name == "caustic_radius") {
        column.value = caustic_radius;
        column.follows = {"radius_initial", "footprints"};
    }
    if (field.name == "caustic_max_radius") {
        column.value = caustic_max_radius;
        column.follows = {"max_radius"};
    }
    return {column};
}

// ---------------------------------------------------------------------------------------------------------------------
// The rest, in the order of the table.

std::vector<Column> columns_before_settings() {
    return {
        {"schema", Kind::Identity, Type::Integer, "", "schema", "version of this table",
         [](const Record&) { return number(columns_schema); }},
        {"experiment", Kind::Identity, Type::Text, "", "experiment", "name of the experiment",
         [](const Record& r) { return r.identity.experiment; }},
        {"run", Kind::Identity, Type::Text, "", "run", "name of the run: scene, method, what is swept, seed",
         [](const Record& r) { return r.identity.run; }},
        {"scene", Kind::Identity, Type::Text, "", "scene", "name of the scene",
         [](const Record& r) { return r.identity.scene; }},
        {"method", Kind::Identity, Type::Text, "", "method",
         "what the experiment calls it: its `name`, or the integrator",
         [](const Record& r) { return r.identity.method; }},
    };
}

std::vector<Column> columns_of_image() {
    return {
        {"width", Kind::Setting, Type::Integer, "pixels", "width", "of the image",
         [](const Record& r) { return number(r.identity.width); }},
        {"height", Kind::Setting, Type::Integer, "pixels", "height", "of the image",
         [](const Record& r) { return number(r.identity.height); }},
        {"samples_per_pixel", Kind::Setting, Type::Integer, "", "samples a pixel", "sample positions a pixel",
         [](const Record& r) { return number(r.identity.samples_per_pixel); }},
        {.name = "hit_points",
         .kind = Kind::Setting,
         .type = Type::Integer,
         .unit = "",
         .label = "hit points",
         .meaning = "hit points in all",
         .value = [](const Record& r) { return number(r.identity.hit_points); },
         .follows = settings_of_hit_points},
        {"seed", Kind::Identity, Type::Integer, "", "seed", "of all random numbers",
         [](const Record& r) { return number(r.identity.settings.seed); }},
        {"threads", Kind::Identity, Type::Integer, "", "threads", "results do not depend on it, to the bit",
         [](const Record& r) { return number(r.identity.settings.threads); }},
        {"pass", Kind::Identity, Type::Integer, "", "pass", "passes done",
         [](const Record& r) { return number(count_passes(r.state.ranges)); }},
        {"ranges", Kind::Identity, Type::Text, "", "ranges of passes",
         "of a run whose passes were taken in parts: which they are, a range a part; empty for passes from the first "
         "on",
         [](const Record& r) { return describe(r.state.ranges); }},
        {"component", Kind::Identity, Type::Text, "", "component", "`total`, `emission`, `direct` or `gathered`",
         [](const Record& r) { return std::string(r.component); }},
    };
}

std::vector<Column> columns_of_photons() {
    return {
        {"paths_emitted", Kind::Measure, Type::Integer, "", "light paths", "light paths so far",
         of_photons([](const Record& r) { return r.state.paths_emitted; })},
        {"paths_traced", Kind::Measure, Type::Integer, "", "light paths traced",
         "light paths traced so far: those emitted, and with `photon_paths` visible those that were tried beside them",
         of_photons([](const Record& r) { return r.state.paths_traced; })},
        {.name = "paths_seen",
         .kind = Kind::Measure,
         .type = Type::Number,
         .unit = "",
         .label = "paths seen",
         .meaning =
             "share of the last pass's light paths of which some hit point accepted a photon: with `emission` "
             "adaptive of those emitted, which learning raises; with `photon_paths` visible of the uniform ones, by "
             "which their light is multiplied",
         .value = [](const Record& r) { return number(r.state.paths_seen); },
         .used_by = users_of("emission")},
        {.name = "mutations_accepted",
         .kind = Kind::Measure,
         .type = Type::Number,
         .unit = "",
         .label = "mutations accepted",
         .meaning = "share of the last pass's mutations that were seen, of `photon_paths` visible",
         .value = [](const Record& r) { return number(r.state.mutations_accepted); },
         .used_by = users_of("photon_paths")},
        {.name = "step_size",
         .kind = Kind::Measure,
         .type = Type::Number,
         .unit = "",
         .label = "step size",
         .meaning = "d of these mutations, whose mean step is d / (1 + 2 d)",
         .value = [](const Record& r) { return number(r.state.step_size); },
         .used_by = users_of("photon_paths")},
        {"photons_stored", Kind::Measure, Type::Integer, "", "photons stored", "photons stored in maps so far",
         of_photons([](const Record& r) { return r.state.photons_stored; })},
        {"photons_gathered", Kind::Measure, Type::Integer, "", "photons gathered", "photons found at hit points so far",
         of_photons([](const Record& r) { return r.state.report.photons_gathered; })},
    };
}

template <Stage stage>
Column column_of_stage(const std::string& name, const std::string& meaning) {
    return {"seconds_" + name, Kind::Time, Type::Number, "s", name + " time", meaning, [](const Record& r) {
                return number(r.state.times.of(stage));
            }};
}

std::vector<Column> columns_of_times() {
    return {
        {"seconds", Kind::Time, Type::Number, "s", "time", "wall clock of the passes so far",
         [](const Record& r) { return number(r.state.times.total()); }},
        {"cpu_seconds", Kind::Time, Type::Number, "CPU s", "processor time", "processor time of the passes so far",
         [](const Record& r) { return number(r.state.times.cpu_total()); }},
        column_of_stage<Stage::Trace>("trace", "of `seconds`: tracing photons"),
        column_of_stage<Stage::Build>("build", "of `seconds`: indexing photons"),
        column_of_stage<Stage::Gather>("gather", "of `seconds`: gathering"),
        column_of_stage<Stage::Direct>(
            "direct",
            "of `seconds`: direct light. While one thread indexes photons, the others sample it; what passes meanwhile "
            "is divided between build and direct in proportion to the CPU time of each"),
        column_of_stage<Stage::Points>("points",
                                       "of `seconds`: new hit points, where a method makes them in every pass"),
        column_of_stage<Stage::Relax>("relax", "of `seconds`: photons of mode relaxed, moved and given their flux"),
    };
}

std::vector<Column> columns_of_memory() {
    return {
        {"map_bytes", Kind::Measure, Type::Integer, "bytes", "photon map", "photons with their index, at their largest",
         of_photons([](const Record& r) { return r.state.map_bytes; })},
        {"hit_point_bytes", Kind::Measure, Type::Integer, "bytes", "hit points", "hit points with their statistics",
         [](const Record& r) { return number(r.state.hit_point_bytes); }},
        {"peak_rss_mib", Kind::Measure, Type::Number, "MiB", "peak memory",
         "the largest memory that the process held while this run, and those that shared its photons, ran",
         [](const Record& r) { return number(r.peak_rss_mib); }},
    };
}

std::vector<Column> columns_of_radii() {
    return {
        {"radius_min", Kind::Measure, Type::Number, "scene units", "smallest radius", "over hit points",
         [](const Record& r) { return number(r.state.report.radius_min); }},
        {"radius_mean", Kind::Measure, Type::Number, "scene units", "mean radius", "over hit points",
         [](const Record& r) { return number(r.state.report.radius_mean); }},
        {"radius_max", Kind::Measure, Type::Number, "scene units", "largest radius", "over hit points",
         [](const Record& r) { return number(r.state.report.radius_max); }},
    };
}

/// A column of what a method says of its own error.
template <typename Value>
Column column_of_estimate(const std::string& name, const std::string& unit, const std::string& label,
                          const std::string& meaning, const Value& value) {
    return {.name = name,
            .kind = Kind::Measure,
            .type = Type::Number,
            .unit = unit,
            .label = label,
            .meaning = meaning,
            .value = [value](const Record& r) { return r.estimate ? number(value(*r.estimate)) : ""; },
            .used_by = users_of("estimate_error")};
}

std::vector<Column> columns_of_estimates() {
    return {
        column_of_estimate("estimated_bias", "radiance", "estimated bias",
                           "of component `gathered`: root mean square of what the method says of its bias",
                           [](const JudgedEstimate& e) { return e.bias; }),
        column_of_estimate("estimated_deviation", "radiance", "estimated noise", "likewise of its standard deviation",
                           [](const JudgedEstimate& e) { return e.deviation; }),
        column_of_estimate("within_50", "", "pixels within the bound of 50%",
                           "share of pixels whose true error lies within the bound that half of them should",
                           [](const JudgedEstimate& e) { return e.within_50; }),
        column_of_estimate("within_90", "", "pixels within the bound of 90%", "likewise nine tenths",
                           [](const JudgedEstimate& e) { return e.within_90; })};
}

std::vector<Column> columns_of_errors() {
    std::vector<Column> all;
    for (const Metric& metric : metrics())
        all.push_back(
            {.name = std::string(metric.name),
             .kind = Kind::Measure,
             .type = Type::Number,
             .unit = std::string(metric.unit),
             .label = std::string(metric.label),
             .meaning = std::string(metric.meaning),
             .value = [&metric](const Record& r) { return r.errors ? number(r.errors->of(metric.name)) : ""; },
             .is_error = true});
    all.push_back({"nonfinite", Kind::Measure, Type::Integer, "pixels", "pixels that are not finite",
                   "pixels with a value that is not finite; they are left out of the errors and listed in run.json",
                   [](const Record& r) { return number(r.nonfinite); }});
    return all;
}

std::string_view name_of_type(Type type) {
    return type == Type::Text ? "text" : type == Type::Integer ? "integer" : "number";
}

}  // namespace

std::string_view name_of(Column::Kind kind) {
    switch (kind) {
        case Kind::Identity:
            return "identity";
        case Kind::Setting:
            return "setting";
        case Kind::Measure:
            return "measure";
        case Kind::Time:
            return "time";
    }
    return "?";
}

const std::vector<Column>& columns() {
    static const std::vector<Column> table = [] {
        std::vector<Column> all;
        const auto append = [&](std::vector<Column> more) {
            all.insert(all.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
        };
        append(columns_before_settings());
        for (const SettingField& field : setting_fields()) append(columns_of(field));
        append(columns_of_image());
        append(columns_of_photons());
        append(columns_of_times());
        append(columns_of_memory());
        append(columns_of_radii());
        append(columns_of_estimates());
        append(columns_of_errors());
        return all;
    }();
    return table;
}

std::string csv_header() {
    std::string line;
    for (const Column& column : columns()) line += (line.empty() ? "" : ",") + column.name;
    return line;
}

std::string csv_row(const Record& record) {
    std::string line;
    for (const Column& column : columns()) {
        if (&column != &columns().front()) line += ',';
        line += csv_cell(column.value(record));
    }
    return line;
}

std::string columns_json() {
    Json all = Json::array();
    for (const Column& column : columns()) {
        Json values = Json::array();
        for (const auto& [value, shown] : column.values) values.push_back({value, shown});
        all.push_back({{"name", column.name},
                       {"kind", name_of(column.kind)},
                       {"type", name_of_type(column.type)},
                       {"unit", column.unit},
                       {"label", column.label},
                       {"default", column.default_text},
                       {"used_by", column.used_by},
                       {"follows", column.follows},
                       {"values", values},
                       {"error", column.is_error},
                       {"meaning", column.meaning}});
    }
    return with_checksum({{"schema", columns_schema}, {"columns", all}});
}

void write_columns(const std::filesystem::path& file) {
    const std::string text = columns_json();
    if (fault_of(file, stamp_of_text(text), Check::Everything)) write_text_file(file, text);
}

}  // namespace photonlab
