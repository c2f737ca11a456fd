// Standard output and standard error that are closed, full, or pipes whose reader has left: the work is done and its
// files are whole, and an answer that did not arrive is exit code 2.

#include <array>
#include <cstdlib>

#include "tests/app/program.h"

namespace photonlab {
namespace {

struct Command {
    std::string words;
    std::string file;  ///< that it writes, if it does
};

class Streams : public ProgramTest {
protected:
    Streams() {
        folder_.write(
            "small.toml",
            "scenes = ['walls/scene.xml']\npasses = 2\nphotons_per_pass = 300\n[[method]]\nintegrator = 'ppm'\n");
    }

    /// The exit code of `photonlab WORDS REDIRECTION` in bash; `said` is what went to messages_file().
    int code_of(const std::string& words, const std::string& redirection) const {
        const std::string command = "bash -c 'cd \"" + folder_.path().string() + "\" && " + PHOTONLAB_PROGRAM + " " +
                                    words + " " + redirection + "'";
        const int status = std::system(command.c_str());
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

    /// True if what the command writes, if it writes anything, is there; it is removed.
    bool wrote_and_removes(const Command& command) const {
        return command.file.empty() || std::filesystem::remove(folder_ / command.file);
    }

    const std::array<Command, 8> commands_{
        {{"render walls/scene.xml -o image.exr --passes 2 --photons 300", "image.exr"},
         {"run small.toml -o results", "results/iterations.csv"},
         {"reference walls/scene.xml -o grown --samples 2", "grown/reference.json"},
         {"compare reference/half_a.exr reference", ""},
         {"info walls/scene.xml", ""},
         {"run small.toml -o none --list", ""},
         {"--help", ""},
         {"--version", ""}}};
};

TEST_F(Streams, MessagesThatCannotBeWrittenAreLostAndNothingElse) {
    for (const std::string redirection : {">out 2>/dev/full", ">out 2>&-", "2>&- >out <&-"})
        for (const Command& command : commands_) {
            std::filesystem::remove_all((folder_ / command.file).parent_path() / "results");
            EXPECT_EQ(code_of(command.words, redirection), 0) << command.words << " " << redirection;
            EXPECT_GT(std::filesystem::file_size(folder_ / "out"), 0u) << command.words << " " << redirection;
            EXPECT_TRUE(wrote_and_removes(command)) << command.words << " " << redirection;
        }
    EXPECT_EQ(code_of("nonsense", "2>/dev/full"), 2);
    EXPECT_EQ(code_of("nonsense", "2>&- >&- <&-"), 2);
}

TEST_F(Streams, AnAnswerThatCannotBeWrittenIsAnErrorWhenAllWorkIsDone) {
    for (const auto& [redirection, reason] :
         std::vector<std::pair<std::string, std::string>>{{">/dev/full", "No space left on device"},
                                                          {">&-", "Bad file descriptor"},
                                                          {"<&- >&-", "Bad file descriptor"}})
        for (const Command& command : commands_) {
            EXPECT_EQ(code_of(command.words, redirection + " 2>messages"), 2) << command.words << " " << redirection;
            EXPECT_TRUE(read_text_file(folder_ / "messages")
                            .ends_with("photonlab: standard output: cannot be written: " + reason + "\n"))
                << command.words << " " << redirection << "\n"
                << read_text_file(folder_ / "messages");
            EXPECT_TRUE(wrote_and_removes(command)) << command.words << " " << redirection;
        }
}

TEST_F(Streams, AReaderThatLeavesEndsNoWork) {
    for (const Command& command : commands_) {
        // `true` reads nothing and is gone when the first line comes.
        EXPECT_EQ(code_of(command.words, "2>messages | true; exit ${PIPESTATUS[0]}") | 2, 2) << command.words;
        EXPECT_EQ(code_of(command.words, "2> >(true) | true; exit ${PIPESTATUS[0]}") | 2, 2) << command.words;
        EXPECT_TRUE(wrote_and_removes(command)) << command.words;
    }
}

// What the program opens while its standard streams are closed must not become one of them.
TEST_F(Streams, ClosedOnesAreNotTakenByFiles) {
    EXPECT_EQ(code_of("render walls/scene.xml -o closed.exr --passes 3 --photons 300 --csv closed.csv --checkpoint c "
                      "--checkpoint-seconds 0",
                      "<&- >&- 2>&-"),
              2);
    EXPECT_EQ(code_of("render walls/scene.xml -o open.exr --passes 3 --photons 300 --csv open.csv --checkpoint c "
                      "--checkpoint-seconds 0",
                      ">messages"),
              0);
    EXPECT_EQ(read_text_file(folder_ / "closed.exr"), read_text_file(folder_ / "open.exr"));
    EXPECT_EQ(read_text_file(folder_ / "closed.csv").substr(0, 7), "schema,");
}

}  // namespace
}  // namespace photonlab
