#include "experiment/file/experiment_file.h"

#include <gtest/gtest.h>

#include "tests/support/test_folder.h"

namespace photonlab {
namespace {

/// Reads an experiment of this text in a folder that holds the files it names.
class ExperimentFile : public ::testing::Test {
protected:
    ExperimentFile() {
        folder_.write("box/scene.xml", "");
        folder_.write("lamp.xml", "");
    }
    Experiment read(const std::string& text, std::optional<SmokeLimits> smoke = std::nullopt) {
        return read_experiment(folder_.write("question.toml", text), smoke);
    }
    std::string refusal(const std::string& text) {
        std::string message = message_of([&] { read(text); });
        const std::string prefix = (folder_ / "question.toml").string();
        return message.starts_with(prefix) ? message.substr(prefix.size()) : message;
    }
    std::vector<std::string> names(const Experiment& experiment) {
        std::vector<std::string> result;
        for (const ExperimentRun& run : runs_of(experiment)) result.push_back(run.name);
        return result;
    }
    TestFolder folder_;
};

const std::string least = "scenes = [\"box/scene.xml\"]\npasses = 8\n";
const std::string ppm = "[[method]]\nintegrator = \"ppm\"\n";

TEST_F(ExperimentFile, IsTheProductOfScenesMethodsAxesAndSeeds) {
    const Experiment experiment = read(
        "title = \"Why?\"\nscenes = [\"box/scene.xml\", { path = \"lamp.xml\" }]\npasses = 8\nseeds = 2\n"
        "[[method]]\nintegrator = \"ppm\"\nalpha = [0.5, 0.7]\n"
        "[[method]]\nname = \"pm\"\nintegrator = \"photonmapper\"\nk = 50\nmode = \"nearest\"\n");
    EXPECT_EQ(experiment.title, "Why?");
    EXPECT_EQ(experiment.name, "question");
    EXPECT_EQ(
        names(experiment),
        (std::vector<std::string>{"box_ppm_alpha-0.5_seed-1", "box_ppm_alpha-0.5_seed-2", "box_ppm_alpha-0.7_seed-1",
                                  "box_ppm_alpha-0.7_seed-2", "box_pm_seed-1", "box_pm_seed-2",
                                  "lamp_ppm_alpha-0.5_seed-1", "lamp_ppm_alpha-0.5_seed-2", "lamp_ppm_alpha-0.7_seed-1",
                                  "lamp_ppm_alpha-0.7_seed-2", "lamp_pm_seed-1", "lamp_pm_seed-2"}));
    EXPECT_EQ(experiment.points[1].settings.values.alpha, 0.7);
    EXPECT_EQ(experiment.points[2].settings.values.k, 50);
}

// A job of many makes what it needs of the product; it must be what the whole product has.
TEST_F(ExperimentFile, RunsOfGroupsAreThoseOfAllThatAreInThem) {
    const Experiment experiment = read(
        "scenes = [\"box/scene.xml\", \"lamp.xml\"]\npasses = 8\nseeds = [4, 9, 2]\n"
        "[[method]]\nintegrator = \"ppm\"\nalpha = [0.5, 0.7]\n");
    ASSERT_EQ(experiment.group_count(), 6u);
    for (std::size_t first = 1; first <= 6; ++first)
        for (std::size_t last = first; last <= 6; ++last) {
            std::vector<std::string> expected, found;
            for (const ExperimentRun& run : runs_of(experiment))
                if (first <= run.group && run.group <= last) expected.push_back(run.name);
            for (const ExperimentRun& run : runs_of(experiment, GroupRange{first, last})) found.push_back(run.name);
            EXPECT_EQ(found, expected) << first << " to " << last;
            EXPECT_EQ(found.size(), 2 * (last - first + 1));
        }
}

TEST_F(ExperimentFile, TopLevelSettingsAreDefaultsWhereTheyAreUsed) {
    const Experiment experiment =
        read(least + "photons_per_pass = 77\nalpha = [0.5, 0.9]\n" + ppm +
             "[[method]]\nintegrator = \"path\"\n"
             "[[method]]\nname = \"few\"\nintegrator = \"ppm\"\nphotons_per_pass = 5\nalpha = 0.6\n");
    EXPECT_EQ(names(experiment), (std::vector<std::string>{"box_ppm_alpha-0.5_seed-1", "box_ppm_alpha-0.9_seed-1",
                                                           "box_path_seed-1", "box_few_seed-1"}));
    EXPECT_EQ(experiment.points[0].settings.values.photons_per_pass, 77u);
    EXPECT_EQ(experiment.points[3].settings.values.photons_per_pass, 5u);
}

TEST_F(ExperimentFile, SamplesPerPixelAreOneUnlessItSaysOtherwise) {
    EXPECT_EQ(read(least + ppm).scenes[0].samples_per_pixel, 1);
    EXPECT_EQ(read(least + "samples_per_pixel = 9\n" + ppm).scenes[0].samples_per_pixel, 9);
}

// One scene of them for each, with hit points of its own; its name stays, so that figures have them in one panel.
TEST_F(ExperimentFile, SamplesPerPixelCanBeSwept) {
    const Experiment experiment = read(
        "passes = 8\nsamples_per_pixel = [1, 16]\n"
        "scenes = [\"box/scene.xml\", { path = \"lamp.xml\", samples_per_pixel = 4 }]\n" +
        ppm);
    EXPECT_EQ(names(experiment), (std::vector<std::string>{"box_ppm_samples_per_pixel-1_seed-1",
                                                           "box_ppm_samples_per_pixel-16_seed-1", "lamp_ppm_seed-1"}));
    ASSERT_EQ(experiment.scenes.size(), 3u);
    EXPECT_EQ(experiment.scenes[1].name, "box");
    EXPECT_EQ(experiment.scenes[1].samples_per_pixel, 16);
    EXPECT_EQ(experiment.scenes[2].samples_per_pixel, 4);
    EXPECT_EQ(names(read(least + ppm + "samples_per_pixel = [16, 4]\n[[method]]\nintegrator = \"sppm\"\n")),
              (std::vector<std::string>{"box_sppm_seed-1", "box_ppm_samples_per_pixel-4_seed-1",
                                        "box_ppm_samples_per_pixel-16_seed-1"}));
    EXPECT_EQ(refusal("passes = 8\nscenes = [\"lamp.xml\"]\nsamples_per_pixel = [1, 3]\n" + ppm),
              ":3: samples_per_pixel: expected a perfect square from 1 to 1048576, got 3");
}

TEST_F(ExperimentFile, PassZeroAndTheLastAreAlwaysRecorded) {
    using Passes = std::vector<std::uint64_t>;
    EXPECT_EQ(read("scenes = [\"lamp.xml\"]\npasses = 11\n" + ppm).points[0].plan.recorded,
              (Passes{0, 1, 2, 4, 8, 11}));
    EXPECT_EQ(read(least + "record = \"all\"\n" + ppm).points[0].plan.recorded, (Passes{0, 1, 2, 3, 4, 5, 6, 7, 8}));
    const PassPlan listed = read(least + "record = [3, 2]\nsnapshots = [1]\n" + ppm).points[0].plan;
    EXPECT_EQ(listed.recorded, (Passes{0, 2, 3, 8}));
    EXPECT_EQ(listed.snapshots, (Passes{1, 8}));
}

// So that methods with different photons a pass can have the same in all.
TEST_F(ExperimentFile, AMethodMayHavePassesOfItsOwn) {
    using Passes = std::vector<std::uint64_t>;
    const std::string methods = ppm + "[[method]]\nname = \"more\"\nintegrator = \"ppm\"\npasses = 20\n";
    const Experiment experiment = read(least + "record = [3, 12]\n" + methods);
    EXPECT_EQ(experiment.points[0].plan.recorded, (Passes{0, 3, 8}));
    EXPECT_EQ(experiment.points[1].plan.recorded, (Passes{0, 3, 12, 20}));
    EXPECT_EQ(experiment.points[1].plan.passes, 20u);
    EXPECT_EQ(read(least + methods).points[1].plan.recorded, (Passes{0, 1, 2, 4, 8, 16, 20}));
    EXPECT_EQ(read(least + methods, SmokeLimits{}).points[1].plan.passes, 4u);
    EXPECT_TRUE(refusal(least + ppm + "passes = 0\n").starts_with(":5: passes: expected a whole number"));
    EXPECT_TRUE(refusal(least + "record = [21]\n" + methods).starts_with(":3: record: expected a whole number from 0"));
}

TEST_F(ExperimentFile, SmokeShrinksPassesPhotonsAndSeeds) {
    const Experiment experiment =
        read(least + "seeds = [5, 6, 7]\nrecord = [3, 8]\nsnapshots = [8]\n" + ppm, SmokeLimits{});
    EXPECT_EQ(experiment.name, "question-smoke");
    EXPECT_EQ(experiment.points[0].plan.passes, 4u);
    EXPECT_EQ(experiment.points[0].plan.recorded, (std::vector<std::uint64_t>{0, 3, 4}));
    EXPECT_EQ(experiment.points[0].plan.snapshots, (std::vector<std::uint64_t>{4}));
    ASSERT_EQ(experiment.run_count(), 2u);
    EXPECT_EQ(experiment.points[0].settings.values.photons_per_pass, 2000u);
}

TEST_F(ExperimentFile, TheDemonstrationIsSound) {
    const std::filesystem::path demo = std::filesystem::path(PHOTONLAB_SOURCE_DIR) / "experiments/demo.toml";
    if (!std::filesystem::exists(std::filesystem::path(PHOTONLAB_SOURCE_DIR) / "reference/cornell-box"))
        GTEST_SKIP() << "its scene or reference is not here";
    EXPECT_EQ(read_experiment(demo).run_count(), 20u);
}

TEST_F(ExperimentFile, ScenesHaveRegionsAndProbes) {
    const Experiment experiment = read(
        "passes = 8\ndecomposition = true\n"
        "scenes = [{ path = \"lamp.xml\", regions = { smooth = [1, 2, 30, 40] }, probes = { corner = [5, 6] } }]\n" +
        ppm);
    EXPECT_TRUE(experiment.decomposition);
    ASSERT_EQ(experiment.scenes[0].regions.size(), 1u);
    const Region& region = experiment.scenes[0].regions[0];
    EXPECT_EQ(region.name, "smooth");
    EXPECT_EQ((std::vector<int>{region.left, region.top, region.right, region.bottom}),
              (std::vector<int>{1, 2, 30, 40}));
    ASSERT_EQ(experiment.scenes[0].probes.size(), 1u);
    EXPECT_EQ(experiment.scenes[0].probes[0].name, "corner");
    EXPECT_EQ(experiment.scenes[0].probes[0].y, 6);
    EXPECT_FALSE(read(least + ppm).decomposition);
    EXPECT_EQ(read(least + ppm).points[0].name, "box_ppm");
}

}  // namespace
}  // namespace photonlab
