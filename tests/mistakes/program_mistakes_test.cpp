// What a user sees of a mistake: one line that begins with the program's name, exit code 2, nothing else, and no file
// left behind. Every message itself is tested beside; here is a sample of each kind, through the program.

#include <sys/wait.h>

#include <array>
#include <cstdio>

#include "image/exr.h"
#include "tests/mistakes/mistakes.h"

namespace photonlab::test {
namespace {

struct Outcome {
    int code = -1;       ///< of the exit; 128 and more is a signal
    std::string output;  ///< both streams
};

Outcome run_program(const std::filesystem::path& folder, const std::string& arguments) {
    const std::string command =
        "cd '" + folder.string() + "' && exec '" + PHOTONLAB_PROGRAM + "' " + arguments + " 2>&1 </dev/null";
    Outcome outcome;
    std::FILE* pipe = ::popen(command.c_str(), "r");
    if (!pipe) return outcome;
    std::array<char, 4096> buffer;
    while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe))
        outcome.output.append(buffer.data(), count);
    const int status = ::pclose(pipe);
    outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return outcome;
}

class ProgramMistakes : public ::testing::Test {
protected:
    /// The one line, without the program's name; what is wrong with it otherwise.
    std::string refusal_of(const std::string& arguments) const {
        const auto count_files = [&] {
            return std::distance(std::filesystem::recursive_directory_iterator(folder_.path()), {});
        };
        const auto files = count_files();
        const Outcome outcome = run_program(folder_.path(), arguments);
        const std::string begin = "photonlab: ";
        EXPECT_EQ(outcome.code, 2) << arguments << "\n" << outcome.output;
        EXPECT_TRUE(outcome.output.starts_with(begin)) << arguments << "\n" << outcome.output;
        EXPECT_EQ(outcome.output.find('\n'), outcome.output.size() - 1) << arguments << "\n" << outcome.output;
        EXPECT_EQ(count_files(), files) << arguments << " left something behind";
        return outcome.output.substr(std::min(begin.size(), outcome.output.size()),
                                     outcome.output.size() - begin.size() - 1);
    }
    static std::string mistake(const std::string& kind, const std::string& name) {
        return "'" + (mistakes_folder(kind) / name).string() + "'";
    }
    const MistakesFolder folder_;
};

TEST_F(ProgramMistakes, ScenesAreRefusedByEveryCommandThatReadsThem) {
    for (const char* name : {"unclosed_shape.xml", "unknown_bsdf.xml", "include_cycle.xml", "ref_to_itself.xml",
                             "width_of_a_billion.xml", "radius_whose_square_overflows.xml", "obj_is_a_device.xml"})
        for (const std::string command : {"info ", "render -o out.exr ", "reference -o out "}) {
            const std::string message = refusal_of(command + mistake("scene", name));
            const std::string expected = expected_message(mistakes_folder("scene") / name);
            EXPECT_EQ(as_far_as(expected, without_folder(message, mistakes_folder("scene"))), expected);
        }
}

TEST_F(ProgramMistakes, ExperimentsAreRefused) {
    for (const char* name : {"unclosed_list.toml", "unknown_key.toml", "missing_scene.toml", "axes_explode.toml",
                             "all_of_a_billion_passes.toml", "nested_without_end.toml"})
        for (const std::string options : {"", "--list ", "--smoke "}) {
            if (options == "--smoke " && std::string(name) == "all_of_a_billion_passes.toml") continue;  // made small
            const std::string message = refusal_of("run " + options + mistake("experiment", name));
            const std::string expected = expected_message(mistakes_folder("experiment") / name);
            EXPECT_EQ(as_far_as(expected, without_folder(message, mistakes_folder("experiment"))), expected);
        }
}

TEST_F(ProgramMistakes, ImagesAndReferencesAreRefused) {
    folder_.write("text.exr", "no image");
    folder_.write("reference/reference.json", "{}");
    write_exr(folder_ / "small.exr", Image{2, 2, {{"total", std::vector<Color>(4, Color(0.5f))}}});
    EXPECT_EQ(refusal_of("compare text.exr small.exr"), "text.exr: is not an OpenEXR file");
    EXPECT_EQ(refusal_of("compare small.exr text.exr"), "text.exr: is not an OpenEXR file");
    EXPECT_EQ(refusal_of("compare small.exr none.exr"), "none.exr: cannot be read: No such file or directory");
    EXPECT_EQ(refusal_of("compare small.exr reference").rfind("reference/reference.json: this is no reference: ", 0),
              0u);
    const std::string box = "'" + std::string(PHOTONLAB_SOURCE_DIR) + "/scenes/cornell-box/scene.xml'";
    EXPECT_EQ(refusal_of("render " + box + " -o out.exr --reference text.exr"), "text.exr: is not an OpenEXR file");
}

