// What the manual and --help state, compared with the code: names, defaults, limits and constants. A sentence that
// holds a number is written here with the constant in its place, so that neither can change alone.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "app/interruption.h"
#include "experiment/file/experiment_file.h"
#include "image/metrics.h"
#include "integrators/density_estimate.h"
#include "integrators/registry.h"
#include "integrators/settings/settings_table.h"
#include "record/images/ensemble.h"
#include "record/recorder.h"
#include "reference/reference_check.h"
#include "reference/reference_store.h"
#include "render/checkpoint.h"
#include "scene/narrow_gaps.h"
#include "tests/app/program.h"
#include "tests/support/manual_tables.h"

namespace photonlab {
namespace {

using NameSet = std::set<std::string>;
using Row = std::vector<std::string>;

const std::filesystem::path source = PHOTONLAB_SOURCE_DIR;

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

/// The cells of a line of a Markdown table, without the blanks around them.
Row cells_of(std::string line) {
    const std::string bar = "\x01";
    for (std::size_t at; (at = line.find("\\|")) != std::string::npos;) line.replace(at, 2, bar);
    Row cells;
    std::istringstream stream(line.substr(1));
    for (std::string cell; std::getline(stream, cell, '|');)
        cells.push_back(std::regex_replace(cell, std::regex("^ +| +$"), ""));
    return cells;
}

/// The rows of the table whose header begins with this cell.
std::vector<Row> table(const std::string& text, const std::string& header) {
    std::vector<Row> rows;
    bool is_in_it = false;
    for (const std::string& line : lines_of(text)) {
        is_in_it = line.rfind(is_in_it ? "|" : "| " + header + " |", 0) == 0;
        if (is_in_it) rows.push_back(cells_of(line));
    }
    if (rows.size() > 2) rows.erase(rows.begin(), rows.begin() + 2);
    return rows;
}

/// What stands in `back quotes`.
std::vector<std::string> quoted(const std::string& text) {
    std::vector<std::string> found;
    const std::regex pattern("`([^`]+)`");
    for (std::sregex_iterator at(text.begin(), text.end(), pattern), end; at != end; ++at) found.push_back((*at)[1]);
    return found;
}

std::vector<std::string> split(const std::string& text, const std::string& separator) {
    std::vector<std::string> parts;
    std::size_t begin = 0;
    for (std::size_t at; (at = text.find(separator, begin)) != std::string::npos; begin = at + separator.size())
        parts.push_back(text.substr(begin, at - begin));
    parts.push_back(text.substr(begin));
    return parts;
}

/// As texts write it: 2, 0.5, 1e-4.
std::string written(double number) {
    if (number >= 1e-3) return fmt::format("{:g}", number);
    const int exponent = static_cast<int>(std::floor(std::log10(number) + 1e-6));
    return fmt::format("{:g}e{}", number / std::pow(10.0, exponent), exponent);
}

NameSet folders_in(const std::filesystem::path& folder) {
    NameSet names;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.is_directory()) names.insert(entry.path().filename().string());
    return names;
}

class Stated : public ::testing::Test {
protected:
    std::string help_of(const std::vector<std::string>& command) const {
        std::vector<std::string> words = command;
        words.push_back("--help");
        Program program(words, folder_ / "messages");
        EXPECT_EQ(program.wait(), 0);
        return program.messages();
    }

    std::string refusal_of(const std::string& scene) const {
        Program program({"info", folder_.write("scene.xml", scene).string()}, folder_ / "messages");
        EXPECT_EQ(program.wait(), 2);
        return program.messages();
    }

    void expect_stated(const std::string& sentence) const {
        EXPECT_NE(manual_.find(sentence), std::string::npos) << "docs/manual.md does not say: " << sentence;
    }

