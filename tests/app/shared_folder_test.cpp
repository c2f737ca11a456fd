// Two of the program on one results folder, each with process ids of its own.

#include "tests/app/shared_folder.h"

namespace photonlab {
namespace {

TEST_F(SharedFolder, IsMadeOnceByProcessesOfOneId) {
    if (!has_own_process_ids()) GTEST_SKIP() << "unshare -pf --mount-proc is not allowed here";
    constexpr int runs = 60;
    write_tiny_runs(runs);
    WatchedTable table(folder_ / "shared/iterations.csv");
    make_them_together(4, 400.0, 2008);
    table.stop();
    EXPECT_EQ(table.fault(), "");
    EXPECT_GT(table.reads(), 0u);
    EXPECT_EQ(leftovers(), "");
    expect_all_made(runs);
}

TEST_F(SharedFolder, ThatIsLockedIsLeftAtTheFirstSignal) {
    const auto lock = FileLock::try_lock(folder_ / "shared/lock");
    ASSERT_TRUE(lock);
    Program program(run_into("shared"), folder_ / "messages");
    while (program.is_running() && program.messages().find("memory: ") == std::string::npos)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    program.send(SIGINT);
    EXPECT_EQ(program.wait(), 3) << program.messages();
    EXPECT_FALSE(std::filesystem::exists(folder_ / "shared/runs"));
}

// Its images wait for the sums of others, and nothing of what was rendered is lost.
TEST_F(SharedFolder, WhoseSumsAreLockedIsLeftAtTheFirstSignalWithWhatWasRendered) {
    std::string said;
    ASSERT_EQ(run_program(run_into("whole"), said), 0) << said;
    std::vector<std::string> command = run_into("shared");
    command.insert(command.end(), {"--only", "walls_fixed_seed-1"});
    ASSERT_EQ(run_program(command, said), 0) << said;
    auto lock = FileLock::try_lock(folder_ / "shared/ensembles/walls_path.lock");
    ASSERT_TRUE(lock);
    command = run_into("shared");
    command.back() = "1000000";  // seconds between checkpoints
    command.insert(command.end(), {"--only", "walls_path_seed-1"});
    Program program(command, folder_ / "messages");
    const std::filesystem::path rows = folder_ / "shared/runs/walls_path_seed-1/iterations.csv";
    const auto is_rendered = [&] { return std::filesystem::exists(rows) && read_rows(rows).back().at("pass") == "24"; };
    while (program.is_running() && !is_rendered()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    program.send(SIGTERM);
    EXPECT_EQ(program.wait(), 3) << program.messages();
    EXPECT_NE(program.messages().find("interrupted, and saved"), std::string::npos) << program.messages();
    EXPECT_TRUE(std::filesystem::exists(rows.parent_path() / "checkpoint"));
    const std::string rendered = read_text_file(rows);
    lock.reset();
    ASSERT_EQ(run_program(run_into("shared"), said), 0) << said;
    EXPECT_EQ(read_text_file(rows), rendered);
    EXPECT_EQ(difference_of_results(folder_ / "whole", folder_ / "shared"), "");
}

TEST_F(SharedFolder, IsRefusedToAnotherExperimentWithNothingWritten) {
    folder_.write("mine/iterations.csv", "step,loss\n1,0.5\n");
    std::string said;
    EXPECT_EQ(run_program(run_into("mine"), said), 2);
    EXPECT_NE(said.find("mine/iterations.csv: is there already, and is no table of the experiment \"tiny\"; choose "
                        "another folder for the results"),
              std::string::npos)
        << said;
    EXPECT_EQ(read_text_file(folder_ / "mine/iterations.csv"), "step,loss\n1,0.5\n");
    EXPECT_EQ(
        std::distance(std::filesystem::directory_iterator(folder_ / "mine"), std::filesystem::directory_iterator()), 1);
}

}  // namespace
}  // namespace photonlab
