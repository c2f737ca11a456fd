#include "experiment/experiment_runs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "experiment/run_list.h"
#include "image/exr.h"
#include "record/recorder.h"
#include "reference/reference_store.h"
#include "tests/support/results.h"
#include "tests/support/two_walls.h"

namespace photonlab {
namespace {

/// A small experiment with a small reference.
class ExperimentRuns : public ::testing::Test {
protected:
    ExperimentRuns() { write_two_walls(folder_, 64); }

    ExperimentOutcome run(const std::string& settings = "", std::optional<std::string> only = std::nullopt) {
        folder_.write("tiny.toml",
                      "title = \"Does it run?\"\npasses = 3\nseeds = 2\nthreads = 1\nsnapshots = [1]\n"
                      "scenes = [{ path = \"walls/scene.xml\", reference = \"reference\" }]\n"
                      "photons_per_pass = 400\n" +
                          settings +
                          "[[method]]\nintegrator = \"ppm\"\n"
                          "[[method]]\nname = \"nearest\"\nintegrator = \"photonmapper\"\nmode = \"nearest\"\nk = 20\n"
                          "[[method]]\nname = \"photons-only\"\nintegrator = \"ppm\"\ndirect = \"photons\"\n"
                          "[[method]]\nintegrator = \"path\"\n");
        const Experiment experiment = read_experiment(folder_ / "tiny.toml");
        return run_experiment(experiment, prepare_experiment(experiment, results(), {only}), results());
    }
    std::filesystem::path results() { return folder_ / "results"; }

