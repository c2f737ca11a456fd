// Experiments that are interrupted and continued leave what uninterrupted ones leave, to the bit.

#include "experiment/run_group.h"

#include <gtest/gtest.h>

#include <set>

#include "core/machine/host.h"
#include "experiment/experiment_runs.h"
#include "reference/reference_store.h"
#include "tests/support/results.h"
#include "tests/support/two_walls.h"

namespace photonlab {
namespace {

class InterruptedExperiment : public ::testing::Test {
protected:
    InterruptedExperiment() {
        write_two_walls(folder_, 16);
        folder_.write("tiny.toml",
                      "title = \"Does it go on?\"\npasses = 6\nsnapshots = [1, 5]\n" + every_method_on_two_walls);
    }

    ExperimentOutcome run(const std::string& results, const ContinuationOptions& options = {},
                          const std::optional<std::string>& only = std::nullopt) {
        const Experiment experiment = read_experiment(folder_ / "tiny.toml");
        return run_experiment(experiment, prepare_experiment(experiment, folder_ / results, {only}), folder_ / results,
                              options);
    }

    /// Interrupts when it is asked for this time: before each group, and after each of its passes but the last.
    ContinuationOptions interrupted_after(int times) {
        return {.seconds_between_saves = 1e9, .is_interrupted = [left = times]() mutable { return --left == 0; }};
    }

    TestFolder folder_;
};

TEST_F(InterruptedExperiment, LeavesTheSameBits) {
    run("whole");
    int interruptions = 0;
    while (run("cut", interrupted_after(1 + interruptions % 8)).is_interrupted) ++interruptions;
    EXPECT_GT(interruptions, 12);
    EXPECT_EQ(difference_of_results(folder_ / "whole", folder_ / "cut"), "");
    EXPECT_EQ(difference_of_results(folder_ / "cut", folder_ / "whole"), "");
}

// A kill between the saves of two runs that share photons, or another choice of runs, leaves them at different passes.
TEST_F(InterruptedExperiment, GoesOnFromDifferentPasses) {
    run("whole");
    EXPECT_TRUE(run("cut", interrupted_after(4), "*hachisuka*").is_interrupted);
    EXPECT_TRUE(run("cut", interrupted_after(2), "*fixed*").is_interrupted);
    EXPECT_TRUE(run("cut", interrupted_after(3)).is_interrupted);
    EXPECT_FALSE(run("cut").is_interrupted);
    EXPECT_EQ(difference_of_results(folder_ / "whole", folder_ / "cut"), "");
    EXPECT_EQ(difference_of_results(folder_ / "cut", folder_ / "whole"), "");
}

TEST_F(InterruptedExperiment, KeepsTheTimeThatItTook) {
    EXPECT_TRUE(run("cut", interrupted_after(5), "*path*seed-1").is_interrupted);
    const std::string before = read_text_file(folder_ / "cut/runs/walls_path_seed-1/iterations.csv");
    run("cut", {}, "*path*seed-1");
    const std::string after = read_text_file(folder_ / "cut/runs/walls_path_seed-1/iterations.csv");
    EXPECT_EQ(after.substr(0, before.size()), before);
    double seconds = 0.0;
    for (const auto& row : read_rows(folder_ / "cut/runs/walls_path_seed-1/iterations.csv")) {
        if (row.at("pass") == "0") continue;
        EXPECT_GE(std::stod(row.at("seconds")), seconds);
        seconds = std::stod(row.at("seconds"));
    }
}

TEST_F(InterruptedExperiment, SaysWhoMadeItUpToWhichPass) {
    EXPECT_TRUE(run("cut", interrupted_after(5), "*path*seed-1").is_interrupted);
    run("cut", {}, "*path*seed-1");
    const Json json = Json::parse(read_text_file(folder_ / "cut/runs/walls_path_seed-1/run.json"));
    EXPECT_EQ(json.at("resumed"), 1);
    ASSERT_EQ(json.at("sessions").size(), 2u);
    EXPECT_EQ(json.at("sessions")[0].at("until_pass"), 4);
    EXPECT_EQ(json.at("sessions")[1].at("until_pass"), json.at("passes"));
    EXPECT_EQ(json.at("sessions")[1].at("host"), host_name());
    EXPECT_EQ(json.at("sessions")[1].at("processor"), json.at("processor"));
    EXPECT_TRUE(json.at("sessions")[1].at("job").is_null());
}

TEST_F(InterruptedExperiment, RefusesADamagedCheckpointBeforeAnythingIsRunAndBeginsAnewBesideIt) {
    run("whole");
    EXPECT_TRUE(run("cut", interrupted_after(3)).is_interrupted);
    const std::filesystem::path file = folder_ / "cut/runs/walls_nearest_seed-1/checkpoint";
    ASSERT_TRUE(std::filesystem::exists(file));
    std::filesystem::resize_file(file, 100);
    EXPECT_EQ(message_of([&] { run("cut"); }),
              file.string() +
                  ": is damaged or truncated: its checksum is not that of its content; remove it, or begin anew beside "
                  "it with --fresh");
    EXPECT_EQ(std::filesystem::file_size(file), 100u);

    EXPECT_FALSE(run("cut", {.fresh = true}).is_interrupted);
    EXPECT_EQ(std::filesystem::file_size(file.string() + ".old"), 100u);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "cut"))
        if (entry.path().extension() == ".old") std::filesystem::remove(entry.path());
    EXPECT_EQ(difference_of_results(folder_ / "whole", folder_ / "cut"), "");
}

