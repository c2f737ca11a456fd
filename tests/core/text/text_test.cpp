#include "core/text/text.h"

#include <gtest/gtest.h>

namespace photonlab {
namespace {

TEST(Text, BytesThatAreNoUtf8AreFoundWhereverTheyStand) {
    for (const char* text : {"", "plain",
                             "gr\xc3\xb6\xc3\x9f"
                             "e",
                             "\xe2\x82\xac", "\xf0\x9f\x8c\x9e"})
        EXPECT_EQ(find_no_text(text), std::string_view::npos) << text;
    EXPECT_EQ(find_no_text("ab\xff"), 2u);
    EXPECT_EQ(find_no_text("ab\xff"
                           "c\xfe",
                           3),
              4u);
    EXPECT_EQ(find_no_text(std::string_view("a\0b", 3)), 1u);
    EXPECT_EQ(find_no_text("\xc0\xaf"), 0u) << "a slash in too many bytes";
    EXPECT_EQ(find_no_text("\xed\xa0\x80"), 0u) << "half a pair of UTF-16";
    EXPECT_EQ(find_no_text("\xe2\x82"), 0u) << "cut off";
}

TEST(Text, IsMadeValidByteForByte) {
    EXPECT_EQ(valid_text("gr\xc3\xb6"
                         "\xf6"
                         "e\xff\xfe"),
              "gr\xc3\xb6\xef\xbf\xbd"
              "e\xef\xbf\xbd\xef\xbf\xbd");
    EXPECT_EQ(valid_text("plain"), "plain");
}

TEST(Text, IsPrintableWhateverItHolds) {
    EXPECT_EQ(printable("a\x1b[31m\tb\x07\x7f\nc"), "a [31m b  \nc");
    EXPECT_EQ(printable("\x9b[2J\xc2\x9bx\xc3\xb6"), "?[2J  x\xc3\xb6");
    EXPECT_EQ(printable(std::string("a\0b", 3)), "a?b");
}

TEST(Text, IsCutByColumnsNotByBytes) {
    EXPECT_EQ(first_columns("pass 12", 4), "pass");
    EXPECT_EQ(first_columns("pass", 4), "pass");
    EXPECT_EQ(first_columns("pass", 0), "");
    EXPECT_EQ(first_columns("\xc3\xb6\xc3\xb6\xc3\xb6", 2), "\xc3\xb6\xc3\xb6");
    EXPECT_EQ(first_columns("\xe6\xbc\xa2\xe5\xad\x97", 3), "\xe6\xbc\xa2") << "two columns each";
    EXPECT_EQ(first_columns("\xe1\x84\x80"
                            "a",
                            2),
              "\xe1\x84\x80")
        << "U+1100, the first of the wide ones";
    EXPECT_EQ(first_columns("\xe1\x83\xbf"
                            "a",
                            2),
              "\xe1\x83\xbf"
              "a")
        << "U+10FF";
}

}  // namespace
}  // namespace photonlab
