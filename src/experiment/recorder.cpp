#include "experiment/recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "core/number_in.h"
#include "core/text.h"
#include "integrators/registry.h"

namespace photonlab {

namespace {

constexpr int schema = 1;
constexpr std::size_t most_listed_pixels = 16;

struct Column {
    std::string_view name;
    std::string (*value)(const Record&);  ///< nullptr: the setting of this name
};

template <typename Number>
std::string number(Number value) {
    return fmt::format("{}", value);
}

template <typename Number>
std::string number(const std::optional<Number>& value) {
    return value ? fmt::format("{}", *value) : "";
}

bool uses(const Record& record, std::string_view field) {
    return uses_setting(record.identity.settings.method, field);
}

bool has_photons(const Record& record) {
    return uses(record, "photons_per_pass");
}

std::string radius_rule(const Record& record) {
    if (!uses(record, "radius")) return "";
    return record.identity.settings.method.radius ? "given" : "auto";
}

std::string max_radius(const Record& record) {
    if (!uses(record, "max_radius")) return "";
    return number(record.identity.settings.method.max_radius ? record.identity.settings.method.max_radius
                                                             : record.state.initial_radius);
}

std::string caustic_radius(const Record& record) {
    if (!uses(record, "caustic_radius")) return "";
    const std::optional<double>& given = record.identity.settings.method.caustic_radius;
    return number(given ? given : record.state.initial_radius);
}

std::string caustic_max_radius(const Record& record) {
    if (!uses(record, "caustic_max_radius")) return "";
    const MethodSettings& method = record.identity.settings.method;
    if (method.caustic_max_radius) return number(method.caustic_max_radius);
    const std::optional<double>& largest = method.max_radius ? method.max_radius : record.state.initial_radius;
    return largest ? number(*largest * default_caustic_share) : "";
}

template <auto Member>
std::string error_text(const Record& record) {
    return record.errors ? number((*record.errors).*Member) : "";
}

template <Stage stage>
std::string stage_seconds(const Record& record) {
    return number(record.state.times.of(stage));
}

const std::vector<Column>& columns() {
    static const std::vector<Column> table{
        {"schema", [](const Record&) { return number(schema); }},
        {"experiment", [](const Record& r) { return r.identity.experiment; }},
        {"run", [](const Record& r) { return r.identity.run; }},
        {"scene", [](const Record& r) { return r.identity.scene; }},
        {"integrator", nullptr},
        {"mode", nullptr},
        {"schedule", nullptr},
        {"alpha", nullptr},
        {"k", nullptr},
        {"radius_rule", radius_rule},
        {"footprints", nullptr},
        {"radius_initial", [](const Record& r) { return uses(r, "radius") ? number(r.state.initial_radius) : ""; }},
        {"max_radius", max_radius},
        {"caustic_k", nullptr},
        {"caustic_radius", caustic_radius},
        {"caustic_max_radius", caustic_max_radius},
        {"kernel", nullptr},
        {"eps", nullptr},
        {"direct", nullptr},
        {"direct_samples", nullptr},
        {"max_depth", nullptr},
        {"branch_cutoff", nullptr},
        {"photons_per_pass", nullptr},
        {"width", [](const Record& r) { return number(r.identity.width); }},
        {"height", [](const Record& r) { return number(r.identity.height); }},
        {"samples_per_pixel", [](const Record& r) { return number(r.identity.samples_per_pixel); }},
        {"hit_points", [](const Record& r) { return number(r.identity.hit_points); }},
        {"seed", [](const Record& r) { return number(r.identity.settings.seed); }},
        {"threads", [](const Record& r) { return number(r.identity.settings.threads); }},
        {"pass", [](const Record& r) { return number(r.state.pass); }},
        {"component", [](const Record& r) { return std::string(r.component); }},
        {"paths_emitted", [](const Record& r) { return has_photons(r) ? number(r.state.paths_emitted) : ""; }},
        {"photons_stored", [](const Record& r) { return has_photons(r) ? number(r.state.photons_stored) : ""; }},
        {"photons_gathered",
         [](const Record& r) { return has_photons(r) ? number(r.state.report.photons_gathered) : ""; }},
        {"seconds", [](const Record& r) { return number(r.state.times.total()); }},
        {"cpu_seconds", [](const Record& r) { return number(r.state.times.cpu_total()); }},
        {"seconds_trace", stage_seconds<Stage::Trace>},
        {"seconds_build", stage_seconds<Stage::Build>},
        {"seconds_gather", stage_seconds<Stage::Gather>},
        {"seconds_direct", stage_seconds<Stage::Direct>},
        {"map_bytes", [](const Record& r) { return has_photons(r) ? number(r.state.map_bytes) : ""; }},
        {"hit_point_bytes", [](const Record& r) { return number(r.state.hit_point_bytes); }},
        {"peak_rss_mib", [](const Record& r) { return number(r.peak_rss_mib); }},
        {"radius_min", [](const Record& r) { return number(r.state.report.radius_min); }},
        {"radius_mean", [](const Record& r) { return number(r.state.report.radius_mean); }},
        {"radius_max", [](const Record& r) { return number(r.state.report.radius_max); }},
        {"mse", error_text<&ErrorMetrics::mse>},
        {"mse_unbiased", error_text<&ErrorMetrics::mse_unbiased>},
        {"rmse", error_text<&ErrorMetrics::rmse>},
        {"relmse", error_text<&ErrorMetrics::relmse>},
        {"smape", error_text<&ErrorMetrics::smape>},
        {"bias", error_text<&ErrorMetrics::bias>},
        {"max_error", error_text<&ErrorMetrics::max_error>},
        {"reference_floor", error_text<&ErrorMetrics::reference_floor>},
        {"nonfinite", [](const Record& r) { return number(r.nonfinite); }},
    };
    return table;
}

}  // namespace

std::string csv_header() {
    std::string line;
    for (const Column& column : columns()) {
        if (!line.empty()) line += ',';
        line += column.name;
    }
    return line;
}

std::string csv_row(const Record& record) {
    std::string line;
    for (const Column& column : columns()) {
        if (&column != &columns().front()) line += ',';
        line +=
            csv_cell(column.value ? column.value(record)
                                  : setting_text(record.identity.settings.method, *find_setting_field(column.name)));
    }
    return line;
}

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

bool photons_carry_direct(const MethodSettings& settings) {
    return uses_setting(settings, "direct") && settings.direct == DirectMode::Photons;
}

double peak_resident_mib() {
    // Not getrusage(): after exec() that still knows the size of what the process was before, Python for instance.
    std::ifstream stream("/proc/self/status");
    double kibibytes = std::numeric_limits<double>::quiet_NaN();
    for (std::string word; stream >> word;)
        if (word == "VmHWM:") stream >> kibibytes;
    return kibibytes / 1024.0;
}

void reset_peak_resident() {
    std::ofstream("/proc/self/clear_refs") << "5";
}

Recorder::Recorder(RunIdentity identity, const Reference* reference, const std::filesystem::path& file)
    : identity_(std::move(identity)), reference_(reference), file_(file) {}

void Recorder::record(const RunState& state, const Image& image) {
    peak_ = std::max(peak_, peak_resident_mib());
    const bool carried = photons_carry_direct(identity_.settings.method);
    std::string rows = file_.is_empty() ? csv_header() + "\n" : "";
    for (const std::string& component : components) {
        std::optional<ErrorMetrics> errors;
        if (reference_) errors = judge(image, *reference_, component, carried);
        const std::uint64_t nonfinite = count_nonfinite(state, image, component);
        if (component == total_component) {
            last_total_ = errors;
            nonfinite_count_ += nonfinite;
        }
        rows += csv_row({identity_, state, component, errors, nonfinite, peak_}) + "\n";
    }
    file_.append(rows);
}

void Recorder::exchange(StateArchive& archive) {
    file_.exchange(archive);
    archive.exchange(peak_);
    archive.exchange(nonfinite_count_);
    archive.exchange_each(first_nonfinite_, [](StateArchive& each, NonfinitePixel& pixel) {
        each.exchange(pixel.pass);
        each.exchange(pixel.component);
        each.exchange(pixel.x);
        each.exchange(pixel.y);
    });
}

std::uint64_t Recorder::count_nonfinite(const RunState& state, const Image& image, const std::string& component) {
    std::uint64_t count = 0;
    const std::vector<ColorD> pixels = component_pixels(image, component);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (is_finite(pixels[i])) continue;
        ++count;
        const auto width = static_cast<std::size_t>(image.width);
        if (first_nonfinite_.size() < most_listed_pixels)
            first_nonfinite_.push_back(
                {state.pass, component, static_cast<int>(i % width), static_cast<int>(i / width)});
    }
    return count;
}

}  // namespace photonlab