    TestFolder folder_;
};

TEST_F(ExperimentRuns, RecordsEveryRunPassAndComponent) {
    const ExperimentOutcome outcome = run();
    EXPECT_EQ(outcome.ran, 8u);
    EXPECT_EQ(outcome.merged->runs, 8u);
    const std::vector<Row> rows = read_rows(outcome.records);
    ASSERT_EQ(rows.size(), 8u * 4u * 4u);  // runs, passes 0 1 2 3, components

    std::map<std::string, double> paths;
    for (const Row& row : rows) {
        EXPECT_EQ(row.at("schema"), "1");
        EXPECT_EQ(row.at("experiment"), "tiny");
        EXPECT_EQ(row.at("scene"), "walls");
        EXPECT_TRUE(row.at("run").starts_with("walls_" + row.at("method"))) << row.at("method");
        EXPECT_EQ(row.at("max_depth"), "5");
        EXPECT_EQ(row.at("width"), "12");
        EXPECT_EQ(row.at("nonfinite"), "0");
        const bool carried = row.at("direct") == "photons";
        if (carried && row.at("component") == "direct") {
            EXPECT_EQ(row.at("mse"), "");
            continue;
        }
        const double mse = std::stod(row.at("mse"));
        EXPECT_DOUBLE_EQ(std::stod(row.at("rmse")), std::sqrt(mse));
        EXPECT_NE(row.at("reference_floor"), "");
        if (row.at("component") == "emission") {
            EXPECT_LT(mse, 1e-12);
        }
        if (row.at("integrator") == "path") {
            EXPECT_EQ(row.at("paths_emitted"), "");
            continue;
        }
        EXPECT_EQ(row.at("paths_emitted"), std::to_string(400 * std::stoi(row.at("pass"))));
        if (row.at("component") == "total") {
            EXPECT_TRUE(row.at("pass") == "0" || std::stod(row.at("paths_emitted")) > paths[row.at("run")]);
            paths[row.at("run")] = std::stod(row.at("paths_emitted"));
        }
        if (row.at("pass") == "0") {
            EXPECT_EQ(row.at("photons_gathered"), "0");
        }
    }
}

TEST_F(ExperimentRuns, ErrorsAreThoseOfTheImage) {
    run();
    const Image image = read_exr(results() / "runs/walls_ppm_seed-1/snapshots/pass-000003.exr");
    const Reference reference = load_reference(folder_ / "reference", std::nullopt);
    for (const Row& row : read_rows(results() / "runs/walls_ppm_seed-1/iterations.csv"))
        if (row.at("pass") == "3") {
            EXPECT_EQ(std::stod(row.at("mse")), judge(image, reference, row.at("component"), false)->of("mse").value());
        }
}

TEST_F(ExperimentRuns, SaysHowEachRunWasMade) {
    run();
    const Json json = Json::parse(read_text_file(results() / "runs/walls_nearest_seed-2/run.json"));
    EXPECT_EQ(json.at("finished"), true);
    EXPECT_EQ(json.at("title"), "Does it run?");
    EXPECT_EQ(json.at("settings").at("k"), 20);
    EXPECT_TRUE(json.at("settings").at("alpha").is_null());
    EXPECT_EQ(json.at("seed"), 2);
    EXPECT_EQ(json.at("counters").at("paths_emitted"), 1200);
    ASSERT_EQ(json.at("snapshots").size(), 2u);
    EXPECT_EQ(json.at("snapshots")[0].at("file"), "snapshots/pass-000001.exr");
    EXPECT_TRUE(std::filesystem::exists(results() / "runs/walls_nearest_seed-2/snapshots/pass-000003.exr"));
    for (const char* key : {"program", "processor", "started", "scene", "reference", "working_directory", "radius"})
        EXPECT_TRUE(json.contains(key)) << key;
}

TEST_F(ExperimentRuns, FinishedRunsAreSkippedAndChangedOnesMadeAgain) {
    run();
    const std::string before = read_text_file(results() / "iterations.csv");
    ExperimentOutcome outcome = run();
    EXPECT_EQ(outcome.ran, 0u);
    EXPECT_EQ(outcome.skipped, 8u);
    EXPECT_EQ(read_text_file(results() / "iterations.csv"), before);

    outcome = run("max_radius = 0.5\n");  // used by `nearest` alone
    EXPECT_EQ(outcome.ran, 2u);
    EXPECT_EQ(outcome.skipped, 6u);
    for (const Row& row : read_rows(results() / "iterations.csv")) {
        EXPECT_EQ(row.at("max_radius"), row.at("integrator") == "photonmapper" ? "0.5" : "");
    }
}

TEST_F(ExperimentRuns, AnInterruptedRunIsMadeAgain) {
    run();
    const std::filesystem::path folder = results() / "runs/walls_ppm_seed-1";
    const std::string rows = read_text_file(folder / "iterations.csv");
    std::filesystem::remove(folder / "run.json");
    write_text_file(folder / "iterations.csv", rows.substr(0, rows.size() / 2));
    EXPECT_EQ(run().ran, 1u);
    EXPECT_EQ(read_rows(folder / "iterations.csv").size(), 16u);
}

TEST_F(ExperimentRuns, ARunWhoseRecordsAreDamagedIsMadeAgain) {
    run();
    const std::filesystem::path file = results() / "runs/walls_path_seed-1/iterations.csv";
    const std::string rows = read_text_file(file);
    for (const std::string& damaged :
         {rows.substr(0, rows.size() / 2), rows.substr(0, rows.rfind('\n', rows.size() - 2) + 1)}) {
        write_text_file(file, damaged);
        EXPECT_EQ(run().ran, 1u);
        EXPECT_EQ(read_rows(file).size(), 16u);
        EXPECT_EQ(read_rows(results() / "iterations.csv").size(), 8u * 16u);
    }
}

TEST_F(ExperimentRuns, AFolderOfAnotherExperimentIsRefused) {
    run();
    const Experiment small = read_experiment(folder_ / "tiny.toml", SmokeLimits{});
    const std::string before = read_text_file(results() / "iterations.csv");
    EXPECT_EQ(message_of([&] { prepare_experiment(small, results()); }),
              (results() / "experiment.json").string() +
                  ": these are results of the experiment \"tiny\", not of \"tiny-smoke\"; choose another folder for "
                  "the results");
    EXPECT_EQ(message_of([&] { run_experiment(small, {}, results()); }),
              message_of([&] { prepare_experiment(small, results()); }));
    EXPECT_EQ(read_text_file(results() / "iterations.csv"), before);
}

// On another machine there are other numbers of cores; what is made is the same.
TEST_F(ExperimentRuns, ThreadsAndTitleAreNotWhatARunIsKnownBy) {
    run("decomposition = true\n");
    const std::string before = read_text_file(results() / "iterations.csv");
    std::string text = read_text_file(folder_ / "tiny.toml");
    text.replace(text.find("threads = 1"), 11, "threads = 3");
    text.replace(text.find("Does it run?"), 12, "Does it walk?");
    folder_.write("tiny.toml", text);
    Experiment experiment = read_experiment(folder_ / "tiny.toml");
    ExperimentOutcome outcome = run_experiment(experiment, prepare_experiment(experiment, results()), results());
    EXPECT_EQ(outcome.ran, 0u);
    EXPECT_EQ(outcome.merged->runs, 8u);
    EXPECT_EQ(read_text_file(results() / "iterations.csv"), before);

    // What is made now says so, beside rows of other threads, and joins the sums.
    text.replace(text.find("seeds = 2"), 9, "seeds = 3");
    folder_.write("tiny.toml", text);
    experiment = read_experiment(folder_ / "tiny.toml");
    outcome = run_experiment(experiment, prepare_experiment(experiment, results()), results());
    EXPECT_EQ(outcome.ran, 4u);
    for (const Row& row : read_rows(results() / "iterations.csv"))
        EXPECT_EQ(row.at("threads"), row.at("seed") == "3" ? "3" : "1");
    for (const char* slot : {"slot-00.exr", "slot-01.exr", "slot-02.exr"})
        EXPECT_TRUE(std::filesystem::exists(results() / "ensembles/walls_ppm" / slot)) << slot;
}

TEST_F(ExperimentRuns, OnlyTheSelectedRunsAreMade) {
    EXPECT_EQ(run("", "walls_ppm_seed-1").ran, 1u);
    const ExperimentOutcome outcome = run("", "*_seed-2");
    EXPECT_EQ(outcome.ran, 4u);
    EXPECT_EQ(outcome.merged->runs, 5u);
    const std::string message = message_of([&] { run("", "walls_pmp_*"); });
    EXPECT_TRUE(message.starts_with("--only: unknown run \"walls_pmp_*\"; known here: walls_ppm_seed-1, ")) << message;
}

TEST_F(ExperimentRuns, WhereASceneThatIsNotSelectedCannotBeLoadedTheRecordsStay) {
    folder_.write("other/scene.xml", two_walls_scene);
    folder_.write(
        "two.toml",
        "passes = 2\nthreads = 1\nphotons_per_pass = 400\nscenes = [\"walls/scene.xml\", \"other/scene.xml\"]\n"
        "[[method]]\nintegrator = \"ppm\"\n[[method]]\nintegrator = \"path\"\n");
    const Experiment two = read_experiment(folder_ / "two.toml");
    run_experiment(two, prepare_experiment(two, results(), {"*_ppm_*"}), results());
    const std::string before = read_text_file(results() / "iterations.csv");
    folder_.write("other/scene.xml", "<scene>");
    const ExperimentOutcome outcome =
        run_experiment(two, prepare_experiment(two, results(), {"walls_path_*"}), results());
    EXPECT_EQ(outcome.ran, 1u);
    EXPECT_FALSE(outcome.merged);
    EXPECT_NE(outcome.why_not_merged.find("other/scene.xml"), std::string::npos) << outcome.why_not_merged;
    EXPECT_EQ(read_text_file(results() / "iterations.csv"), before);

    folder_.write("other/scene.xml", two_walls_scene);
    EXPECT_EQ(run_experiment(two, prepare_experiment(two, results(), {"walls_path_*"}), results()).merged->runs, 3u);
}

TEST_F(ExperimentRuns, ARadiusThatTheSceneCannotResolveIsRefusedBeforeAnythingRuns) {
    const std::string message = message_of([&] { run("radius = 1e-20\n"); });
    EXPECT_NE(message.find("tiny.toml: run walls_"), std::string::npos) << message;
    EXPECT_NE(message.find("radius: expected from 1e-07 to 1e+18 of the scene"), std::string::npos) << message;
    EXPECT_FALSE(std::filesystem::exists(results()));
}

TEST_F(ExperimentRuns, AReferenceOfAnotherDepthIsRefusedBeforeAnythingRuns) {
    const std::string message = message_of([&] { run("max_depth = 4\n"); });
    EXPECT_NE(message.find("max_depth is 5 in the reference and 4 here"), std::string::npos) << message;
    EXPECT_FALSE(std::filesystem::exists(results()));
}

TEST_F(ExperimentRuns, ListsRunsWithTimeAndMemory) {
    run("", "walls_path_seed-1");
    const Experiment experiment = read_experiment(folder_ / "tiny.toml");
    const std::string list = list_runs(experiment, prepare_experiment(experiment, results()));
    EXPECT_NE(list.find("walls_ppm_seed-1           about "), std::string::npos) << list;
    EXPECT_NE(list.find("walls_path_seed-1          finished"), std::string::npos) << list;
    EXPECT_NE(list.find("8 runs of 3 passes"), std::string::npos) << list;
}

// The sums of two seeds and the third one's image are the three images: what was kept is what ran.
TEST_F(ExperimentRuns, KeepsSumsOverSeedsForADecomposition) {
    run("decomposition = true\n");
    const Image sum = read_exr(results() / "ensembles/walls_ppm/slot-01.exr");
    const Image image = read_exr(results() / "runs/walls_ppm_seed-2/snapshots/pass-000003.exr");
    EXPECT_EQ(*sum.find("pass-000003-gathered"), *image.find("gathered"));
    EXPECT_EQ(*sum.find("emission"), *image.find("emission"));
    const Json json = Json::parse(read_text_file(results() / "ensembles/walls_photons-only/ensemble.json"));
    EXPECT_EQ(json.at("photons_carry_direct"), true);
    EXPECT_EQ(json.at("passes"), Json({0, 1, 2, 3}));
    EXPECT_EQ(json.at("scene"), "walls");

    // More seeds do not redo the old ones, and a folder that was removed is made again.
    EXPECT_EQ(run("decomposition = true\n").ran, 0u);
    std::filesystem::remove_all(results() / "ensembles/walls_ppm");
    EXPECT_EQ(run("decomposition = true\n").ran, 2u);
    EXPECT_TRUE(std::filesystem::exists(results() / "ensembles/walls_ppm/slot-01.exr"));
}

TEST_F(ExperimentRuns, RunsThatShareTheirPhotonsRecordWhatTheyWouldAlone) {
    run();
    const std::vector<Row> together = read_rows(results() / "iterations.csv");
    std::filesystem::remove_all(results());
    for (const char* only : {"walls_ppm_*", "walls_nearest_*", "walls_photons-only_*", "walls_path_*"}) run("", only);
    const std::vector<Row> alone = read_rows(results() / "iterations.csv");
    ASSERT_EQ(together.size(), alone.size());
    for (std::size_t i = 0; i < alone.size(); ++i)
        for (const char* column : {"run", "pass", "component", "mse", "bias", "photons_stored", "photons_gathered",
                                   "radius_mean", "map_bytes"})
            EXPECT_EQ(together[i].at(column), alone[i].at(column)) << column;
    const Json json = Json::parse(read_text_file(results() / "runs/walls_ppm_seed-1/run.json"));
    EXPECT_EQ(json.at("runs_together"), 1);
}

// Where camera branches end decides which hit points there are, so runs that differ in it do not share them.
TEST_F(ExperimentRuns, EachBranchCutoffHasItsOwnHitPoints) {
    std::string mirror_scene = two_walls_scene;
    const std::string grey = "<ref id=\"grey\"/>";
    mirror_scene.replace(mirror_scene.rfind(grey), grey.size(),
                         "<bsdf type=\"conductor\"><string name=\"material\" value=\"Cu\"/></bsdf>");
    const Scene scene = build_scene(load_scene_file(folder_.write("mirror/scene.xml", mirror_scene)));
    folder_.write("cut.toml",
                  "scenes = [\"mirror/scene.xml\"]\npasses = 2\nphotons_per_pass = 400\n"
                  "[[method]]\nintegrator = \"ppm\"\nbranch_cutoff = [1e-4, 0.99, 1e-5]\n");
    const Experiment experiment = read_experiment(folder_ / "cut.toml");
    run_experiment(experiment, prepare_experiment(experiment, results()), results());
    const auto points = [&](double cutoff) { return trace_hit_points(scene, 1, 1, cutoff).points.size(); };
    ASSERT_LT(points(0.99), points(1e-4));
    std::size_t rows = 0;
    for (const Row& row : read_rows(results() / "iterations.csv")) {
        EXPECT_EQ(row.at("hit_points"), std::to_string(points(std::stod(row.at("branch_cutoff")))));
        ++rows;
    }
    EXPECT_EQ(rows, 3u * 3u * 4u);
}

TEST_F(ExperimentRuns, RecordsProbesAfterEveryPass) {
    folder_.write("probed.toml",
                  "passes = 3\nrecord = [2]\nphotons_per_pass = 400\n"
                  "scenes = [{ path = \"walls/scene.xml\", probes = { wall = [6, 2], sky = [0, 0] } }]\n"
                  "[[method]]\nintegrator = \"ppm\"\n[[method]]\nintegrator = \"photonmapper\"\n"
                  "[[method]]\nintegrator = \"path\"\n");
    const Experiment experiment = read_experiment(folder_ / "probed.toml");
    run_experiment(experiment, prepare_experiment(experiment, results()), results());
    const std::vector<Row> rows = read_rows(results() / "probes.csv");
    std::map<std::string, std::vector<std::string>> passes;
    for (const Row& row : rows) passes[row.at("run") + " " + row.at("probe")].push_back(row.at("pass"));
    EXPECT_EQ(passes["walls_ppm_seed-1 wall"], (std::vector<std::string>{"1", "2", "3"}));
    EXPECT_EQ(passes["walls_photonmapper_seed-1 wall"], (std::vector<std::string>{"0", "2", "3"}));
    EXPECT_FALSE(passes.contains("walls_path_seed-1 wall"));
    EXPECT_GT(std::stod(rows.back().at("radius")), 0.0);
}

TEST_F(ExperimentRuns, RefusesRegionsAndProbesOutsideTheImage) {
    const auto refusal = [&](const std::string& what) {
        folder_.write("outside.toml", "passes = 3\nscenes = [{ path = \"walls/scene.xml\", " + what +
                                          " }]\n[[method]]\nintegrator = \"ppm\"\n");
        const Experiment experiment = read_experiment(folder_ / "outside.toml");
        return message_of([&] { prepare_experiment(experiment, results()); });
    };
    EXPECT_EQ(refusal("regions = { all = [0, 0, 12, 8] }"), "");
    EXPECT_NE(refusal("regions = { low = [0, 0, 12, 9] }")
                  .find("region low of walls: expected pixels inside 12x8, got up to 12 9"),
              std::string::npos);
    EXPECT_NE(
        refusal("probes = { right = [12, 0] }").find("probe right of walls: expected a pixel inside 12x8, got 12 0"),
        std::string::npos);
}

}  // namespace
}  // namespace photonlab
