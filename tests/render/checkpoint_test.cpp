#include "render/checkpoint.h"

#include <gtest/gtest.h>

#include "tests/support/test_folder.h"

namespace photonlab {
namespace {

class Checkpoints : public ::testing::Test {
protected:
    StateExchange state() {
        return [this](StateArchive& archive) { archive.exchange(values_); };
    }
    Checkpoint of(const std::string& identity) { return {folder_ / "checkpoint", identity, "remove it"}; }

    /// What is said of a checkpoint whose file has this content.
    std::string said_of(const std::string& content) {
        folder_.write("checkpoint", content);
        return message_of([&] { load(of("a run"), state()); });
    }

    TestFolder folder_;
    std::vector<double> values_{1.0, 2.0, 3.0};
};

TEST_F(Checkpoints, GiveBackWhatWasSaved) {
    save(of("a run"), state());
    values_ = {};
    EXPECT_TRUE(load(of("a run"), state()));
    EXPECT_EQ(values_, (std::vector<double>{1.0, 2.0, 3.0}));
    EXPECT_TRUE(is_usable(of("a run")));
}

TEST_F(Checkpoints, MayBeMissing) {
    EXPECT_FALSE(load(of("a run"), state()));
    EXPECT_FALSE(is_usable(of("a run")));
}

TEST_F(Checkpoints, OfAnotherRunAreRefusedByName) {
    save(of("a run"), state());
    EXPECT_EQ(message_of([&] { load(of("another"), state()); }),
              (folder_ / "checkpoint").string() +
                  ": is of another run: its settings, scene, reference, passes or the program's version were "
                  "different; remove it");
}

TEST_F(Checkpoints, DamagedAtAnyByteAreRefusedByName) {
    save(of("a run"), state());
    const std::string whole = read_text_file(folder_ / "checkpoint");
    for (std::size_t i = 0; i < whole.size(); ++i) {
        std::string damaged = whole;
        damaged[i] = static_cast<char>(damaged[i] ^ 1);
        const std::string said = said_of(damaged);
        EXPECT_NE(said.find("checkpoint: is "), std::string::npos) << i << said;
    }
    EXPECT_EQ(values_, (std::vector<double>{1.0, 2.0, 3.0}));
}

TEST_F(Checkpoints, TruncatedAtAnyByteOrLengthenedAreRefusedByName) {
    save(of("a run"), state());
    const std::string whole = read_text_file(folder_ / "checkpoint");
    for (std::size_t length = 0; length < whole.size(); ++length)
        EXPECT_NE(said_of(whole.substr(0, length)).find("checkpoint: is "), std::string::npos) << length;
    EXPECT_NE(said_of(whole + "x").find("is damaged or truncated"), std::string::npos);
}

TEST_F(Checkpoints, OfAnotherShapeAreRefusedByName) {
    save(of("a run"), state());
    const auto said = [&](const StateExchange& other) { return message_of([&] { load(of("a run"), other); }); };
    EXPECT_NE(said([](StateArchive&) {}).find("does not fit: has 32 bytes more than its state"), std::string::npos);
    EXPECT_NE(said([&](StateArchive& archive) {
                  state()(archive);
                  state()(archive);
              }).find("does not fit: ends before its state does"),
              std::string::npos);
}

TEST_F(Checkpoints, OfAnotherFormatAreRefusedByName) {
    save(of("a run"), state());
    std::string content = read_text_file(folder_ / "checkpoint");
    content.resize(content.size() - 32);
    content[16] = 77;
    EXPECT_NE(said_of(content + hash_text(content)).find("is of format 77"), std::string::npos);
}

TEST_F(Checkpoints, ThatCannotBeWrittenLeaveTheOldOne) {
    save(of("a run"), state());
    const std::string before = read_text_file(folder_ / "checkpoint");
    EXPECT_ANY_THROW(save(of("a run"), [](StateArchive&) { throw InputError("in the middle"); }));
    EXPECT_EQ(read_text_file(folder_ / "checkpoint"), before);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), {}), 1);
}

TEST(AppendedFile, IsCutBackToWhatWasSaved) {
    TestFolder folder;
    const Checkpoint checkpoint{folder / "checkpoint", "rows", ""};
    AppendedFile file(folder / "rows.csv");
    const StateExchange state = [&](StateArchive& archive) { file.exchange(archive); };
    file.append("a,b\n");
    file.append("1,2\n");
    save(checkpoint, state);
    file.append("3,4\n");
    AppendedFile again(folder / "rows.csv");
    load(checkpoint, [&](StateArchive& archive) { again.exchange(archive); });
    EXPECT_EQ(read_text_file(folder / "rows.csv"), "a,b\n1,2\n");
    again.append("5,6\n");
    EXPECT_EQ(read_text_file(folder / "rows.csv"), "a,b\n1,2\n5,6\n");
}

TEST(AppendedFile, RefusesAFileThatIsNotItsOwn) {
    TestFolder folder;
    const Checkpoint checkpoint{folder / "checkpoint", "rows", ""};
    AppendedFile file(folder / "rows.csv");
    file.append("a,b\n");
    save(checkpoint, [&](StateArchive& archive) { file.exchange(archive); });
    AppendedFile again(folder / "rows.csv");
    const auto restored = [&] { load(checkpoint, [&](StateArchive& archive) { again.exchange(archive); }); };
    folder.write("rows.csv", "a,c\n1,2\n");
    EXPECT_NE(message_of(restored).find("rows.csv: is not the file that was being written"), std::string::npos);
    folder.write("rows.csv", "a,");
    EXPECT_NE(message_of(restored).find("rows.csv: is not the file that was being written"), std::string::npos);
    EXPECT_EQ(message_of([&] { file.append("1,2\n"); }),
              (folder / "rows.csv").string() + ": was changed by somebody else while it was being written");
    std::filesystem::remove(folder / "rows.csv");
    EXPECT_NE(message_of([&] { file.append("1,2\n"); }).find("rows.csv: cannot be written"), std::string::npos);
}

}  // namespace
}  // namespace photonlab
