// Names of files are bytes, and need be no text: folders, experiments and scenes that are called so are made, recorded,
// and found finished. And no input is waited for.

#include <sys/stat.h>

#include "core/text/text.h"
#include "tests/app/program.h"
#include "tests/support/results.h"

namespace photonlab {
namespace {

class Names : public ProgramTest {
protected:
    static bool is_text(const std::filesystem::path& file) {
        return find_no_text(read_text_file(file)) == std::string::npos;
    }
};

TEST_F(Names, ThatAreNoTextAreRecordedAndFoundAgain) {
    const std::string latin = "caf\xe9";  // in an encoding of old
    const std::filesystem::path folder = folder_ / latin / latin;
    const std::filesystem::path results = folder_ / latin / "results";
    std::filesystem::create_directories(folder);
    std::filesystem::copy(folder_ / "walls/scene.xml", folder / "scene.xml");
    std::filesystem::copy(folder_ / "reference", folder / "reference");
    write_text_file(folder / (latin + ".toml"),
                    "scenes = [{ path = 'scene.xml', reference = 'reference', probes = { middle = [6, 4] } }]\n"
                    "passes = 2\nphotons_per_pass = 300\ndecomposition = true\n"
                    "[[method]]\nintegrator = 'ppm'\nname = 'd\xc3\xa9j\xc3\xa0 vu'\n");
    const std::vector<std::string> run{"run", (folder / (latin + ".toml")).string(), "-o", results.string()};
    std::string said;
    ASSERT_EQ(run_program(run, said), 0) << said;
    EXPECT_NE(said.find("1 runs made, 0 were finished already"), std::string::npos) << said;
    ASSERT_EQ(run_program(run, said), 0) << said;
    EXPECT_NE(said.find("0 runs made, 1 were finished already"), std::string::npos) << said;
    EXPECT_EQ(find_no_text(said), std::string::npos);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(results))
        if (entry.path().extension() == ".csv" || entry.path().extension() == ".json") {
            EXPECT_TRUE(is_text(entry.path())) << entry.path();
        }
    EXPECT_EQ(read_rows(results / "iterations.csv").at(0).at("experiment"), "caf\xef\xbf\xbd");
}

TEST_F(Names, ThatAreNoTextAreWrittenByEveryCommand) {
    const std::filesystem::path folder = folder_ / "\xff";
    std::filesystem::create_directories(folder);
    std::filesystem::copy(folder_ / "walls/scene.xml", folder / "scene.xml");
    const std::string scene = (folder / "scene.xml").string();
    std::string said;
    ASSERT_EQ(
        run_program({"render", scene, "-o", (folder / "\xfe.exr").string(), "--csv", (folder / "\xfe.csv").string(),
                     "--passes", "2", "--photons", "300", "--reference", (folder_ / "reference").string()},
                    said),
        0)
        << said;
    EXPECT_TRUE(is_text(folder / "\xfe.csv"));
    for (const std::string samples : {"2", "4"}) {
        ASSERT_EQ(run_program({"reference", scene, "-o", (folder / "\xfe").string(), "--samples", "2"}, said), 0)
            << said;
        EXPECT_NE(said.find(samples + " samples a half"), std::string::npos) << said;
    }
    EXPECT_TRUE(is_text(folder / "\xfe/reference.json"));
    ASSERT_EQ(run_program({"compare", (folder / "\xfe.exr").string(), (folder / "\xfe").string()}, said), 0) << said;
    ASSERT_EQ(run_program({"info", scene}, said), 0) << said;
}

TEST_F(Names, ThatNoFileCanHaveAreRefusedBeforeAnythingIsRendered) {
    const std::string scene = (folder_ / "walls/scene.xml").string();
    const std::string passes = "1000000000";  // days of them
    std::string said;
    EXPECT_EQ(run_program({"render", scene, "-o", (folder_ / (std::string(245, 'o') + ".exr")).string(), "--passes",
                           passes, "--snapshots", passes},
                          said),
              2);
    EXPECT_NE(said.find("-pass-1000000000.exr: --snapshots: cannot be written: File name too long"), std::string::npos)
        << said;
    EXPECT_EQ(run_program({"render", scene, "-o", (folder_ / (std::string(255, 'o') + ".exr")).string()}, said), 2);
    EXPECT_NE(said.find(".exr: -o: cannot be written: File name too long"), std::string::npos) << said;
    for (const char* option : {"--csv", "--png", "--checkpoint"}) {
        const std::string name = std::string(300, 'o') + (option == std::string("--png") ? ".png" : "");
        EXPECT_EQ(run_program({"render", scene, "-o", (folder_ / "a.exr").string(), "--passes", passes, option,
                               (folder_ / name).string()},
                              said),
                  2);
        EXPECT_NE(said.find(option + std::string(": cannot be written: File name too long")), std::string::npos)
            << said;
    }
}

// In words of the library's own it would say which function failed.
TEST_F(Names, ThatNoFileCanHaveAreSaidAsTheyAre) {
    const std::string scene = (folder_ / "walls/scene.xml").string();
    const std::string image = (folder_ / "reference/half_a.exr").string();
    const std::string tiny = (folder_ / "tiny.toml").string();
    const std::string output = (folder_ / "out.exr").string();
    std::filesystem::create_symlink("round", folder_ / "round");
    for (const std::string name : {"round.exr", "round.csv", "round.png"})
        std::filesystem::create_symlink(name, folder_ / name);
    for (const std::string& name : {std::string(300, 'n'), std::string(300, 'n') + "/n", std::string(5000, 'n'),
                                    std::string("round"), std::string("round/n")}) {
        const std::string none = (folder_ / name).string();
        std::ofstream(folder_ / "odd.toml") << "scenes = [{ path = 'walls/scene.xml', reference = '" << name
                                            << "' }]\npasses = 1\n[[method]]\nintegrator = 'path'\n";
        for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
                 {"info", none},
                 {"render", none, "-o", output},
                 {"render", scene, "-o", none + ".exr"},
                 {"render", scene, "-o", output, "--csv", none + ".csv"},
                 {"render", scene, "-o", output, "--png", none + ".png"},
                 {"render", scene, "-o", output, "--reference", none},
                 {"render", scene, "-o", output, "--checkpoint", none},
                 {"render", scene, "-o", output, "--checkpoint", none, "--resume"},
                 {"reference", none, "-o", (folder_ / "new").string()},
                 {"reference", scene, "-o", none, "--samples", "1"},
                 {"reference", scene, "-o", none, "--samples", "0"},
                 {"compare", none, image},
                 {"compare", image, none},
                 {"run", none},
                 {"run", (folder_ / "odd.toml").string(), "-o", (folder_ / "results").string()},
                 {"run", tiny, "-o", none},
                 {"run", tiny, "-o", none, "--list"},
                 {"verify", none}}) {
            std::string said;
            const int code = run_program(command, said);
            EXPECT_EQ(code, 2) << command[0] << ' ' << name << ": " << said;
            EXPECT_EQ(said.find("filesystem error"), std::string::npos) << said;
            EXPECT_NE(said.find("photonlab: "), std::string::npos) << said;
        }
    }
}