    const TestFolder folder_;
    const std::string manual_ = read_text_file(source / "docs/manual.md");
};

TEST_F(Stated, CommandsAreThoseOfTheProgram) {
    NameSet in_manual;
    for (const Row& row : table(manual_, "command")) in_manual.insert(split(quoted(row.at(0)).at(0), " ").at(1));
    NameSet in_help;
    bool is_in_list = false;
    for (const std::string& line : lines_of(help_of({}))) {
        if (is_in_list && line.rfind("  ", 0) != 0) break;
        if (is_in_list) in_help.insert(split(line.substr(2), " ").at(0));
        if (line.rfind("Subcommands:", 0) == 0) is_in_list = true;
    }
    EXPECT_FALSE(in_help.empty());
    EXPECT_EQ(in_manual, in_help);
}

TEST_F(Stated, TablesOfTheManualAreThoseOfTheProgram) {
    EXPECT_EQ(with_tables(manual_), manual_) << "cmake --build --preset release --target manual";
}

TEST_F(Stated, NumbersInTheMeaningOfSettingsAndMetricsAreTheConstants) {
    const auto expect_in = [](std::string_view text, const std::string& part) {
        EXPECT_NE(text.find(part), std::string::npos) << text << "\nlacks: " << part;
    };
    const auto meaning = [](std::string_view name) { return find_setting_field(name)->meaning; };
    expect_in(meaning("max_radius"),
              fmt::format("{:g}% of the scene's bounding radius", 100.0 * default_max_radius_share));
    ASSERT_EQ(default_caustic_share, 0.25);
    expect_in(meaning("caustic_max_radius"), "a quarter of `max_radius`");
    for (const Metric& metric : metrics())
        if (metric.name == "smape") expect_in(metric.meaning, fmt::format("|r| + {})", written(smape_epsilon)));
    expect_stated(fmt::format("refused below {} |", fewest_nearest));
}

TEST_F(Stated, ConstantsInSentences) {
    expect_stated(fmt::format("every {:g} seconds", default_seconds_between_saves));
    expect_stated(fmt::format("end with exit code {}; a second one", interrupted_exit_code));
    expect_stated(fmt::format("in {} slots a method", ensemble_slots));
    expect_stated(fmt::format("or at {},{:03} edges", largest_path_edges / 1000, largest_path_edges % 1000));
    expect_stated(fmt::format("sides up to {}", largest_image_side));
    expect_stated(fmt::format("below {} refused", written(smallest_initial_radius)));
    expect_stated(fmt::format("`info` warns below {}", written(narrowest_gap)));
    expect_stated(fmt::format("a branch that carries less than {} (`branch_cutoff`)", written(default_branch_cutoff)));
    expect_stated(fmt::format("from a radius of {:g} footprints on", reference_footprints));
    ASSERT_EQ(largest_check_footprints, 0.5);
    ASSERT_EQ(fewest_standard_errors, 4.0);
    expect_stated("within a radius r of half a footprint or less");
    expect_stated("more than four standard errors");
}

TEST_F(Stated, HelpShowsTheDefaultsThatCommandsUse) {
    const auto option = [](const std::string& help, const std::string& name) {
        for (const std::string& line : lines_of(std::regex_replace(help, std::regex("\\n {20,}"), " ")))
            if (line.rfind("  " + name + " ", 0) == 0) return line;
        return std::string();
    };
    const auto ends = [](const std::string& line, const std::string& end) {
        EXPECT_TRUE(line.size() > end.size() && line.substr(line.size() - end.size()) == end)
            << line << "\ndoes not end in " << end;
    };
    const ReferenceSettings reference;
    const std::string reference_help = help_of({"reference"});
    ends(option(reference_help, "--samples"), fmt::format("[{}]", reference.samples));
    ends(option(reference_help, "--photons"), fmt::format("[{}]", reference.photons_per_pass));
    ends(option(reference_help, "--seed"), fmt::format("[{}]", reference.seed));
    ends(option(reference_help, "--integrator"), fmt::format("[{}]", reference.integrator));
    ASSERT_EQ(reference.alpha, 2.0 / 3.0);
    ends(option(reference_help, "--alpha"), "[2/3]");
    const std::string seconds = fmt::format("[{:g}]", default_seconds_between_saves);
    ends(option(help_of({"run"}), "--checkpoint-seconds"), seconds);
    ends(option(help_of({"render"}), "--checkpoint-seconds"), seconds);
    const SmokeLimits smoke;
    EXPECT_NE(option(help_of({"run"}), "--smoke")
                  .find(fmt::format("at most {} passes, {} photons a pass, {} seeds", smoke.passes,
                                    smoke.photons_per_pass, smoke.seeds)),
              std::string::npos);
    EXPECT_NE(help_of({}).find(fmt::format("{} ended by SIGINT", interrupted_exit_code)), std::string::npos);
}

/// Of "known here: a, b, c" in a message.
NameSet known_in(const std::string& message) {
    const std::string begin = "nown here: ";
    const std::size_t at = message.find(begin);
    if (at == std::string::npos) return {};
    const std::string list = message.substr(at + begin.size(), message.find_first_of(";\n", at) - at - begin.size());
    const std::vector<std::string> names = split(list, ", ");
    return {names.begin(), names.end()};
}

TEST_F(Stated, PluginsAreThoseThatScenesMayHave) {
    std::map<std::string, NameSet> stated;  // what is quoted before the first semicolon
    for (const Row& row : table(manual_, "kind")) {
        const std::string first = split(row.at(1), ";").at(0);
        const std::vector<std::string> names = quoted(first);
        stated[row.at(0)] = NameSet(names.begin(), names.end());
    }
    const auto known = [&](const std::string& element) {
        return known_in(refusal_of("<scene version=\"3.0.0\">" + element + "</scene>"));
    };
    EXPECT_EQ(stated["shapes"], known("<shape type=\"no\"/>"));
    EXPECT_EQ(stated["materials"], known("<bsdf type=\"no\" id=\"a\"/>"));
    EXPECT_EQ(stated["textures"],
              known("<bsdf type=\"diffuse\" id=\"a\"><texture name=\"reflectance\" type=\"no\"/></bsdf>"));
    NameSet emitters = known("<emitter type=\"no\"/>");
    const NameSet of_shapes = known("<shape type=\"sphere\"><emitter type=\"no\"/></shape>");
    emitters.insert(of_shapes.begin(), of_shapes.end());
    NameSet without_place;  // "area (in a shape)"
    for (const std::string& emitter : emitters) without_place.insert(split(emitter, " (").at(0));
    EXPECT_EQ(stated["emitters"], without_place);
    EXPECT_EQ(stated["sensor, film"], known("<sensor type=\"no\"/>"));
}

TEST_F(Stated, ScenesAndTheirReferencesAreThoseInTheRepository) {
    NameSet scenes;
    for (const Row& row : table(manual_, "scene")) {
        const std::string name = quoted(row.at(0)).at(0);
        scenes.insert(name);
        if (!std::filesystem::exists(source / "reference" / name)) {
            EXPECT_EQ(row.at(2), "known numbers") << name;
            continue;
        }
        const Json json = read_reference_json(source / "reference" / name);
        const std::string made = json.at("integrator") == "path" ? "path traced" : "by ppm";
        EXPECT_EQ(row.at(2), json.at("floor_mse").at("total") == 0.0 ? "exact" : made) << name;
    }
    EXPECT_EQ(scenes, folders_in(source / "scenes"));
}

TEST_F(Stated, ExperimentsAreThoseInTheRepository) {
    const std::string page = read_text_file(source / "docs/experiments.md");
    NameSet stated{"demo", "gallery"};  // without a question of their own
    for (const Row& row : table(page, "experiment"))
        for (const std::string& name : quoted(row.at(0))) stated.insert(name);
    NameSet files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(source / "experiments"))
        if (entry.path().extension() == ".toml")
            files.insert(entry.path().lexically_relative(source / "experiments").replace_extension().string());
    EXPECT_EQ(stated, files);
    EXPECT_NE(read_text_file(source / "demo").find("experiments/demo.toml"), std::string::npos);
}

TEST_F(Stated, RoomsAreThoseOfTheSources) {
    const std::size_t begin = manual_.find("`src/` has one folder a room");
    ASSERT_NE(begin, std::string::npos);
    std::vector<std::string> rooms = quoted(manual_.substr(begin, manual_.find(". `tests/`", begin) - begin));
    rooms.erase(rooms.begin());
    EXPECT_EQ(NameSet(rooms.begin(), rooms.end()), folders_in(source / "src"));
}

}  // namespace
}  // namespace photonlab
