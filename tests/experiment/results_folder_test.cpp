#include "experiment/results_folder.h"

#include <gtest/gtest.h>

#include "core/text/csv.h"
#include "record/columns.h"
#include "tests/support/test_folder.h"

namespace photonlab {
namespace {

class ResultsFolder : public ::testing::Test {
protected:
    static Experiment experiment(const std::string& name = "study", const std::string& point = "box_ppm") {
        Experiment experiment;
        experiment.file = "/somewhere/" + name + ".toml";
        experiment.name = name;
        experiment.title = "Is it mine?";
        experiment.points.resize(1);
        experiment.points[0].name = point;
        experiment.seeds = {1};
        return experiment;
    }
    std::filesystem::path results() const { return folder_ / "results"; }

    /// What the refusal says behind the name of the file in the results folder; empty when there is none.
    std::string refusal(const Experiment& experiment) const {
        const std::string message = message_of([&] { require_own_results(experiment, results()); });
        const std::string before = results().string() + "/";
        return message.starts_with(before) ? message.substr(before.size()) : message;
    }
    std::string refusal() const { return refusal(experiment()); }

    void expect_refused_for(const std::string& name, const std::string& text, const std::string& reason) {
        folder_.write("results/" + name, text);
        EXPECT_NE(refusal().find(reason), std::string::npos) << refusal();
        EXPECT_NE(refusal().find("choose another folder for the results"), std::string::npos) << refusal();
        EXPECT_NE(message_of([&] { claim_results(experiment(), results()); }), "");
        EXPECT_EQ(read_text_file(results() / name), text);
        EXPECT_FALSE(std::filesystem::exists(results() / "experiment.json"));
        std::filesystem::remove_all(results());
    }

