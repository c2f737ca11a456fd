// `new` writes a study whose files are read by the other commands; `analyse` and `figure` go on as the analysis, in a
// Python that has what it needs, and say which.

#include <sys/stat.h>

#include <cstdlib>

#include "tests/app/program.h"

namespace photonlab {
namespace {

class Study : public ProgramTest {
protected:
    /// A python3 in a folder of its own, which answers with `line` whatever it is asked and ends with `code`.
    std::string folder_of_python(const std::string& name, const std::string& line, int code) {
        std::filesystem::create_directory(folder_ / name);
        write_text_file(folder_ / name / "python3",
                        "#!/bin/sh\necho '" + line + "'\nexit " + std::to_string(code) + "\n");
        ::chmod((folder_ / name / "python3").c_str(), 0755);
        return (folder_ / name).string();
    }

    std::string said_;
};

TEST_F(Study, HasAnExperimentThatIsReadAndAPageOfFiveCommands) {
    const std::filesystem::path study = folder_ / "a 'study'";
    ASSERT_EQ(run_program({"new", study.string() + "/"}, said_), 0) << said_;
    EXPECT_EQ(run_program({"info", (study / "scene.xml").string()}, said_), 0) << said_;
    EXPECT_EQ(said_.find("warning"), std::string::npos) << said_;
    EXPECT_EQ(run_program(
                  {"reference", (study / "scene.xml").string(), "-o", (study / "reference").string(), "--samples", "1"},
                  said_),
              0)
        << said_;
    EXPECT_EQ(run_program({"run", (study / "study.toml").string(), "--list"}, said_), 0) << said_;
    const std::string page = read_text_file(study / "README.md");
    EXPECT_EQ(page.find('@'), std::string::npos) << page;
    std::size_t commands = 0;
    for (std::size_t at = 0; (at = page.find("\n    ", at)) != std::string::npos; ++at) ++commands;
    EXPECT_EQ(commands, 5u) << page;
    // As a shell reads it, the first of them runs.
    const std::size_t begin = page.find("\n    ") + 5;
    const std::string command = page.substr(begin, page.find('\n', begin) - begin);
    const std::string quiet = "cd \"" + study.string() + "\" && " + command + " > /dev/null";
    EXPECT_EQ(std::system(quiet.c_str()), 0) << command;
}

TEST_F(Study, IsNotWrittenOverWhatIsThere) {
    folder_.write("mine/notes.txt", "mine");
    EXPECT_EQ(run_program({"new", (folder_ / "mine").string()}, said_), 2);
    EXPECT_NE(said_.find("mine: is there already"), std::string::npos) << said_;
    EXPECT_EQ(entries_of(folder_ / "mine").size(), 1u);
}

TEST_F(Study, IsAnalysedInAPythonThatHasTheLibrariesAndIsNamed) {
    const std::string bare = folder_of_python("bare", "3.11.0 numpy pandas", 0);
    const std::string broken = folder_of_python("broken", "", 1);
    ::setenv("PATH", (broken + ":" + bare).c_str(), 1);
    const int code = run_program({"analyse", (folder_ / "nothing").string()}, said_);
    EXPECT_EQ(code, 2) << said_;
    // Where /usr/bin/python3 has them it is taken, and refuses the folder; elsewhere it is said who lacks what.
    const bool is_taken = said_.find("the analysis runs in /usr/bin/python3 (Python 3.") != std::string::npos &&
                          said_.find("nothing") != std::string::npos;
    const bool is_refused = said_.find(bare + "/python3 has no numpy, pandas") != std::string::npos;
    EXPECT_TRUE(is_taken || is_refused) << said_;
    EXPECT_EQ(said_.find(broken), std::string::npos) << said_;
}

TEST_F(Study, SaysWhichFiguresThereAre) {
    ASSERT_EQ(run_program({"help", "figure"}, said_), 0);
    EXPECT_NE(said_.find("best_alpha, bias_variance"), std::string::npos) << said_;
}

}  // namespace
}  // namespace photonlab
