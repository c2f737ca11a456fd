#include "integrators/settings/settings_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/text/number_in.h"

namespace photonlab {

namespace {

using Type = SettingField::Type;

[[noreturn]] void refuse(std::string_view name, std::string_view expected, const SettingValue& value) {
    throw InputError(fmt::format("{}: expected {}, got {}", name, expected, describe(value)));
}

// Reading and writing a value, by the type of its field.

SettingValue write_value(const std::string& value) {
    return value;
}
SettingValue write_value(double value) {
    return value;
}
SettingValue write_value(int value) {
    return std::int64_t{value};
}
SettingValue write_value(std::uint64_t value) {
    return static_cast<std::int64_t>(value);
}
SettingValue write_value(const std::optional<double>& value) {
    return value ? SettingValue(*value) : SettingValue("auto");
}
template <typename Enumeration>
requires std::is_enum_v<Enumeration> SettingValue write_value(Enumeration value) {
    return name_of(value);
}

void read_value(std::string_view name, std::string& target, const SettingValue& value) {
    const auto* text = std::get_if<std::string>(&value);
    if (!text) refuse(name, "a name", value);
    target = *text;
}

void read_value(std::string_view name, double& target, const SettingValue& value) {
    if (const auto* number = std::get_if<double>(&value))
        target = *number;
    else if (const auto* integer = std::get_if<std::int64_t>(&value))
        target = static_cast<double>(*integer);
    else
        refuse(name, "a number", value);
}

void read_value(std::string_view name, std::optional<double>& target, const SettingValue& value) {
    const auto* text = std::get_if<std::string>(&value);
    if (text && *text == "auto") {
        target.reset();
        return;
    }
    if (text || std::holds_alternative<bool>(value)) refuse(name, "\"auto\" or a length in scene units", value);
    double length = 0.0;
    read_value(name, length, value);
    target = length;
}

/// Whole numbers may be written as 1e6.
std::int64_t whole_number(std::string_view name, const SettingValue& value) {
    if (const auto* integer = std::get_if<std::int64_t>(&value)) return *integer;
    const auto* number = std::get_if<double>(&value);
    if (!number || std::abs(*number) >= 0x1p53 || *number != std::trunc(*number)) refuse(name, "a whole number", value);
    return static_cast<std::int64_t>(*number);
}

void read_value(std::string_view name, int& target, const SettingValue& value) {
    const std::int64_t number = whole_number(name, value);
    if (number < std::numeric_limits<int>::min() || number > std::numeric_limits<int>::max())
        refuse(name, "a whole number of 32 bits", value);
    target = static_cast<int>(number);
}

void read_value(std::string_view name, std::uint64_t& target, const SettingValue& value) {
    const std::int64_t number = whole_number(name, value);
    if (number < 0) refuse(name, "a whole number of at least 0", value);
    target = static_cast<std::uint64_t>(number);
}

template <typename Enumeration>
requires std::is_enum_v<Enumeration>
void read_value(std::string_view name, Enumeration& target, const SettingValue& value) {
    const auto* text = std::get_if<std::string>(&value);
    if (!text) refuse(name, fmt::format("one of {}", fmt::join(all_names<Enumeration>(), ", ")), value);
    target = parse_choice<Enumeration>(name, *text);
}

template <typename Value>
constexpr Type type_of() {
    if constexpr (std::is_integral_v<Value>) return Type::Integer;
    if constexpr (std::is_same_v<Value, double>) return Type::Number;
    if constexpr (std::is_same_v<Value, std::optional<double>>) return Type::Length;
    return Type::Text;
}

/// A line of the table, with what follows from the type of the field.
template <auto Member>
SettingField line(SettingField field) {
    using Value = std::remove_cvref_t<decltype(std::declval<MethodSettings>().*Member)>;
    field.type = type_of<Value>();
    if constexpr (std::is_enum_v<Value>) field.choices = all_names<Value>();
    field.get = [](const MethodSettings& settings) { return write_value(settings.*Member); };
    field.set = [](const SettingField& self, MethodSettings& settings, const SettingValue& value) {
        read_value(self.name, settings.*Member, value);
    };
    return field;
}

bool in_mode_nearest(const MethodSettings& settings) {
    return settings.mode == GatherMode::Nearest;
}
bool in_mode_radius(const MethodSettings& settings) {
    return settings.mode == GatherMode::Radius;
}
bool has_radius(const MethodSettings& settings) {
    return in_mode_radius(settings) || is_relaxed(settings);
}

bool is_tested(const MethodSettings& settings) {
    return tests_its_disc(settings.schedule);
}
bool is_adaptive(const MethodSettings& settings) {
    return settings.schedule == ScheduleName::Adaptive;
}

constexpr Range at_least(double least) {
    return {.least = least};
}
constexpr Range above(double least) {
    return {.least = least, .has_least = false};
}

}  // namespace

const std::vector<SettingField>& setting_fields() {
    using Settings = MethodSettings;
    static const std::vector<SettingField> fields{
        line<&Settings::integrator>({.name = "integrator", .option = "--integrator", .meaning = "name of the method"}),
        line<&Settings::mode>({.name = "mode",
                               .option = "--mode",
                               .meaning =
                                   "which photons are gathered: all within a fixed radius, the nearest, or "
                                   "within a fixed radius those of the first pass, moved apart, to which later "
                                   "passes give their flux; in scenes that are diffuse but for mirrors and glass"}),
        line<&Settings::schedule>({.name = "schedule",
                                   .option = "--schedule",
                                   .meaning = "how radii shrink from pass to pass; the same alpha means something else "
                                              "in each"}),
        line<&Settings::photon_paths>(
            {.name = "photon_paths",
             .option = "--photon-paths",
             .label = "photon paths",
             .meaning =
                 "which light paths leave their photons: all, or those of which some hit point accepts a photon, "
                 "by Markov chains; not with schedule chi-square, which takes photons for independent",
             .applies = [](const Settings& settings) { return settings.schedule != ScheduleName::ChiSquare; }}),
        line<&Settings::step_rule>({.name = "step_rule",
                                    .option = "--step-rule",
                                    .label = "step rule",
                                    .meaning = "how the chains of `photon_paths` visible adapt the size of their "
                                               "mutations between passes, towards 23.4% accepted",
                                    .applies = traces_visible_paths}),
        line<&Settings::emission>(
            {.name = "emission",
             .option = "--emission",
             .label = "emission",
             .meaning = "where light paths begin: lights by their power, or half of them where paths were seen in "
                        "earlier passes; not with `photon_paths` visible",
             .applies = [](const Settings& settings) { return !traces_visible_paths(settings); }}),
        line<&Settings::learn_passes>({.name = "learn_passes",
                                       .option = "--learn-passes",
                                       .unit = "passes",
                                       .label = "passes learnt from",
                                       .meaning = "after which `emission` adaptive stays as it is",
                                       .range = at_least(1),
                                       .applies = emits_adaptively}),
        line<&Settings::light_sequence>(
            {.name = "light_sequence",
             .option = "--light-sequence",
             .label = "light sequence",
             .meaning = "the numbers by which light is emitted: independent ones, or the points of "
                        "a scrambled Sobol sequence over all passes, or, where radii or `emission` follow from earlier "
                        "passes, one of each pass; not with `photon_paths` visible",
             .applies = [](const Settings& settings) { return !traces_visible_paths(settings); }}),
        line<&Settings::alpha>(
            {.name = "alpha",
             .option = "--alpha",
             .label = "α",
             .meaning = "share of photons kept a pass, of schedules hachisuka and knaus-zwicker",
             .range = Range{.least = 0.0, .most = 1.0, .has_least = false},
             .applies = [](const Settings& settings) { return !is_adaptive(settings) && !is_tested(settings); }}),
        line<&Settings::kappa>({.name = "kappa",
                                .option = "--kappa",
                                .label = "κ",
                                .meaning =
                                    "of schedule adaptive: r^6 is V1 / (kappa c^2 Laplacian^2 passes); 6 is best "
                                    "for shrinking radii, 2 for the best fixed one",
                                .range = above(0.0),
                                .applies = is_adaptive}),
        line<&Settings::smallest_radius>({.name = "smallest_radius",
                                          .option = "--smallest-radius",
                                          .unit = "initial radii",
                                          .label = "smallest radius",
                                          .meaning = "of schedule adaptive, in the first pass; falls as passes^(-1/6)",
                                          .range = above(0.0),
                                          .applies = is_adaptive}),
        line<&Settings::largest_radius>({.name = "largest_radius",
                                         .option = "--largest-radius",
                                         .unit = "initial radii",
                                         .label = "largest radius",
                                         .meaning = "of schedule adaptive, in the first pass; falls as passes^(-1/6)",
                                         .range = above(0.0),
                                         .applies = is_adaptive}),
        line<&Settings::laplacian_radius>(
            {.name = "laplacian_radius",
             .option = "--laplacian-radius",
             .unit = "initial radii",
             .label = "Laplacian's radius",
             .meaning = "of the disc in which the Laplacian of the light is estimated, in the first pass; falls as "
                        "passes^(-1/10)",
             .range = above(0.0),
             .applies =
                 [](const Settings& settings) {
                     return is_adaptive(settings) || settings.estimate_error == ErrorEstimation::On;
                 }}),
        line<&Settings::test_variant>(
            {.name = "test_variant",
             .option = "--test-variant",
             .meaning =
                 "what schedule chi-square tests against: a uniform density, the linear one that fits best, or a "
                 "uniform one with opposite sectors pooled",
             .applies = [](const Settings& settings) { return settings.schedule == ScheduleName::ChiSquare; }}),
        line<&Settings::start>(
            {.name = "start",
             .option = "--start",
             .meaning = "initial radius of schedules chi-square and f-test: as of the others, or the "
                        "distance of photon number `test_photons` of the first pass; not with "
                        "`photon_paths` visible, which needs radii before photons",
             .applies =
                 [](const Settings& settings) { return is_tested(settings) && !traces_visible_paths(settings); }}),
        line<&Settings::test_photons>(
            {.name = "test_photons",
             .option = "--test-photons",
             .unit = "photons",
             .label = "photons before a test",
             .meaning = "that schedule chi-square waits for before its first test; and those of `start` knn",
             .range = at_least(fewest_nearest),
             .applies =
                 [](const Settings& settings) {
                     return settings.schedule == ScheduleName::ChiSquare || starts_at_nearest(settings);
                 }}),
        line<&Settings::test_shrink>(
            {.name = "test_shrink",
             .option = "--test-shrink",
             .label = "shrink of a test",
             .meaning = "factor on the squared radius of a disc that is even neither outside nor inside; where it is "
                        "even inside the factor is 1/2",
             .range = Range{.least = 0.0, .most = 1.0, .has_least = false},
             .applies = is_tested}),
        line<&Settings::test_growth>(
            {.name = "test_growth",
             .option = "--test-growth",
             .label = "growth of a test",
             .meaning = "factor on the photons that schedule chi-square waits for, whenever its radius shrinks",
             .range = at_least(1.0),
             .applies = [](const Settings& settings) { return settings.schedule == ScheduleName::ChiSquare; }}),
        line<&Settings::positions>({.name = "positions",
                                    .option = "--positions",
                                    .meaning =
                                        "where camera paths begin: at one of the pixel's sample positions in each "
                                        "pass, every one in turn; or anywhere in the pixel, and on the lens, by "
                                        "independent numbers or by the points of a scrambled Sobol sequence"}),
        line<&Settings::branches>(
            {.name = "branches",
             .option = "--branches",
             .meaning = "which ways camera paths go on from glass: all of them, or one by chance"}),
        line<&Settings::glossy>(
            {.name = "glossy",
             .option = "--glossy",
             .meaning = "what becomes of camera paths at rough conductors and rough glass: a hit point, or they go on "
                        "in a direction drawn from the BSDF"}),
        line<&Settings::gather_roughness>(
            {.name = "gather_roughness",
             .option = "--gather-roughness",
             .label = "roughness to gather at",
             .meaning = "alpha from which on it is gathered at glossy surfaces all the same",
             .range = above(0.0),
             .applies = [](const Settings& settings) { return settings.glossy == GlossyMode::Continue; }}),
        line<&Settings::estimate_error>(
            {.name = "estimate_error",
             .option = "--estimate-error",
             .meaning = "whether the error of the gathered light is estimated, without a reference; not with `glossy` "
                        "continue, which brings light that is no photon's",
             .applies = [](const Settings& settings) { return settings.glossy == GlossyMode::Gather; }}),
        line<&Settings::k>(
            {.name = "k",
             .option = "--k",
             .unit = "photons",
             .label = "k",
             .meaning = "photons searched, of mode nearest; the k-th sets the radius and carries no flux",
             .range = at_least(fewest_nearest),
             .applies = in_mode_nearest}),
        line<&Settings::radius>({.name = "radius",
                                 .option = "--radius",
                                 .unit = "scene units",
                                 .label = "radius",
                                 .meaning = "initial or fixed gather radius; auto is the pixel's footprint at each hit "
                                            "point times `footprints`",
                                 .applies = has_radius}),
        line<&Settings::footprints>(
            {.name = "footprints",
             .option = "--footprints",
             .unit = "pixel footprints",
             .label = "radius in footprints",
             .meaning = "the automatic radius",
             .range = above(0.0),
             .applies = [](const Settings& settings) { return has_radius(settings) && !settings.radius; }}),
        line<&Settings::max_radius>({.name = "max_radius",
                                     .option = "--max-radius",
                                     .unit = "scene units",
                                     .label = "maximum radius",
                                     .meaning = "largest radius of mode nearest; auto is 5% of the scene's bounding "
                                                "radius",
                                     .applies = in_mode_nearest}),
        line<&Settings::caustic_k>({.name = "caustic_k",
                                    .option = "--caustic-k",
                                    .unit = "photons",
                                    .label = "caustic k",
                                    .meaning = "`k` of the caustic map, which holds the photons that came from the "
                                               "light by mirrors and glass alone",
                                    .range = at_least(fewest_nearest),
                                    .applies = in_mode_nearest}),
        line<&Settings::caustic_radius>({.name = "caustic_radius",
                                         .option = "--caustic-radius",
                                         .unit = "scene units",
                                         .label = "caustic radius",
                                         .meaning = "radius in the caustic map; auto is `radius`",
                                         .applies = in_mode_radius}),
        line<&Settings::caustic_max_radius>({.name = "caustic_max_radius",
                                             .option = "--caustic-max-radius",
                                             .unit = "scene units",
                                             .label = "maximum caustic radius",
                                             .meaning = "largest radius in the caustic map; auto is a quarter of "
                                                        "`max_radius`",
                                             .applies = in_mode_nearest}),
        line<&Settings::relaxation_steps>({.name = "relaxation_steps",
                                           .option = "--relaxation-steps",
                                           .unit = "steps",
                                           .label = "relaxation steps",
                                           .meaning = "of mode relaxed: how often its photons move apart after each "
                                                      "epoch of passes",
                                           .range = Range{.least = 0, .most = 1e6},
                                           .applies = is_relaxed}),
        line<&Settings::features>({.name = "features",
                                   .option = "--features",
                                   .meaning =
                                       "of mode relaxed: whether photons move along the edges of features alone, "
                                       "or over them",
                                   .applies = is_relaxed}),
        line<&Settings::kernel>(
            {.name = "kernel", .option = "--kernel", .meaning = "weight of a photon by its distance"}),
        line<&Settings::area>({.name = "area",
                               .option = "--area",
                               .label = "area",
                               .meaning = "what photons are divided by: the disc's area, that of the surface on which "
                                          "they would be accepted (then none from beyond a wall is), or the same by "
                                          "weights of a local linear fit, which can be negative"}),
        line<&Settings::area_lines>(
            {.name = "area_lines",
             .option = "--area-lines",
             .unit = "lines",
             .label = "lines an area",
             .meaning = "lines, in each of five rings, by which the area around a hit point is measured; an eighth of "
                        "them where hit points are new in every pass",
             .range = Range{.least = 1, .most = 1e6},
             .applies = [](const Settings& settings) { return settings.area != AreaMode::Disc; }}),
        line<&Settings::eps>({.name = "eps",
                              .option = "--eps",
                              .label = "eps",
                              .meaning = "inexactness of the search for photons, as FLANN means it: a group of photons "
                                         "is looked at when its squared distance times 1 + eps is within the squared "
                                         "radius; 0 is exact",
                              .range = at_least(0.0)}),
        line<&Settings::direct>({.name = "direct",
                                 .option = "--direct",
                                 .label = "direct",
                                 .meaning = "direct light from shadow rays (sampled) or carried by photons"}),
        line<&Settings::direct_samples>(
            {.name = "direct_samples",
             .option = "--direct-samples",
             .unit = "rays",
             .label = "direct samples",
             .meaning = "shadow rays a hit point and pass",
             .range = at_least(1),
             .applies = [](const Settings& settings) { return settings.direct == DirectMode::Sampled; }}),
        line<&Settings::max_depth>(
            {.name = "max_depth",
             .option = "--max-depth",
             .unit = "edges",
             .label = "max depth",
             .meaning = "edges from camera to light, as in Mitsuba: 2 is direct light, -1 is unlimited",
             .range = Range{.least = 1, .also = "-1 (unlimited)", .other = -1},
             .default_words = "the scene file's"}),
        line<&Settings::branch_cutoff>(
            {.name = "branch_cutoff",
             .option = "--branch-cutoff",
             .label = "branch cut-off",
             .meaning = "throughput below which camera paths end at mirrors and glass; references are made with the "
                        "default",
             .range = Range{.least = smallest_branch_cutoff, .most = largest_branch_cutoff}}),
        line<&Settings::photons_per_pass>({.name = "photons_per_pass",
                                           .option = "--photons",
                                           .unit = "paths",
                                           .label = "photons a pass",
                                           .meaning = "light paths emitted a pass, whatever they store",
                                           .range = Range{.least = 1, .most = 0x1p32}}),
    };
    return fields;
}

const SettingField* find_setting_field(std::string_view name) {
    for (const SettingField& field : setting_fields())
        if (field.name == name) return &field;
    return nullptr;
}

SettingValue parse_setting_value(std::string_view text) {
    if (const auto integer = number_in<std::int64_t>(text)) return *integer;
    if (const auto number = number_in<double>(text)) return *number;
    return std::string(text);
}

std::string describe(const SettingValue& value) {
    const auto* text = std::get_if<std::string>(&value);
    return text ? '"' + *text + '"' : plain_text(value);
}

std::string plain_text(const SettingValue& value) {
    if (const auto* text = std::get_if<std::string>(&value)) return *text;
    if (const auto* integer = std::get_if<std::int64_t>(&value)) return fmt::format("{}", *integer);
    if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
    return std::get<bool>(value) ? "true" : "false";
}

bool Range::holds(double number) const {
    return number == other || (number <= most && (has_least ? number >= least : number > least));
}

std::string describe(const Range& range) {
    const std::string also = range.also.empty() ? "" : std::string(range.also) + " or ";
    const bool has_most = range.most < std::numeric_limits<double>::max();
    const auto number = [](double value) {
        return value == std::trunc(value) && std::abs(value) < 0x1p53 ? fmt::format("{:.0f}", value)
                                                                      : fmt::format("{:g}", value);
    };
    if (!has_most) return also + (range.has_least ? "at least " : "a number above ") + number(range.least);
    if (range.has_least) return fmt::format("{}from {} to {}", also, number(range.least), number(range.most));
    return fmt::format("{}a number in ({}, {}]", also, number(range.least), number(range.most));
}

std::string default_of(const SettingField& field) {
    return field.default_words.empty() ? plain_text(field.get(MethodSettings{})) : std::string(field.default_words);
}

std::string describe_values(const SettingField& field) {
    if (field.type == Type::Length) return "\"auto\" or a length above 0 in scene units";
    if (field.range) return describe(*field.range);
    return fmt::format("{}", fmt::join(field.choices, ", "));
}

void require_in_range(const SettingField& field, const MethodSettings& settings) {
    const SettingValue value = field.get(settings);
    const auto* integer = std::get_if<std::int64_t>(&value);
    const auto* number = std::get_if<double>(&value);
    if (!integer && !number) return;
    const Range range = field.type == Type::Length ? above(0.0) : field.range.value_or(Range{});
    if (!range.holds(integer ? static_cast<double>(*integer) : *number))
        throw InputError(fmt::format("{}: expected {}, got {}", field.name, describe_values(field), describe(value)));
}

}  // namespace photonlab