    const std::string header_ = csv_header() + "\n";
    TestFolder folder_;
};

TEST_F(ResultsFolder, ThatIsNewOrHoldsOtherThingsIsTaken) {
    EXPECT_EQ(refusal(), "");
    EXPECT_FALSE(std::filesystem::exists(results()));
    folder_.write("results/notes.txt", "to do");
    std::filesystem::create_directories(results() / "runs");
    EXPECT_EQ(refusal(), "");
    claim_results(experiment(), results());
    const Json json = Json::parse(read_text_file(results() / "experiment.json"));
    EXPECT_EQ(json.at("schema"), 1);
    EXPECT_EQ(json.at("experiment"), "study");
    EXPECT_EQ(json.at("smoke"), false);
    EXPECT_EQ(json.at("title"), "Is it mine?");
    EXPECT_EQ(json.at("file"), "/somewhere/study.toml");
}

TEST_F(ResultsFolder, OfTheExperimentIsKeptAsItIsUnlessItSaysOtherwise) {
    claim_results(experiment(), results());
    const auto made = std::filesystem::last_write_time(results() / "experiment.json");
    claim_results(experiment(), results());
    EXPECT_EQ(std::filesystem::last_write_time(results() / "experiment.json"), made);
    Experiment moved = experiment();
    moved.file = "/elsewhere/study.toml";
    moved.title = "Is it still?";
    claim_results(moved, results());
    const Json json = Json::parse(read_text_file(results() / "experiment.json"));
    EXPECT_EQ(json.at("title"), "Is it still?");
    EXPECT_EQ(json.at("file"), "/elsewhere/study.toml");
}

TEST_F(ResultsFolder, OfAnotherExperimentIsRefusedThoughTheyHaveNoRunInCommon) {
    claim_results(experiment(), results());
    EXPECT_EQ(refusal(experiment("other", "sphere_path")),
              "experiment.json: these are results of the experiment \"study\", not of \"other\"; choose another folder "
              "for the results");
    Experiment small = experiment();
    small.is_smoke = true;  // as of study-smoke.toml at full size beside study.toml in small
    EXPECT_NE(refusal(small).find("experiment.json: these are results without --smoke"), std::string::npos);
}

TEST_F(ResultsFolder, OfAnotherFileOfTheSameNameIsRefusedUnlessTheyHaveARunInCommon) {
    claim_results(experiment(), results());
    Experiment elsewhere = experiment("study", "sphere_path");
    elsewhere.file = "/elsewhere/study.toml";
    EXPECT_EQ(refusal(elsewhere), "");  // nothing was made yet
    std::filesystem::create_directories(results() / "runs/box_ppm_seed-1");
    EXPECT_NE(refusal(elsewhere).find("these are results of /somewhere/study.toml, which has no run in common with "
                                      "/elsewhere/study.toml"),
              std::string::npos);
    EXPECT_EQ(refusal(experiment("study", "sphere_path")), "");  // its own file, changed
    elsewhere.points[0].name = "box_ppm";
    EXPECT_EQ(refusal(elsewhere), "");  // moved
}

TEST_F(ResultsFolder, WhoseDescriptionSaysNothingIsRefused) {
    for (const char* text : {"", "{", "[]", "{\"experiment\": 7, \"schema\": 1}", "{\"experiment\": \"study\"}",
                             "{\"schema\": 2, \"experiment\": \"study\"}"}) {
        folder_.write("results/experiment.json", text);
        EXPECT_NE(refusal().find("experiment.json: does not say whose results these are; choose another folder for the "
                                 "results, or remove this file if they are of the experiment \"study\""),
                  std::string::npos)
            << refusal();
    }
}

TEST_F(ResultsFolder, WithSomebodyElsesFilesIsRefused) {
    expect_refused_for("iterations.csv", "step,loss\n1,0.5\n", "iterations.csv: is there already, and is no table of");
    expect_refused_for("iterations.csv", "x", "iterations.csv: is there already, and is no table of");
    expect_refused_for("iterations.csv", header_ + "1,other,box_ppm_seed-1\n", "no table of the experiment \"study\"");
    expect_refused_for("iterations.csv", header_ + "study", "no table of the experiment \"study\"");
    expect_refused_for("merged.json", "{\"experiment\": \"other\"}",
                       "merged.json: is there already, and says nothing of");
    expect_refused_for("probes.csv", "time,value\n", "probes.csv: is there already, and is no table of");
    expect_refused_for("runs/Jan01/events", "", "runs: is there already, and holds nothing of the experiment");
    expect_refused_for("runs", "a file", "runs: is there already, and holds nothing of the experiment");
    expect_refused_for("runs/box_ppm_seed-1/run.json", "{}", "runs: is there already, and holds nothing of");
    expect_refused_for("runs/a/run.json", "{\"experiment\": \"other\"}",
                       "runs/a/run.json: this is of the experiment \"other\", not of \"study\"");
    expect_refused_for("ensembles/mean/weights", "", "ensembles: is there already, and holds nothing of");
    expect_refused_for("ensembles/box_ppm/ensemble.json", "{\"experiment\": \"other\"}",
                       "ensembles/box_ppm/ensemble.json: this is of the experiment \"other\", not of \"study\"");
}

TEST_F(ResultsFolder, OfAnEarlierProgramIsKnownByItsRuns) {
    folder_.write("results/iterations.csv", header_ + "1,study,box_ppm_seed-1\n");
    folder_.write("results/probes.csv", "schema,experiment,run,scene\n1,study,box_ppm_seed-1\n");
    folder_.write("results/runs/box_ppm_seed-1/run.json", "{\"experiment\": \"study\"}");
    folder_.write("results/runs/box_ppm_seed-2/checkpoint", "not finished");
    folder_.write("results/ensembles/box_ppm/ensemble.json", "{\"experiment\": \"study\"}");
    EXPECT_EQ(refusal(), "");
    claim_results(experiment(), results());
    EXPECT_EQ(refusal(), "");
    std::filesystem::remove(results() / "experiment.json");
    EXPECT_NE(refusal(experiment("other")), "");
    folder_.write("results/iterations.csv", header_);  // of an interrupted one, which had no finished run
    EXPECT_EQ(refusal(), "");
}

TEST_F(ResultsFolder, OfAnExperimentWithAnyNameIsKnown) {
    for (const std::string name : {"a, b", "say \"a\"", "two\nlines", "=1+1"}) {
        folder_.write("results/iterations.csv", header_ + "1," + csv_cell(name) + ",box_ppm_seed-1\n");
        EXPECT_EQ(refusal(experiment(name)), "");
        EXPECT_NE(refusal(experiment("a")), "");
        claim_results(experiment(name), results());
        EXPECT_EQ(refusal(experiment(name)), "");
        std::filesystem::remove_all(results());
    }
}

}  // namespace
}  // namespace photonlab
