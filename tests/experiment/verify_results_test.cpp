// What becomes of a results folder after it was written is noticed: by verify_results() whatever it is, and before
// anything is merged where it is records.

#include "experiment/verify_results.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <map>

#include "experiment/experiment_runs.h"
#include "image/exr.h"
#include "record/run/run_record.h"
#include "tests/support/results.h"
#include "tests/support/two_walls.h"

namespace photonlab {
namespace {

/// A small experiment with everything that a results folder can have.
class VerifyResults : public ::testing::Test {
protected:
    VerifyResults() {
        write_two_walls(folder_, 4);
        folder_.write(
            "tiny.toml",
            "passes = 2\nseeds = 3\nthreads = 1\nsnapshots = [1]\ndecomposition = true\n"
            "photons_per_pass = 200\n"
            "scenes = [{ path = \"walls/scene.xml\", reference = \"reference\", probes = { wall = [6, 2] } }]\n"
            "[[method]]\nintegrator = \"ppm\"\n[[method]]\nintegrator = \"path\"\n");
        run();
        for (const auto& entry : std::filesystem::recursive_directory_iterator(results()))
            if (entry.is_regular_file())
                whole_[entry.path().lexically_relative(results()).string()] = read_text_file(entry.path());
    }

    ExperimentOutcome run(const std::optional<std::string>& only = std::nullopt) {
        const Experiment experiment = read_experiment(folder_ / "tiny.toml");
        return run_experiment(experiment, prepare_experiment(experiment, results(), {only}), results());
    }

    std::filesystem::path results() { return folder_ / "results"; }

    void restore() {
        for (const auto& [name, bytes] : whole_) folder_.write("results/" + name, bytes);
    }

    /// Calls `check` after each way in which a file can be damaged; the folder is whole again afterwards.
    void damage(const std::string& name, std::size_t flips, const std::function<void(const std::string& how)>& check) {
        const std::string whole = whole_.at(name);
        const auto write = [&](const std::string& bytes, const std::string& how) {
            if (bytes == whole) return;
            folder_.write("results/" + name, bytes);
            check(name + ", " + how);
        };
        write("", "emptied");
        write(whole.substr(0, whole.size() / 2), "cut to a half");
        write(whole.substr(0, whole.size() - 1), "without its last byte");
        write(whole + "\n", "longer by a line");
        for (std::size_t i = 0; i < flips; ++i) {
            const std::size_t at = std::min(i * whole.size() / (flips - 1), whole.size() - 1);
            std::string flipped = whole;
            flipped[at] = static_cast<char>(flipped[at] ^ (1 << (i % 8)));
            write(flipped, "flipped at " + std::to_string(at));
        }
        const auto lines = static_cast<std::size_t>(std::count(whole.begin(), whole.end(), '\n'));
        for (const std::size_t line : {std::size_t{0}, std::size_t{1}, lines / 2, lines - 1}) {
            std::size_t begin = 0;
            for (std::size_t i = 0; i < line && i < lines; ++i) begin = whole.find('\n', begin) + 1;
            const std::size_t end = std::min(whole.find('\n', begin), whole.size() - 1) + 1;
            write(whole.substr(0, begin) + whole.substr(end), "without line " + std::to_string(line + 1));
        }
        std::filesystem::remove(results() / name);
        check(name + ", removed");
        folder_.write("results/" + name, whole);
    }

