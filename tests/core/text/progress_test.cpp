#include "core/text/progress.h"

#include <gtest/gtest.h>

namespace photonlab {
namespace {

TEST(Pace, IsUnknownUntilSomethingIsFinished) {
    Pace pace(10);
    EXPECT_FALSE(pace.seconds_left());
    EXPECT_EQ(pace.share(), 0.0);
    pace.count(0, 5.0);
    EXPECT_FALSE(pace.seconds_left());
    pace.count(2, 6.0);
    EXPECT_EQ(pace.seconds_left(), 24.0) << "8 units at 3 seconds each";
    EXPECT_EQ(pace.share(), 0.2);
}

// 40 of 64 passes are restored in no time; the next one takes 2 seconds.
TEST(Pace, OfWorkThatWasDoneBeforeIsNotThisSessions) {
    Pace pace(64);
    pace.skip(40, 0.5);
    EXPECT_FALSE(pace.seconds_left());
    EXPECT_EQ(pace.share(), 0.625);
    pace.count(41, 2.5);
    EXPECT_EQ(pace.seconds_left(), 46.0);
}

TEST(Pace, LeavesOutWaitingForOthersAndWhatTheyDid) {
    Pace pace(20);
    pace.count(4, 4.0);
    pace.skip(4, 100.0);   // waiting
    pace.skip(10, 200.0);  // another process did 6
    pace.count(12, 202.0);
    EXPECT_EQ(pace.seconds_left(), 8.0) << "6 units in 6 seconds, 8 are left";
    pace.count(11, 500.0);
    EXPECT_EQ(pace.seconds_left(), 8.0) << "nothing new";
}

TEST(Pace, EndsWithNothingLeft) {
    Pace pace(2);
    pace.count(2, 1.0);
    EXPECT_EQ(pace.seconds_left(), 0.0);
    pace.count(3, 2.0);
    EXPECT_EQ(pace.seconds_left(), 0.0);
    EXPECT_EQ(pace.share(), 1.0);
    EXPECT_EQ(Pace(0).share(), 1.0);
}

TEST(ProgressLine, IsNeverWiderThanTheTerminal) {
    EXPECT_EQ(progress_line(0.5, "12 s left", "pass 3 of 6", 79),
              "[############............]  50%  12 s left  pass 3 of 6");
    EXPECT_EQ(progress_line(0.5, "12 s left", "pass 3 of 6", 59), " 50%  12 s left  pass 3 of 6");
    EXPECT_EQ(progress_line(0.5, "12 s left", "pass 3 of 6", 19), " 50%  12 s left  pa");
    EXPECT_EQ(progress_line(0.0, "", "", 0), "");
    EXPECT_EQ(progress_line(1.0, "0.0 s left", std::string(500, 'x'), 79).size(), 79u);
    EXPECT_EQ(progress_line(0.5, "12 s left", "a\nb\x1b[2J", 40), " 50%  12 s left  a b [2J");
}

}  // namespace
}  // namespace photonlab