TEST_F(ProgramMistakes, OptionsAreRefused) {
    const std::string box = "'" + std::string(PHOTONLAB_SOURCE_DIR) + "/scenes/cornell-box/scene.xml' -o out.exr ";
    for (const std::string options : {"--resolution 0x0",
                                      "--resolution 1000000000x1000000000",
                                      "--resolution 16",
                                      "--resolution 16x16x16",
                                      "--samples-per-pixel 3",
                                      "--samples-per-pixel -1",
                                      "--samples-per-pixel 99999999999",
                                      "--passes 0",
                                      "--passes -1",
                                      "--passes 99999999999",
                                      "--passes many",
                                      "--photons 0",
                                      "--photons -5",
                                      "--photons 1e30",
                                      "--photons nan",
                                      "--alpha 0",
                                      "--alpha nan",
                                      "--alpha 1.5",
                                      "--radius -1",
                                      "--radius inf",
                                      "--k 50",
                                      "--integrator pmm",
                                      "--threads 0",
                                      "--threads 99999",
                                      "--seed -1",
                                      "--seed x",
                                      "--seed 18446744073709551616",
                                      "--seed ''",
                                      "--alpha ''",
                                      "--kernel ''",
                                      "--checkpoint-seconds nan",
                                      "--max-depth 0",
                                      "--snapshots 99",
                                      "--snapshots x",
                                      "--unknown"})
        EXPECT_NE(refusal_of("render " + box + options), "") << options;
    for (const std::string arguments : {"", "rendr", "render", "run", "compare", "info", "info a.xml b.xml"})
        EXPECT_NE(refusal_of(arguments), "") << arguments;
}

TEST_F(ProgramMistakes, FilesThatAreReadOrWrittenAlreadyAreNotWritten) {
    const std::string scene = "<scene version='3.0.0'><sensor type='perspective'/></scene>";
    folder_.write("a.xml", scene);
    folder_.write("mesh.obj", "v 0 0 0\n");
    write_exr(folder_ / "half.exr", Image{2, 2, {{"total", std::vector<Color>(4, Color(0.5f))}}});
    const std::string render = "render a.xml --passes 2 --resolution 2x2 ";
    for (const auto& [arguments, message] : std::vector<std::pair<std::string, std::string>>{
             {"-o a.xml", "a.xml: -o: is read from here"},
             {"-o out.exr --csv ./a.xml", "./a.xml: --csv: is read from here"},
             {"-o half.exr --reference half.exr", "half.exr: -o: is read from here"},
             {"-o mesh.obj", "mesh.obj: -o: is there already, and is a file of another kind"},
             {"-o out.exr --csv mesh.obj", "mesh.obj: --csv: is there already"},
             {"-o out.exr --csv out.exr", "out.exr: --csv: is written by -o already"},
             {"-o out.exr --png out.exr", "out.exr: --png: is written by -o already"},
             {"-o out.exr --checkpoint out.exr", "out.exr: --checkpoint: is written by -o already"},
             {"-o out.exr --snapshots 1 --csv out-pass-1.exr",
              "out-pass-1.exr: --csv: is written by --snapshots already"}})
        EXPECT_EQ(refusal_of(render + arguments).substr(0, message.size()), message) << arguments;
    EXPECT_EQ(read_text_file(folder_ / "a.xml"), scene);
    EXPECT_EQ(run_program(folder_.path(), render + "-o out.exr --csv out.csv --png out.png").code, 0);
    EXPECT_EQ(run_program(folder_.path(), render + "-o out.exr --csv out.csv --png out.png").code, 0) << "once more";
}

TEST_F(ProgramMistakes, AreNotScenesWithoutLightOrSurfaceWhichAreBlackAndSayWhy) {
    folder_.write("dark.xml", "<scene version='3.0.0'><sensor type='perspective'/></scene>");
    folder_.write("dark.toml",
                  "scenes = ['dark.xml']\npasses = 1\nresolution = [2, 2]\n[[method]]\nintegrator = 'ppm'\n");
    for (const std::string arguments :
         {"info dark.xml", "render dark.xml -o dark.exr --passes 1 --resolution 2x2", "run dark.toml -o out"}) {
        const Outcome outcome = run_program(folder_.path(), arguments);
        EXPECT_EQ(outcome.code, 0) << arguments;
        for (const std::string reason : {"there is no light", "there is no surface"})
            EXPECT_NE(outcome.output.find(reason + ": every image of this scene is black\n"), std::string::npos)
                << arguments << "\n"
                << outcome.output;
    }
    for (const Layer& layer : read_exr(folder_.path() / "dark.exr").layers)
        for (const Color& pixel : layer.pixels) EXPECT_EQ(pixel, Color(0.0f));
}

TEST_F(ProgramMistakes, MessagesAreOneLineThatATerminalCanShow) {
    const std::string bell = "<scene version='3.0.0'>\n<shape type='\x1b[31mred &#10;\x07'/></scene>";
    const std::string message = refusal_of("info '" + folder_.write("bell.xml", bell).filename().string() + "'");
    for (const char c : message) EXPECT_GE(static_cast<unsigned char>(c), 0x20u);
    EXPECT_EQ(message.substr(0, 26), "bell.xml:2: unknown shape ");

    // Bytes that are no UTF-8, and a control character of two.
    folder_.write("mesh.obj", "v 0 0 0\n\x9b[2J\xc2\x9bx\n");
    folder_.write("mesh.xml",
                  "<scene version='3.0.0'><sensor type='perspective'/><shape type='obj'><string name='filename' "
                  "value='mesh.obj'/>"
                  "</shape></scene>");
    EXPECT_EQ(refusal_of("info mesh.xml").substr(0, 44), "mesh.obj:2: unknown keyword \"?[2J  x\"; known");

    const std::string long_name = "<scene version='3.0.0'>\n<shape type='" + std::string(60'000, 'a') + "'/></scene>";
    EXPECT_LT(refusal_of("info '" + folder_.write("long.xml", long_name).filename().string() + "'").size(), 2100u);
}

}  // namespace
}  // namespace photonlab::test
