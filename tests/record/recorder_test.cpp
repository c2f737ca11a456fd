#include "record/recorder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/files/kept_files.h"
#include "core/text/csv.h"
#include "integrators/settings/settings_table.h"
#include "tests/support/test_folder.h"

namespace photonlab {
namespace {

std::vector<std::string> cells(const std::string& line) {
    std::vector<std::string> result{""};
    for (const char c : line) {
        if (c == ',')
            result.emplace_back();
        else
            result.back() += c;
    }
    return result;
}

std::string cell(const Record& record, const std::string& column) {
    const std::vector<std::string> names = cells(csv_header());
    const auto found = std::find(names.begin(), names.end(), column);
    return found == names.end() ? "no such column"
                                : cells(csv_row(record))[static_cast<std::size_t>(found - names.begin())];
}

TEST(Records, ColumnsAreThoseOfTheContract) {
    EXPECT_EQ(
        csv_header(),
        "schema,experiment,run,scene,method,integrator,mode,schedule,photon_paths,step_rule,emission,learn_passes,"
        "light_sequence,"
        "alpha,kappa,"
        "smallest_radius,largest_radius,"
        "laplacian_radius,test_variant,start,test_photons,test_shrink,test_growth,positions,branches,"
        "glossy,gather_roughness,estimate_error,"
        "k,radius_rule,radius_initial,footprints,max_radius,"
        "caustic_k,"
        "caustic_radius,caustic_max_radius,relaxation_steps,features,kernel,area,area_lines,eps,"
        "direct,direct_samples,max_depth,branch_cutoff,photons_per_pass,width,height,samples_per_pixel,hit_points,seed,"
        "threads,"
        "pass,ranges,component,"
        "paths_emitted,paths_traced,paths_seen,mutations_accepted,step_size,photons_stored,photons_gathered,seconds,"
        "cpu_seconds,seconds_trace,seconds_build,seconds_gather,"
        "seconds_direct,seconds_points,seconds_relax,map_bytes,hit_point_bytes,peak_rss_mib,radius_min,radius_mean,"
        "radius_max,"
        "estimated_bias,estimated_deviation,within_50,within_90,"
        "mse,mse_unbiased,rmse,relmse,relmse_unbiased,smape,bias,max_error,reference_floor,nonfinite");
}

TEST(Records, SayOfWhichPassesTheyAre) {
    RunIdentity identity;
    RunState state;
    state.ranges = {{1, 12}};
    EXPECT_EQ(cell({identity, state, "total", std::nullopt, 0, 1.0}, "pass"), "12");
    EXPECT_EQ(cell({identity, state, "total", std::nullopt, 0, 1.0}, "ranges"), "");
    state.ranges = {{1, 3}, {4, 4}, {9, 12}};
    EXPECT_EQ(cell({identity, state, "total", std::nullopt, 0, 1.0}, "pass"), "8");
    EXPECT_EQ(cell({identity, state, "total", std::nullopt, 0, 1.0}, "ranges"), "1..3 4..4 9..12");
}

TEST(Records, WhatDoesNotApplyIsEmpty) {
    RunIdentity identity;
    identity.settings.method.integrator = "path";
    RunState state;
    const Record path{identity, state, "total", std::nullopt, 0, 1.0};
    for (const char* column : {"mode",
                               "schedule",
                               "photon_paths",
                               "step_rule",
                               "emission",
                               "learn_passes",
                               "light_sequence",
                               "alpha",
                               "k",
                               "radius_rule",
                               "footprints",
                               "radius_initial",
                               "max_radius",
                               "caustic_k",
                               "caustic_radius",
                               "caustic_max_radius",
                               "relaxation_steps",
                               "features",
                               "kernel",
                               "area",
                               "area_lines",
                               "eps",
                               "direct",
                               "direct_samples",
                               "photons_per_pass",
                               "paths_emitted",
                               "paths_traced",
                               "paths_seen",
                               "mutations_accepted",
                               "step_size",
                               "photons_stored",
                               "photons_gathered",
                               "map_bytes",
                               "radius_mean",
                               "mse",
                               "mse_unbiased",
                               "reference_floor"})
        EXPECT_EQ(cell(path, column), "") << column;
    EXPECT_EQ(cell(path, "max_depth"), "-1");
    EXPECT_EQ(cell(path, "branch_cutoff"), "0.0001");
    EXPECT_EQ(cell(path, "nonfinite"), "0");

    identity.settings.method.integrator = "photonmapper";
    identity.settings.method.mode = GatherMode::Nearest;
    state.initial_radius = 0.25;
    const Record nearest{identity, state, "total", std::nullopt, 0, 1.0};
    for (const char* column : {"schedule", "alpha", "radius_rule", "radius_initial"})
        EXPECT_EQ(cell(nearest, column), "") << column;
    EXPECT_EQ(cell(nearest, "k"), "120");
    EXPECT_EQ(cell(nearest, "max_radius"), "0.25");
    EXPECT_EQ(cell(nearest, "caustic_k"), "120");
    EXPECT_EQ(cell(nearest, "caustic_radius"), "");
    EXPECT_EQ(cell(nearest, "caustic_max_radius"), "0.0625");
    EXPECT_EQ(cell(nearest, "paths_emitted"), "0");
}

TEST(Records, NumbersReadBackTheSame) {
    RunIdentity identity;
    RunState state;
    const ErrorMetrics errors =
        compare({ColorD(1.0), ColorD(0.1)},
                {{ColorD(0.7), ColorD(0.2)}, {ColorD(0.6), ColorD(0.1)}, {ColorD(0.8), ColorD(0.3)}});
    const Record record{identity, state, "total", errors, 0, 1.0};
    for (const Metric& metric : metrics())
        EXPECT_EQ(std::stod(cell(record, std::string(metric.name))), errors.of(metric.name)) << metric.name;
}

TEST(Columns, AreDescribedBesideTheRecords) {
    const std::optional<Json> described = checked_json(columns_json());
    ASSERT_TRUE(described);
    std::string names;
    std::map<std::string, Json> by_name;
    for (const Json& column : described->at("columns")) {
        const std::string name = column.at("name");
        names += (names.empty() ? "" : ",") + name;
        by_name[name] = column;
        EXPECT_FALSE(column.at("meaning").get<std::string>().empty()) << name;
    }
    EXPECT_EQ(names, csv_header());
    EXPECT_EQ(by_name["alpha"]["kind"], "setting");
    EXPECT_EQ(by_name["alpha"]["label"], "α");
    EXPECT_EQ(by_name["alpha"]["used_by"], Json::array({"ppm", "sppm"}));
    EXPECT_EQ(by_name["integrator"]["values"][0], Json::array({"photonmapper", "PM"}));
    EXPECT_EQ(by_name["seconds"]["kind"], "time");
    EXPECT_EQ(by_name["seed"]["kind"], "identity");
    EXPECT_EQ(by_name["threads"]["kind"], "identity");
    EXPECT_EQ(by_name["radius_initial"]["unit"], "scene units");
    for (const Metric& metric : metrics()) EXPECT_EQ(by_name[std::string(metric.name)]["error"], true);
}

TEST(Columns, HaveTheSettingsThatMakeAMethod) {
    for (const SettingField& field : setting_fields()) {
        const auto is_of_it = [&](const Column& column) {
            return column.name == field.name || column.name == std::string(field.name) + "_initial";
        };
        EXPECT_EQ(std::count_if(columns().begin(), columns().end(), is_of_it), 1) << field.name;
    }
    std::set<std::string> names;
    for (const Column& column : columns()) EXPECT_TRUE(names.insert(column.name).second) << column.name << " twice";
}

TEST(Records, TextIsQuotedAsRfc4180Says) {
    EXPECT_EQ(csv_cell("plain"), "plain");
    EXPECT_EQ(csv_cell("a,b"), "\"a,b\"");
    EXPECT_EQ(csv_cell("say \"b\""), "\"say \"\"b\"\"\"");
    EXPECT_EQ(csv_cell("two\nlines"), "\"two\nlines\"");
}

// A name like =1+1 would be computed by a spreadsheet, and =HYPERLINK(...) would do more.
TEST(Records, TextThatASpreadsheetTakesForAFormulaIsKeptFromIt) {
    for (const std::string text : {"=1+1", "+x", "-x_ppm_seed-1", "@sum", "\tx", "=1.xml", "-1+1", "-", "=", "+ 1"})
        EXPECT_EQ(csv_cell(text), "'" + text);
    EXPECT_EQ(csv_cell("\rx"), "\"'\rx\"");
    EXPECT_EQ(csv_cell("=a,b"), "\"'=a,b\"");
    // One apostrophe more than the text has, so that taking one away gives the text back.
    EXPECT_EQ(csv_cell("'=1"), "''=1");
    EXPECT_EQ(csv_cell("''@"), "'''@");
    for (const std::string text : {"-1", "-0.25", "1e-05", "-1e+300", "+5", "-inf", "inf", "nan", "-nan", "", "'",
                                   "'quoted'", "a=1", "box-1", "0"})
        EXPECT_EQ(csv_cell(text), text) << "no formula";
    EXPECT_EQ(csv_cell("caf\xe9"), "caf\xef\xbf\xbd") << "a table is UTF-8";
}

TEST(Records, NonFinitePixelsAreCountedAndLocated) {
    const TestFolder folder;
    Image image{3, 2, {}};
    for (const std::string_view name : {emission_layer, direct_layer, gathered_layer})
        image.layers.push_back({std::string(name), std::vector<Color>(6, Color(1.0f))});
    image.layers[2].pixels[4].y = std::numeric_limits<float>::quiet_NaN();
    Recorder recorder({}, nullptr, folder / "iterations.csv");
    RunState state;
    state.ranges = {{1, 7}};
    recorder.record(state, image);
    EXPECT_EQ(recorder.nonfinite_pixels(), 1u);
    ASSERT_EQ(recorder.first_nonfinite_pixels().size(), 2u);
    const NonfinitePixel& first = recorder.first_nonfinite_pixels()[0];
    EXPECT_EQ(first.pass, 7u);
    EXPECT_EQ(first.component, "total");
    EXPECT_EQ(first.x, 1);
    EXPECT_EQ(first.y, 1);
    EXPECT_EQ(recorder.first_nonfinite_pixels()[1].component, "gathered");
}

Image uniform_image(float emission, float direct, float gathered) {
    Image image{1, 1, {}};
    image.layers.push_back({std::string(emission_layer), {Color(emission)}});
    image.layers.push_back({std::string(direct_layer), {Color(direct)}});
    image.layers.push_back({std::string(gathered_layer), {Color(gathered)}});
    return image;
}

TEST(Judgement, GatheredIsJudgedWithDirectWhenPhotonsCarryIt) {
    Reference reference;
    reference.half_a = uniform_image(1.0f, 2.0f, 3.0f);
    reference.half_b = reference.half_a;
    const Image image = uniform_image(1.0f, 0.0f, 5.5f);
    EXPECT_DOUBLE_EQ(judge(image, reference, "gathered", true)->of("mse").value(), 0.25);
    EXPECT_FALSE(judge(image, reference, "direct", true).has_value());
    EXPECT_DOUBLE_EQ(judge(image, reference, "gathered", false)->of("mse").value(), 6.25);
    EXPECT_DOUBLE_EQ(judge(image, reference, "direct", false)->of("mse").value(), 4.0);
    EXPECT_DOUBLE_EQ(judge(image, reference, "total", true)->of("mse").value(), 0.25);
}

TEST(Judgement, HalvesRemoveTheReferencesNoise) {
    Reference reference;
    reference.half_a = uniform_image(0.0f, 0.0f, 4.0f);
    reference.half_b = uniform_image(0.0f, 0.0f, 2.0f);
    const auto errors = judge(uniform_image(0.0f, 0.0f, 3.5f), reference, "total", false);
    ASSERT_TRUE(errors.has_value());
    EXPECT_DOUBLE_EQ(errors->of("mse").value(), 0.25);
    EXPECT_DOUBLE_EQ(errors->of("mse_unbiased").value(), -0.75);
    EXPECT_DOUBLE_EQ(errors->of("reference_floor").value(), 1.0);
}

}  // namespace
}  // namespace photonlab
