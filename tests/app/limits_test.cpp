// Limits that the system sets to a process: what fits is done, and what does not is said, whatever the limit.

#include <set>

#include "tests/app/program.h"
#include "tests/support/results.h"

namespace photonlab {
namespace {

class SystemLimits : public ProgramTest {};

// Each run has a lock while its group is made: more runs than there can be open files are made in parts.
TEST_F(SystemLimits, OnOpenFilesDoNotBindTheNumberOfRuns) {
    constexpr int runs = 300;
    std::string alphas;
    for (int i = 1; i <= runs; ++i) alphas += (i > 1 ? ", " : "") + std::to_string(i / 1024.0);
    folder_.write("many.toml",
                  "passes = 1\nthreads = 1\nrecord = [1]\nsnapshots = []\nphotons_per_pass = 20\n"
                  "scenes = [\"walls/scene.xml\"]\n[[method]]\nintegrator = \"ppm\"\nalpha = [" +
                      alphas + "]\n");
    std::string said;
    ASSERT_EQ(run_program({"run", (folder_ / "many.toml").string(), "-o", (folder_ / "results").string()}, said,
                          {.open_files = 280}),
              0)
        << said;
    EXPECT_NE(said.find("300 runs made, 0 were finished already"), std::string::npos) << said;
}

// Libraries differ in what they do without memory or threads: some throw, some end the program.
TEST_F(SystemLimits, OnAddressesAreSaidByEveryCommand) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "AddressSanitizer wants more addresses than any limit leaves";
#endif
    const std::string scene = (folder_ / "walls/scene.xml").string();
    const std::string image = (folder_ / "reference/half_a.exr").string();
    std::string said;
    ASSERT_EQ(run_program(run_into("whole"), said), 0) << said;
    std::set<int> codes;
    for (const auto& command : std::vector<std::vector<std::string>>{
             {"info", scene},
             {"render", scene, "-o", (folder_ / "a.exr").string(), "--png", (folder_ / "a.png").string(), "--passes",
              "2", "--photons", "300"},
             {"reference", scene, "-o", (folder_ / "new").string(), "--samples", "1"},
             {"compare", image, (folder_ / "reference").string()},
             {"run", (folder_ / "tiny.toml").string(), "-o", (folder_ / "results").string(), "--only", "*_seed-1"},
             {"verify", (folder_ / "whole").string()}})
        for (rlim_t mebibytes = 200; mebibytes <= 900; mebibytes += 50) {
            const int code = run_program(command, said, {.address_bytes = mebibytes << 20});
            codes.insert(code);
            EXPECT_TRUE(code == 0 || code == 2) << command[0] << " in " << mebibytes << " MiB: " << code << said;
            for (const char* word : {"internal error", "terminate", "bad_alloc", "Thread creation"})
                EXPECT_EQ(said.find(word), std::string::npos) << said;
            std::filesystem::remove_all(folder_ / "results");
            if (code == 0 && mebibytes % 100 == 0) break;  // it fits from here on
        }
    EXPECT_EQ(codes, (std::set<int>{0, 2}));
}

TEST_F(SystemLimits, OnThreadsDoNotKeepInfoFromItsAnswer) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP()
        << "the sanitizer build is linked with the image codecs, a library of which starts threads before main";
#endif
    if (::geteuid() != 0) GTEST_SKIP() << "only root can become somebody else, who has no process yet";
    const std::string somebody = "exec setpriv --reuid 54321 --clear-groups ";
    const std::string scene = PHOTONLAB_SOURCE_DIR "/scenes/point-light-plane/scene.xml";
    if (std::system((somebody + "test -x " PHOTONLAB_PROGRAM " -a -r " + scene).c_str()) != 0)
        GTEST_SKIP() << "others cannot reach the program here";
    const std::string command =
        somebody + "prlimit --nproc=1 " PHOTONLAB_PROGRAM " info " + scene + " > " + messages_file() + " 2>&1";
    EXPECT_EQ(std::system(command.c_str()), 0) << read_text_file(messages_file());
    EXPECT_NE(read_text_file(messages_file()).find("hit points"), std::string::npos);
}

}  // namespace
}  // namespace photonlab
