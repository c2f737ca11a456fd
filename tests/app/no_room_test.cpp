// Full disks, by a limit on the size of files or a device that is always full, and folders that vanish.

#include <sys/mount.h>

#include "image/png.h"
#include "tests/app/program.h"
#include "tests/support/results.h"

namespace photonlab {
namespace {

class NoRoom : public ProgramTest {
protected:
    /// Names of the files in the test's folder that were begun and not finished.
    std::string halves() const {
        std::string names;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_.path()))
            if (entry.path().filename().string().find("partial") != std::string::npos)
                names += entry.path().string() + "\n";
        return names;
    }
};

TEST_F(NoRoom, ForAnImageLeavesNoneAndNamesIt) {
    const std::string output = (folder_ / "big.exr").string();
    std::string said;
    EXPECT_EQ(run_program({"render", (folder_ / "walls/scene.xml").string(), "-o", output, "--passes", "1"}, said,
                          {.file_bytes = 1000}),
              2);
    EXPECT_NE(said.find(output + ": cannot be written: File too large"), std::string::npos) << said;
    EXPECT_FALSE(std::filesystem::exists(output));
    EXPECT_EQ(halves(), "");
}

TEST_F(NoRoom, ForAPictureLeavesNoneAndNamesIt) {
    const std::filesystem::path output = folder_ / "big.png";
    std::vector<ColorD> noise;
    for (int i = 0; i < 64 * 64; ++i) noise.emplace_back((i * 7919 % 1009) / 1009.0);
    const rlimit limit{1000, RLIM_INFINITY};
    rlimit before;
    ::getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    ::setrlimit(RLIMIT_FSIZE, &limit);
    const std::string said = message_of([&] { write_png(output, 64, 64, noise); });
    ::setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
    EXPECT_NE(said.find(output.string() + ": cannot be written"), std::string::npos) << said;
    EXPECT_FALSE(std::filesystem::exists(output));
    EXPECT_EQ(halves(), "");
}

