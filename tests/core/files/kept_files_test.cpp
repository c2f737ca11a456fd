#include "core/files/kept_files.h"

#include <gtest/gtest.h>

#include "core/hash.h"
#include "tests/support/test_folder.h"

namespace photonlab {
namespace {

TEST(KeptFiles, AJsonTextEndsWithTheHashOfWhatIsBefore) {
    const std::string text = with_checksum({{"name", "a"}, {"list", {1, 2}}});
    const std::string before = "{\n  \"name\": \"a\",\n  \"list\": [\n    1,\n    2\n  ]";
    EXPECT_EQ(text, before + ",\n  \"checksum\": \"" + hash_text(before) + "\"\n}\n");
    EXPECT_EQ(Json::parse(text).size(), 3u);
    EXPECT_EQ(checked_json(text), (Json{{"name", "a"}, {"list", {1, 2}}}));
}

TEST(KeptFiles, EveryChangeOfAJsonTextIsNoticed) {
    const std::string text = with_checksum({{"name", "a"}, {"number", 0.1}});
    for (std::size_t i = 0; i < text.size(); ++i) {
        std::string flipped = text;
        flipped[i] = static_cast<char>(flipped[i] ^ 1);
        EXPECT_FALSE(checked_json(flipped)) << flipped;
        EXPECT_FALSE(checked_json(text.substr(0, i))) << i;
        EXPECT_FALSE(checked_json(text.substr(0, i) + text.substr(i + 1))) << i;
    }
    EXPECT_FALSE(checked_json(text + "\n"));
    EXPECT_FALSE(checked_json("[]\n"));
}

// XXH3 of 128 bits as its specification's test vectors have it, so that other programs come to the same digits.
TEST(KeptFiles, AStampIsTheSizeAndTheHash) {
    TestFolder folder;
    const std::filesystem::path file = folder.write("a.csv", "");
    EXPECT_EQ(stamp_of(file), (FileStamp{0, "99aa06d3014798d86001c324468d497f"}));
    folder.write("a.csv", "rows");
    const FileStamp stamp = stamp_of(file);
    EXPECT_EQ(stamp, stamp_of_text("rows"));
    EXPECT_EQ(stamp_from(stamp_json(stamp)), stamp);
}

TEST(KeptFiles, AFaultNamesTheFileAndWhatIsWrong) {
    TestFolder folder;
    const std::filesystem::path table = folder.write("a.csv", "rows");
    const std::filesystem::path image = folder.write("a.exr", "rows");
    const FileStamp stamp = stamp_of(table);
    for (const Check check : {Check::Sizes, Check::Records, Check::Everything})
        EXPECT_FALSE(fault_of(table, stamp, check));
    folder.write("a.csv", "rowS");
    folder.write("a.exr", "rowS");
    EXPECT_FALSE(fault_of(table, stamp, Check::Sizes));
    EXPECT_EQ(fault_of(table, stamp, Check::Records),
              table.string() + ": is not what was written: its checksum is another");
    EXPECT_FALSE(fault_of(image, stamp, Check::Records));
    EXPECT_TRUE(fault_of(image, stamp, Check::Everything));
    folder.write("a.csv", "row");
    EXPECT_EQ(fault_of(table, stamp, Check::Sizes), table.string() + ": has 3 bytes, and had 4 when it was written");
    std::filesystem::remove(table);
    std::filesystem::create_symlink("/proc/self/status", table);  // has no size, and cannot be read as it is
    EXPECT_EQ(fault_of(table, {0, stamp.hash}, Check::Records),
              table.string() + ": expected a file that has a size, this is one of the kernel's");
    std::filesystem::remove(table);
    EXPECT_EQ(fault_of(table, stamp, Check::Sizes), table.string() + ": No such file or directory");
}

}  // namespace
}  // namespace photonlab
