// What is said of words that are misspelt, missing or empty: the word that is wrong, and what was meant.

#include "tests/app/program.h"

namespace photonlab {
namespace {

class CommandLine : public ProgramTest {
protected:
    /// The message, without the program's name; what is wrong with it otherwise.
    std::string refusal_of(const std::vector<std::string>& words) const {
        std::string said;
        const int code = run_program(words, said);
        return code == 2 && said.starts_with("photonlab: ") ? said.substr(11) : std::to_string(code) + ": " + said;
    }
    std::string output_of(const std::vector<std::string>& words) const {
        std::string said;
        const int code = run_program(words, said);
        return code == 0 ? said : std::to_string(code) + ": " + said;
    }
};

TEST_F(CommandLine, MisspeltCommandsAreAnsweredWithTheNearest) {
    EXPECT_EQ(refusal_of({"rnu"}), "there is no command \"rnu\"; did you mean \"run\"?\n");
    EXPECT_EQ(refusal_of({"rnu", "--nonsense", "x"}), "there is no command \"rnu\"; did you mean \"run\"?\n");
    EXPECT_EQ(refusal_of({"Compare", "a", "b"}), "there is no command \"Compare\"; did you mean \"compare\"?\n");
    EXPECT_EQ(refusal_of({"help", "rednr"}), "there is no command \"rednr\"; did you mean \"render\"?\n");
    EXPECT_EQ(refusal_of({"walk"}),
              "there is no command \"walk\"; expected new, render, run, join, analyse, figure, reference, compare, "
              "info, merge, verify\n");
    EXPECT_EQ(refusal_of({}),
              "expected a command: new, render, run, join, analyse, figure, reference, compare, info, merge, verify; "
              "photonlab help "
              "says more\n");
}

TEST_F(CommandLine, MisspeltOptionsAreAnsweredBeforeWhatIsMissing) {
    EXPECT_EQ(refusal_of({"render", "a.xml", "--alhpa", "0.7"}),
              "there is no option \"--alhpa\"; did you mean \"--alpha\"?\n");
    EXPECT_EQ(refusal_of({"render", "a.xml", "-o", "a.exr", "--pases=3"}),
              "there is no option \"--pases\"; did you mean \"--passes\"?\n");
    EXPECT_EQ(refusal_of({"info", "-resolution", "3x3"}),
              "there is no option \"-resolution\"; did you mean \"--resolution\"?\n");
    EXPECT_EQ(refusal_of({"compare", "--componet", "direct", "a.exr", "b.exr"}),
              "there is no option \"--componet\"; did you mean \"--component\"?\n");
    EXPECT_EQ(refusal_of({"run", "--whatever"}), "there is no option \"--whatever\"; photonlab help run lists them\n");
    EXPECT_EQ(refusal_of({"--verison"}), "there is no option \"--verison\"; did you mean \"--version\"?\n");
    EXPECT_EQ(refusal_of({"-o", "a.exr", "render"}), "there is no option \"-o\"; options stand behind their command\n");
    EXPECT_EQ(refusal_of({"render", "a.xml"}), "-o is required\n");
}

TEST_F(CommandLine, EmptyWordsAreRefusedByTheirOption) {
    const std::string scene = (folder_ / "walls/scene.xml").string();
    for (const std::string option :
         {"-o", "--integrator", "--alpha", "--passes", "--seed", "--threads", "--resolution", "--samples-per-pixel",
          "--reference", "--csv", "--png", "--snapshots", "--checkpoint", "--checkpoint-seconds", "--emission-from"}) {
        EXPECT_EQ(refusal_of({"render", scene, option, ""}), option + ": expected a value, it is empty\n");
        if (option == "-o") continue;
        EXPECT_EQ(refusal_of({"render", scene, option + "="}), option + ": expected a value, it is empty\n");
    }
    for (const std::string command :
         {"new", "render", "run", "join", "analyse", "figure", "reference", "compare", "info", "merge", "verify"})
        EXPECT_EQ(refusal_of({command, ""}), "argument 2: expected a value, it is empty\n");
    EXPECT_EQ(refusal_of({"run", "a.toml", "--only", ""}), "--only: expected a value, it is empty\n");
    EXPECT_EQ(refusal_of({"compare", scene, scene, "--component", ""}), "--component: expected a value, it is empty\n");
    EXPECT_EQ(refusal_of({""}), "argument 1: expected a value, it is empty\n");
}

TEST_F(CommandLine, HelpIsACommandToo) {
    EXPECT_EQ(output_of({"help"}), output_of({"--help"}));
    EXPECT_NE(output_of({"help"}).find("Exit codes: 0 done;"), std::string::npos);
    for (const std::string command :
         {"new", "render", "run", "join", "analyse", "figure", "reference", "compare", "info", "merge", "verify"}) {
        EXPECT_EQ(output_of({"help", command}), output_of({command, "--help"}));
        EXPECT_NE(output_of({"help", command}).find("Usage: photonlab " + command), std::string::npos);
    }
}

TEST_F(CommandLine, NumbersBelowZeroAreValuesAndNoOptions) {
    const std::string scene = (folder_ / "walls/scene.xml").string();
    EXPECT_EQ(output_of({"render", scene, "-o", (folder_ / "a.exr").string(), "--passes", "1", "--photons", "10",
                         "--max-depth", "-1"})
                  .substr(0, 7),
              "memory ");
    EXPECT_EQ(refusal_of({"render", scene, "-o", (folder_ / "a.exr").string(), "--alpha", "-0.5"}).substr(0, 7),
              "--alpha");
}

}  // namespace
}  // namespace photonlab