TEST_F(InterruptedExperiment, RefusesTheCheckpointOfOtherSettings) {
    EXPECT_TRUE(run("cut", interrupted_after(3)).is_interrupted);
    std::string text = read_text_file(folder_ / "tiny.toml");
    text.replace(text.find("k = 20"), 6, "k = 21");
    folder_.write("tiny.toml", text);
    EXPECT_NE(message_of([&] { run("cut"); }).find("walls_nearest_seed-1/checkpoint: is of another run"),
              std::string::npos);
}

TEST_F(InterruptedExperiment, SavesAfterEveryPassThatTakesLongerThanTheSeconds) {
    std::set<std::filesystem::file_time_type> times;
    ContinuationOptions options{.seconds_between_saves = 0.0};
    options.is_interrupted = [&] {
        const auto file = folder_ / "cut/runs/walls_path_seed-1/checkpoint";
        if (std::filesystem::exists(file)) times.insert(std::filesystem::last_write_time(file));
        return false;
    };
    run("cut", options, "*path*seed-1");
    EXPECT_EQ(times.size(), 4u);  // asked after passes 1 to 5, before it is saved
}

// Whoever took the lock makes the run by now, even where one pass is all that is missing.
TEST_F(InterruptedExperiment, WritesNothingMoreOnceItsLockIsGone) {
    ContinuationOptions options;
    int asked = 0;
    options.is_interrupted = [&] {
        if (++asked == 6) std::filesystem::remove(folder_ / "cut/runs/walls_path_seed-1/lock");  // after pass 5 of 6
        return false;
    };
    EXPECT_NE(message_of([&] { run("cut", options, "*path*seed-1"); }).find("lock: was removed, or taken by another"),
              std::string::npos);
    EXPECT_EQ(asked, 6);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "cut/runs/walls_path_seed-1/run.json"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "cut/iterations.csv"));
}

// It was written before the checkpoint, and nothing would write it again.
TEST_F(InterruptedExperiment, ASnapshotThatIsGoneMakesItsRunBeginAnew) {
    run("whole");
    for (const bool is_removed : {true, false}) {
        std::filesystem::remove_all(folder_ / "cut");
        EXPECT_TRUE(run("cut", interrupted_after(4), "*path*seed-1").is_interrupted);
        const std::filesystem::path file = folder_ / "cut/runs/walls_path_seed-1/snapshots/pass-000001.exr";
        std::string image = read_text_file(file);
        image.back() = static_cast<char>(image.back() ^ 1);
        std::filesystem::remove(file);
        if (!is_removed) write_text_file(file, image);
        const std::string message = message_of([&] { run("cut", {}, "*path*seed-1"); });
        EXPECT_TRUE(message.starts_with(file.string() + ": ")) << message;
        EXPECT_TRUE(message.ends_with("; its run begins anew the next time")) << message;
        run("cut");
        EXPECT_EQ(difference_of_results(folder_ / "whole", folder_ / "cut"), "");
    }
}

}  // namespace
}  // namespace photonlab