    TestFolder folder_;
    std::map<std::string, std::string> whole_;
};

TEST_F(VerifyResults, AWholeFolderHasNoFault) {
    const Verification found = verify_results(results());
    EXPECT_EQ(found.faults, std::vector<std::string>{});
    EXPECT_EQ(found.notes, std::vector<std::string>{});
    EXPECT_EQ(found.runs, 6u);
    EXPECT_EQ(found.sums, 6u);
    EXPECT_EQ(found.files, whole_.size());  // each of them was looked at
}

TEST_F(VerifyResults, NothingThatBecomesOfAFileIsMissed) {
    std::size_t damages = 0;
    for (const auto& [name, bytes] : whole_)
        damage(name, 9, [&](const std::string& how) {
            ++damages;
            const std::vector<std::string> faults = verify_results(results()).faults;
            // What is gone is named by its folder: by the run whose rows are merged, by the sums that lack a seed.
            const std::filesystem::path file = results() / name;
            const bool is_there = std::filesystem::exists(file);
            const std::string words = is_there ? file.string() + ":" : file.parent_path().filename().string();
            const auto names_it = [&](const std::string& fault) {
                return is_there ? fault.starts_with(words) : fault.find(words) != std::string::npos;
            };
            EXPECT_TRUE(std::any_of(faults.begin(), faults.end(), names_it))
                << how << "; first fault: " << (faults.empty() ? "none" : faults[0]);
        });
    EXPECT_GT(damages, 500u);
}

// Where what is left of a run cannot be trusted, the run is made again; nothing damaged is merged, and no row is lost.
TEST_F(VerifyResults, WhateverBecomesOfRecordsTheyAreMadeWholeAgain) {
    const auto rows = repeatable_rows(results() / "iterations.csv");
    const auto probes = repeatable_rows(results() / "probes.csv");
    for (const auto& [name, bytes] : whole_) {
        if (!name.ends_with(".csv") && !name.ends_with(".json")) continue;
        if (name.starts_with("runs/") && !name.starts_with("runs/walls_ppm_seed-2/")) continue;
        damage(name, 3, [&](const std::string& how) {
            // Whose a folder is, a program does not decide by itself.
            const std::string refusal = message_of([&] { run(); });
            EXPECT_TRUE(refusal.empty() ||
                        (name == "experiment.json" && refusal.find("or remove this file if") != std::string::npos))
                << how << refusal;
            if (!refusal.empty()) return restore();
            EXPECT_EQ(verify_results(results()).faults, std::vector<std::string>{}) << how;
            EXPECT_EQ(repeatable_rows(results() / "iterations.csv"), rows) << how;
            EXPECT_EQ(repeatable_rows(results() / "probes.csv"), probes) << how;
            restore();
        });
    }
}

TEST_F(VerifyResults, AnImageOrASumOfAnotherSizeIsMadeAgain) {
    for (const std::string name :
         {"runs/walls_path_seed-3/snapshots/pass-000001.exr", "ensembles/walls_path/slot-01.exr"}) {
        const std::string whole = whole_.at(name);
        folder_.write("results/" + name, whole.substr(0, whole.size() - 1));
        EXPECT_EQ(run().ran, 1u);
        EXPECT_EQ(read_text_file(results() / name), whole);
        std::filesystem::remove(results() / name);
        EXPECT_EQ(run().ran, 1u);
        EXPECT_EQ(read_text_file(results() / name), whole);
    }
}

// Not selected, it is not made again; but that its rows are missing is said.
TEST_F(VerifyResults, ADamagedRunThatIsNotSelectedIsNamed) {
    folder_.write("results/runs/walls_ppm_seed-2/probes.csv", "");
    const ExperimentOutcome outcome = run("walls_path_*");
    ASSERT_EQ(outcome.merged->faults.size(), 1u);
    EXPECT_NE(outcome.merged->faults[0].find("walls_ppm_seed-2/probes.csv: has 0 bytes, and had "), std::string::npos);
    EXPECT_EQ(outcome.merged->runs, 5u);
}

TEST_F(VerifyResults, ForeignFilesAreNamed) {
    const std::map<std::string, std::string> foreign{
        {"runs/walls_ppm_seed-1/notes.txt", "is no file of this run"},
        {"runs/walls_ppm_seed-1/snapshots/pass-000000.exr", "is no file of this run"},
        {"runs/table.csv", "is no folder of a run"},
        {"ensembles/walls_ppm/slot-99.exr", "is no sum over seeds"},
        {"ensembles/walls_ppm/slot--1.exr", "is no sum over seeds"},
        {"ensembles/walls_ppm/slot-0.exr", "is no sum over seeds"},
        {"ensembles/other", "is no folder of sums over seeds"}};
    for (const auto& [name, what] : foreign) {
        folder_.write("results/" + name, "1");
        EXPECT_EQ(verify_results(results()).faults,
                  std::vector<std::string>{(results() / name).string() + ": " + what});
        std::filesystem::remove(results() / name);
    }
    // What an analysis puts beside the records is nobody's business here.
    folder_.write("results/report.html", "1");
    folder_.write("results/decomposition/walls_ppm/pass-000002.exr", "1");
    EXPECT_EQ(verify_results(results()).faults, std::vector<std::string>{});
}

TEST_F(VerifyResults, FilesOfOtherRunsAndSumsAreNamed) {
    const auto swapped = [&](const std::string& a, const std::string& b) {
        folder_.write("results/" + a, whole_.at(b));
        const std::vector<std::string> faults = verify_results(results()).faults;
        folder_.write("results/" + a, whole_.at(a));
        return faults.empty() ? "" : faults[0];
    };
    EXPECT_NE(swapped("runs/walls_ppm_seed-1/run.json", "runs/walls_ppm_seed-2/run.json")
                  .find("is of the run walls_ppm_seed-2, which is not called as its folder"),
              std::string::npos);
    EXPECT_NE(swapped("ensembles/walls_ppm/slot-00.exr", "ensembles/walls_path/slot-00.exr")
                  .find("slot-00.exr: is of other settings"),
              std::string::npos);
    EXPECT_NE(swapped("ensembles/walls_ppm/slot-01.exr", "ensembles/walls_ppm/slot-00.exr")
                  .find("slot-01.exr: holds the seed 1, which slot-00.exr holds as well"),
              std::string::npos);
}

// The records of before a run was added are whole, and known to lack it.
TEST_F(VerifyResults, WhatIsNotFinishedOrNotMergedIsNoted) {
    std::filesystem::remove_all(results());
    run("walls_ppm_seed-1");
    const std::string records = read_text_file(results() / "iterations.csv");
    const std::string description = read_text_file(results() / "merged.json");
    const std::string probes = read_text_file(results() / "probes.csv");
    run("walls_ppm_*");
    folder_.write("results/iterations.csv", records);
    folder_.write("results/probes.csv", probes);
    folder_.write("results/merged.json", description);
    folder_.write("results/runs/walls_path_seed-1/iterations.csv", "half");
    const Verification found = verify_results(results());
    EXPECT_EQ(found.faults, std::vector<std::string>{});
    EXPECT_EQ(found.notes, (std::vector<std::string>{
                               (results() / "iterations.csv").string() +
                                   ": lacks the rows of 2 finished runs: not merged yet, or not of the experiment any "
                                   "more",
                               (results() / "runs").string() + ": 1 runs are not finished"}));
}

TEST_F(VerifyResults, AReferenceThatIsDamagedIsAFaultAndOneThatIsElsewhereIsNoted) {
    const std::string half = read_text_file(folder_ / "reference/half_b.exr");
    folder_.write("reference/half_b.exr", half.substr(0, half.size() - 1));
    const std::vector<std::string> faults = verify_results(results()).faults;
    ASSERT_EQ(faults.size(), 1u);
    EXPECT_NE(faults[0].find("half_b.exr: is not the file that reference.json was written for"), std::string::npos);
    std::filesystem::remove_all(folder_ / "reference");
    const Verification found = verify_results(results());
    EXPECT_EQ(found.faults, std::vector<std::string>{});
    ASSERT_EQ(found.notes.size(), 1u);
    EXPECT_NE(found.notes[0].find("the reference of walls_p"), std::string::npos);
}

TEST_F(VerifyResults, AFolderWithoutResultsIsRefused) {
    EXPECT_NE(message_of([&] { verify_results(folder_ / "walls"); }).find("walls: holds no results"),
              std::string::npos);
    EXPECT_NE(message_of([&] { verify_results(folder_ / "tiny.toml"); }).find("tiny.toml: is no folder"),
              std::string::npos);
}

}  // namespace
}  // namespace photonlab
