// An experiment as jobs of many: groups by number, none of which waits or merges, and a command that merges.

#include "experiment/file/experiment_file.h"
#include "tests/app/shared_folder.h"

namespace photonlab {
namespace {

class ManyJobs : public SharedFolder {
protected:
    std::vector<std::string> job(const std::string& groups) const {
        std::vector<std::string> command = run_into("shared");
        command.insert(command.end(), {"--group", groups, "--no-merge"});
        return command;
    }
    std::string shared(const std::string& name = "") const { return (folder_ / "shared" / name).string(); }
};

TEST_F(ManyJobs, LeaveMergedWhatOneProcessLeaves) {
    std::string said;
    ASSERT_EQ(run_program(run_into("whole"), said), 0) << said;
    const std::size_t groups = read_experiment(folder_ / "tiny.toml").group_count();
    for (std::size_t group = groups; group > 0; --group)
        ASSERT_EQ(run_program(job(std::to_string(group)), said), 0) << said;
    EXPECT_FALSE(std::filesystem::exists(shared("iterations.csv")));
    ASSERT_EQ(run_program({"merge", shared()}, said), 0) << said;
    EXPECT_NE(said.find("iterations.csv: "), std::string::npos) << said;
    EXPECT_EQ(difference_of_results(folder_ / "whole", folder_ / "shared"), "");
    EXPECT_EQ(difference_of_results(folder_ / "shared", folder_ / "whole"), "");
}

TEST_F(ManyJobs, LeaveToAnotherProcessWhatItIsMakingAndSayWhose) {
    std::string said;
    ASSERT_EQ(run_program(job("2"), said), 0) << said;
    const auto lock = FileLock::try_lock(shared("runs/walls_path_seed-1/lock"));
    ASSERT_TRUE(lock);
    EXPECT_EQ(run_program(job("1"), said), 4) << said;
    EXPECT_NE(said.find(fmt::format("1 runs were left to other processes, which are making them, the first "
                                    "walls_path_seed-1, by process {} on ",
                                    ::getpid())),
              std::string::npos)
        << said;
    EXPECT_TRUE(std::filesystem::exists(shared("runs/walls_fixed_seed-1/run.json")));
    EXPECT_FALSE(std::filesystem::exists(shared("runs/walls_path_seed-1/run.json")));
}

// The file system gives the lock away, but its file is touched by somebody: that one is at work.
TEST_F(ManyJobs, LeaveToAnotherMachineWhatItIsMaking) {
    std::string said;
    ASSERT_EQ(run_program(job("2"), said), 0) << said;
    std::filesystem::create_directories(shared("runs/walls_path_seed-1"));
    std::ofstream(shared("runs/walls_path_seed-1/lock"))
        << R"({"photonlab": "lock", "host": "n17", "process": 4711, "boot": "another", "nonce": "0"})";
    const auto began = std::chrono::steady_clock::now();
    Program program(job("1"), folder_ / "messages");
    while (program.messages().find("gives the lock away") == std::string::npos && program.is_running())
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
    ASSERT_TRUE(program.is_running()) << program.messages();
    std::filesystem::last_write_time(shared("runs/walls_path_seed-1/lock"),
                                     std::filesystem::file_time_type::clock::now());
    EXPECT_EQ(program.wait(), 4) << program.messages();
    EXPECT_NE(program.messages().find("walls_path_seed-1, by process 4711 on n17"), std::string::npos)
        << program.messages();
    EXPECT_LT(std::chrono::steady_clock::now() - began, std::chrono::duration<double>(lease_seconds));
}

TEST_F(ManyJobs, EndSavedAtASignalAndGoOn) {
    std::string said;
    ASSERT_EQ(run_program(run_into("whole"), said), 0) << said;
    Program program(job("1-2"), folder_ / "messages");
    ASSERT_TRUE(program.wait_for(shared("runs/walls_fixed_seed-1/checkpoint")));
    program.send(SIGTERM);
    EXPECT_EQ(program.wait(), 3) << program.messages();
    ASSERT_EQ(run_program(run_into("shared"), said), 0) << said;
    EXPECT_EQ(difference_of_results(folder_ / "whole", folder_ / "shared"), "");
    const Json json = Json::parse(read_text_file(shared("runs/walls_fixed_seed-1/run.json")));
    EXPECT_EQ(json.at("resumed"), 1);
}

TEST_F(ManyJobs, AreMergedByTheExperimentThatTheFolderNames) {
    std::string said;
    EXPECT_EQ(run_program({"merge", (folder_ / "nothing").string()}, said), 2);
    EXPECT_NE(said.find("nothing: is no folder"), std::string::npos) << said;
    ASSERT_EQ(run_program(job("1"), said), 0) << said;
    std::filesystem::create_directory(folder_ / "moved");
    std::filesystem::rename(folder_ / "tiny.toml", folder_ / "tiny.toml.away");
    EXPECT_EQ(run_program({"merge", shared()}, said), 2);
    EXPECT_NE(said.find("tiny.toml: is not there, and "), std::string::npos) << said;
    EXPECT_NE(said.find("say where it is with --experiment"), std::string::npos) << said;
    std::filesystem::rename(folder_ / "tiny.toml.away", folder_ / "tiny.toml");
    ASSERT_EQ(run_program({"merge", shared(), "--experiment", (folder_ / "tiny.toml").string()}, said), 0) << said;
}

TEST_F(ManyJobs, AreListedAsJson) {
    std::string said;
    std::vector<std::string> command = run_into("shared");
    command.insert(command.end(), {"--list", "--json"});
    ASSERT_EQ(run_program(command, said), 0) << said;
    const Json list = Json::parse(said);
    EXPECT_EQ(list.at("groups").size(), read_experiment(folder_ / "tiny.toml").group_count());
    EXPECT_EQ(list.at("runs")[0].at("state"), "unfinished");
    EXPECT_FALSE(std::filesystem::exists(shared()));
}

TEST_F(ManyJobs, AreRefusedGroupsThatThereAreNot) {
    std::string said;
    for (const char* groups : {"0", "2-1", "x", "1-", "-1", "1-2-3"}) {
        EXPECT_EQ(run_program(job(groups), said), 2) << groups;
        EXPECT_NE(said.find("--group: expected a group, as 3, or a range of them, as 3-8, got "), std::string::npos)
            << said;
    }
    EXPECT_EQ(run_program(job("1000"), said), 2);
    EXPECT_NE(said.find("--group: expected groups from 1 to "), std::string::npos) << said;
    EXPECT_FALSE(std::filesystem::exists(shared()));
}

}  // namespace
}  // namespace photonlab
