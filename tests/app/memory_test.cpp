// The memory that a run's records name is the program's own, whoever started it.

#include "tests/app/program.h"
#include "tests/support/results.h"

namespace photonlab {
namespace {

TEST_F(ProgramTest, RecordedMemoryIsNotThatOfWhoeverStartedIt) {
    const std::vector<char> large(std::size_t{400} << 20, 1);  // the child is as large until it becomes the program
    std::string said;
    ASSERT_EQ(run_program(render_into("image", 8), said), 0) << said;
    ASSERT_EQ(large.back(), 1);
    for (const auto& row : read_rows(folder_ / "image.csv")) {
        EXPECT_GT(std::stod(row.at("peak_rss_mib")), 1.0);
        EXPECT_LT(std::stod(row.at("peak_rss_mib")), 350.0);
    }
}

}  // namespace
}  // namespace photonlab
