// Limits that the system sets to a process: what fits is done, and what does not is said, whatever the limit.

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

}  // namespace
}  // namespace photonlab
