// Signals, and two of the program on one folder.

#include <set>

#include "tests/app/program.h"
#include "tests/support/results.h"

namespace photonlab {
namespace {

class StoppedProgram : public ProgramTest {
protected:
    /// Two processes add seeds to the sums in the order in which they finish them; everything else is the same.
    void expect_same_but_for_slots(const std::string& whole, const std::string& shared) {
        EXPECT_EQ(difference_of_results(folder_ / whole / "runs", folder_ / shared / "runs"), "");
        EXPECT_EQ(difference_of_results(folder_ / shared / "runs", folder_ / whole / "runs"), "");
        for (const char* table : {"iterations.csv", "probes.csv"})
            EXPECT_EQ(repeatable_rows(folder_ / whole / table), repeatable_rows(folder_ / shared / table));
        for (const auto& point : std::filesystem::directory_iterator(folder_ / shared / "ensembles")) {
            std::multiset<std::string> seeds;
            for (const char* slot : {"slot-00.exr", "slot-01.exr"})
                seeds.insert(read_exr_metadata(point.path() / slot)["photonlab.seeds"]);
            EXPECT_EQ(seeds, (std::multiset<std::string>{"1", "2"})) << point.path();
            EXPECT_FALSE(std::filesystem::exists(point.path() / "slot-02.exr"));
        }
    }
};

TEST_F(StoppedProgram, RenderFinishesThePassSavesAndEndsWithThree) {
    std::string said;
    ASSERT_EQ(run_program(render_into("whole", 400), said), 0) << said;
    Program program(render_into("cut", 400), folder_ / "messages");
    ASSERT_TRUE(program.wait_for(folder_ / "cut.checkpoint")) << program.messages();
    program.send(SIGINT);
    EXPECT_EQ(program.wait(), 3);
    EXPECT_NE(program.messages().find("is saved, and --resume goes on from it"), std::string::npos)
        << program.messages();
    EXPECT_FALSE(std::filesystem::exists(folder_ / "cut.exr"));
    ASSERT_EQ(run_program(render_into("cut", 400), said), 0) << said;
    EXPECT_EQ(difference_of_images(folder_ / "whole.exr", folder_ / "cut.exr"), "");
    EXPECT_EQ(difference_of_images(folder_ / "whole-pass-7.exr", folder_ / "cut-pass-7.exr"), "");
    EXPECT_EQ(repeatable_rows(folder_ / "whole.csv"), repeatable_rows(folder_ / "cut.csv"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "cut.checkpoint"));
}

TEST_F(StoppedProgram, RunFinishesThePassSavesAndEndsWithThree) {
    std::string said;
    ASSERT_EQ(run_program(run_into("whole"), said), 0) << said;
    Program program(run_into("cut"), folder_ / "messages");
    ASSERT_TRUE(program.wait_for(folder_ / "cut/runs/walls_fixed_seed-1/checkpoint")) << program.messages();
    program.send(SIGTERM);
    EXPECT_EQ(program.wait(), 3) << program.messages();
    ASSERT_EQ(run_program(run_into("cut"), said), 0) << said;
    EXPECT_EQ(difference_of_results(folder_ / "whole", folder_ / "cut"), "");
    EXPECT_EQ(difference_of_results(folder_ / "cut", folder_ / "whole"), "");
}

TEST_F(StoppedProgram, ReferenceSavesAndEndsWithThree) {
    const std::vector<std::string> command{"reference", (folder_ / "walls/scene.xml").string(),
                                           "-o",        (folder_ / "growing").string(),
                                           "--threads", "1",
                                           "--samples", "1000000"};
    Program program(command, folder_ / "messages");
    ASSERT_TRUE(program.wait_for(folder_ / "growing/lock")) << program.messages();
    std::string said;
    Program second(command, folder_ / "more messages");
    EXPECT_EQ(second.wait(), 4);
    EXPECT_NE(second.messages().find("growing: another process is adding samples to this reference"), std::string::npos)
        << second.messages();
    program.send(SIGINT);
    EXPECT_EQ(program.wait(), 3) << program.messages();
    const Json json = read_reference_json(folder_ / "growing");
    EXPECT_GE(json.at("samples_per_half").get<int>(), 1);
    for (const char* half : {"half_a", "half_b"}) read_reference_half(folder_ / "growing", json, half);
}

TEST_F(StoppedProgram, ASecondSignalEndsItAtOnce) {
    // A pass that takes days.
    const std::vector<std::string> command{"render",
                                           (folder_ / "walls/scene.xml").string(),
                                           "-o",
                                           (folder_ / "never.exr").string(),
                                           "--direct-samples",
                                           "2000000000",
                                           "--threads",
                                           "1"};
    bool is_heard = false;
    for (int delay = 50; !is_heard; delay *= 2) {  // before it listens, one signal ends it
        Program program(command, folder_ / "messages");
        std::this_thread::sleep_for(std::chrono::milliseconds(delay));
        program.send(SIGINT);
        while (program.is_running() && !is_heard)
            is_heard = program.messages().find("once more ends it at once") != std::string::npos;
        if (is_heard) program.send(SIGINT);
        EXPECT_EQ(program.wait(), -SIGINT);
    }
}

// A queueing system that ends a job tells the program, and so does the script that runs it.
TEST_F(StoppedProgram, ATerminationToldTwiceIsOne) {
    Program program(render_into("cut", 100000), folder_ / "messages");
    ASSERT_TRUE(program.wait_for(folder_ / "cut.checkpoint")) << program.messages();
    program.send(SIGTERM);
    program.send(SIGTERM);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    if (program.is_running()) program.send(SIGTERM);
    EXPECT_EQ(program.wait(), 3) << program.messages();
}

TEST_F(StoppedProgram, TwoOfItShareTheRunsOfOneFolder) {
    std::string said;
    ASSERT_EQ(run_program(run_into("whole"), said), 0) << said;
    Program first(run_into("shared"), folder_ / "first messages");
    Program second(run_into("shared"), folder_ / "second messages");
    EXPECT_EQ(first.wait(), 0) << first.messages();
    EXPECT_EQ(second.wait(), 0) << second.messages();
    expect_same_but_for_slots("whole", "shared");
    const auto finished = [](const std::string& messages) {
        std::size_t count = 0;
        for (std::size_t at = 0; (at = messages.find("finished walls_", at)) != std::string::npos; ++at) ++count;
        return count;
    };
    EXPECT_EQ(finished(first.messages()) + finished(second.messages()), 14u);
}

// The other process is killed, and what it was making is made by the one that waited.
TEST_F(StoppedProgram, WhatAKilledProcessWasMakingIsMadeByTheOther) {
    std::string said;
    ASSERT_EQ(run_program(run_into("whole"), said), 0) << said;
    Program first(run_into("shared"), folder_ / "first messages");
    ASSERT_TRUE(first.wait_for(folder_ / "shared/runs/walls_fixed_seed-1/lock"));
    Program second(run_into("shared"), folder_ / "second messages");
    first.send(SIGKILL);
    first.wait();
    EXPECT_EQ(second.wait(), 0) << second.messages();
    expect_same_but_for_slots("whole", "shared");
}

TEST_F(StoppedProgram, TwoRendersDoNotShareACheckpoint) {
    Program first(render_into("one", 100000), folder_ / "first messages");
    ASSERT_TRUE(first.wait_for(folder_ / "one.checkpoint")) << first.messages();
    std::string said;
    EXPECT_EQ(run_program(render_into("one", 100000), said), 4);
    EXPECT_NE(said.find("one.checkpoint: another process is rendering with this checkpoint"), std::string::npos)
        << said;
}

TEST_F(StoppedProgram, RefusesACheckpointOfOtherSettingsAndOneThatIsThereUnasked) {
    {
        Program program(render_into("one", 100000), folder_ / "messages");
        ASSERT_TRUE(program.wait_for(folder_ / "one.checkpoint"));
        program.send(SIGTERM);
        EXPECT_EQ(program.wait(), 3);
    }
    std::string said;
    EXPECT_EQ(run_program(render_into("one", 7), said), 2);
    EXPECT_NE(said.find("one.checkpoint: is of another run"), std::string::npos) << said;
    std::vector<std::string> unasked = render_into("one", 100000);
    unasked.pop_back();
    EXPECT_EQ(run_program(unasked, said), 2);
    EXPECT_NE(said.find("one.checkpoint: is there already: --resume goes on from it"), std::string::npos) << said;
    std::filesystem::resize_file(folder_ / "one.checkpoint", 5);
    EXPECT_EQ(run_program(render_into("one", 100000), said), 2);
    EXPECT_NE(said.find("one.checkpoint: is no checkpoint of photonlab"), std::string::npos) << said;
}

}  // namespace
}  // namespace photonlab