TEST_F(Names, OfPipesDevicesAndFilesOfTheKernelAreNotWaitedFor) {
    ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
    const std::string scene = (folder_ / "walls/scene.xml").string();
    const std::string image = (folder_ / "reference/half_a.exr").string();
    const std::string output = (folder_ / "out.exr").string();
    std::string said;
    for (const std::string& input : std::vector<std::string>{(folder_ / "pipe").string(), "/dev/zero", "/proc/kmsg",
                                                             "/proc/self/status", "/dev/stdin"})
        for (const std::vector<std::string>& command :
             std::vector<std::vector<std::string>>{{"info", input},
                                                   {"render", input, "-o", output},
                                                   {"render", scene, "-o", output, "--reference", input},
                                                   {"render", scene, "-o", output, "--checkpoint", input, "--resume"},
                                                   {"reference", input, "-o", (folder_ / "grown").string()},
                                                   {"reference", scene, "-o", input, "--samples", "1"},
                                                   {"compare", input, image},
                                                   {"compare", image, input},
                                                   {"run", input},
                                                   {"run", (folder_ / "tiny.toml").string(), "-o", input}}) {
            EXPECT_EQ(run_program(command, said), 2) << command[0] << " " << input << ": " << said;
            EXPECT_EQ(said.find("internal error"), std::string::npos) << said;
        }
}

}  // namespace
}  // namespace photonlab