TEST_F(NoRoom, ForRowsLeavesWholeOnesAndNamesTheirFile) {
    std::vector<std::string> command = render_into("rows", 1 << 16);
    std::string said;
    EXPECT_EQ(run_program(command, said, {.file_bytes = 14'000}), 2) << said;
    EXPECT_NE(said.find("rows.csv: cannot be written: File too large"), std::string::npos) << said;
    const std::string text = read_text_file(folder_ / "rows.csv");
    EXPECT_EQ(text.back(), '\n');
    for (const auto& row : read_rows(folder_ / "rows.csv")) EXPECT_EQ(row.at("nonfinite"), "0");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "rows.exr"));
    EXPECT_EQ(halves(), "");
}

TEST_F(NoRoom, LosesNothingOfAnExperiment) {
    std::string said;
    ASSERT_EQ(run_program(run_into("whole"), said), 0) << said;
    for (const rlim_t bytes : {500, 3000, 6000, 9000, 12'000}) {
        EXPECT_EQ(run_program(run_into("full"), said, {.file_bytes = bytes}), 2) << bytes << said;
        EXPECT_NE(said.find("cannot be written: File too large"), std::string::npos) << said;
        EXPECT_EQ(halves(), "");
    }
    ASSERT_EQ(run_program(run_into("full"), said), 0) << said;
    EXPECT_EQ(difference_of_results(folder_ / "whole", folder_ / "full"), "");
    EXPECT_EQ(difference_of_results(folder_ / "full", folder_ / "whole"), "");
}

TEST_F(NoRoom, OnStandardOutputIsAnError) {
    const std::string command = std::string(PHOTONLAB_PROGRAM) + " info " + (folder_ / "walls/scene.xml").string() +
                                " > /dev/full 2> " + messages_file();
    const int status = std::system(command.c_str());
    EXPECT_EQ(WEXITSTATUS(status), 2);
    EXPECT_NE(read_text_file(messages_file()).find("cannot be written"), std::string::npos);
}

TEST_F(NoRoom, DevicesAreNotReplacedByFiles) {
    std::string said;
    EXPECT_EQ(run_program({"render", (folder_ / "walls/scene.xml").string(), "-o", "/dev/full"}, said), 2);
    EXPECT_NE(said.find("/dev/full: expected a file, this is a device or a pipe"), std::string::npos) << said;
    EXPECT_TRUE(std::filesystem::is_character_file("/dev/full"));
}

TEST_F(NoRoom, FoldersThatCannotBeWrittenAreRefusedBeforeAnythingIsRendered) {
    std::string said;
    EXPECT_EQ(run_program({"render", (folder_ / "walls/scene.xml").string(), "-o", "/proc/nothing/out.exr"}, said), 2);
    EXPECT_NE(said.find("/proc/nothing: folder cannot be made"), std::string::npos) << said;
    EXPECT_EQ(run_program({"run", (folder_ / "tiny.toml").string(), "-o", "/proc/nothing"}, said), 2);
    EXPECT_NE(said.find("/proc/nothing"), std::string::npos) << said;
}

TEST_F(NoRoom, AFolderThatVanishesIsNamed) {
    Program program(render_into("gone/one", 100000), folder_ / "messages");
    ASSERT_TRUE(program.wait_for(folder_ / "gone/one.checkpoint")) << program.messages();
    std::filesystem::rename(folder_ / "gone", folder_ / "moved");
    EXPECT_EQ(program.wait(), 2);
    EXPECT_NE(program.messages().find("gone/one"), std::string::npos) << program.messages();
    EXPECT_NE(program.messages().find("cannot be written: No such file or directory"), std::string::npos)
        << program.messages();
}

TEST_F(NoRoom, InMemoryIsRefusedWithTheNumbers) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "AddressSanitizer wants more addresses than any limit leaves";
#endif
    std::string said;
    EXPECT_EQ(run_program({"render", (folder_ / "walls/scene.xml").string(), "-o", (folder_ / "large.exr").string(),
                           "--resolution", "4096x4096"},
                          said, {.address_bytes = 600'000'000}),
              2);
    EXPECT_NE(said.find("scene.xml: needs up to "), std::string::npos) << said;
    EXPECT_EQ(run_program({"render", (folder_ / "walls/scene.xml").string(), "-o", (folder_ / "large.exr").string(),
                           "--photons", "4000000000"},
                          said, {.address_bytes = 600'000'000}),
              2);
    EXPECT_NE(said.find("scene.xml: needs up to "), std::string::npos) << said;
}

// A file system of 300 KiB; only root can make one.
TEST_F(NoRoom, OnAFileSystemIsFoundBeforehandOrNamesTheFile) {
    std::filesystem::create_directories(folder_ / "small");
    if (::mount("none", (folder_ / "small").c_str(), "tmpfs", 0, "size=300k") != 0)
        GTEST_SKIP() << "cannot mount a small file system here; the other tests limit the size of files";
    const std::string scene = (folder_ / "walls/scene.xml").string();
    const std::string output = (folder_ / "small/big.exr").string();
    std::string before;
    const int refused = run_program(
        {"render", scene, "-o", output, "--resolution", "512x512", "--passes", "1", "--photons", "100"}, before);
    std::string during;
    std::ofstream(folder_ / "small/filler") << std::string(200'000, 'x');
    const int full = run_program(run_into("small/results"), during);
    std::filesystem::remove(folder_ / "small/filler");
    std::filesystem::remove_all(folder_ / "small/results");
    const bool is_left = std::filesystem::exists(output);
    ::umount((folder_ / "small").c_str());
    EXPECT_EQ(refused, 2);
    EXPECT_NE(before.find("what this render writes can take 12.0 MiB, and 0.3 MiB are free there"), std::string::npos)
        << before;
    EXPECT_FALSE(is_left);
    EXPECT_EQ(full, 2);
    EXPECT_TRUE(during.find("No space left on device") != std::string::npos ||
                during.find("are free there") != std::string::npos)
        << during;
}

}  // namespace
}  // namespace photonlab
