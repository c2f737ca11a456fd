// Checkpoints that are none. That every changed byte and every length is noticed is tested with the checkpoints.

#include "render/checkpoint.h"

#include <sys/stat.h>

#include <sstream>

#include "tests/mistakes/mistakes.h"

namespace photonlab::test {
namespace {

TEST(CheckpointMistakes, WhatIsNoFileIsRefusedNotWaitedFor) {
    const MistakesFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    std::filesystem::create_directory(folder / "folder");
    const auto message = [&](const std::string& name) {
        return refusal(folder.path(), [&] { load({folder / name, "run", "remove it"}, {}); });
    };
    EXPECT_EQ(message("pipe"), "pipe: cannot be read as a checkpoint; remove it");
    EXPECT_EQ(message("folder"), "folder: cannot be read as a checkpoint; remove it");
    EXPECT_EQ(message(folder.write("text", "no checkpoint").filename().string()),
              "text: is no checkpoint of photonlab; remove it");
    EXPECT_FALSE(load({folder / "none", "run", "remove it"}, {}));
}

TEST(CheckpointMistakes, AnOptionalValueIsThereOrNot) {
    std::istringstream stream(std::string("\x02") + std::string(8, '\0'));
    StateArchive archive(stream, 9);
    std::optional<double> value;
    EXPECT_EQ(refusal("none", [&] { archive.exchange(value); }), "expected 0 or 1 before a value, got 2");
}

}  // namespace
}  // namespace photonlab::test
