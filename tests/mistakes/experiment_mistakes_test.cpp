// Mistakes in experiment files: one file each in experiment/, and here those that are too large for one.

#include "experiment/experiment_file.h"

#include <sys/stat.h>

#include "tests/mistakes/mistakes.h"

namespace photonlab::test {
namespace {

TEST(ExperimentMistakes, EachGetsItsMessage) {
    expect_messages("experiment", ".toml", 95, [](const std::filesystem::path& file) { read_experiment(file); });
}

TEST(ExperimentMistakes, FilesThatAreNoTextOrTooLargeAreRefused) {
    const MistakesFolder folder;
    folder.write("lamp.xml", "");
    const auto message = [&](const std::string& bytes) {
        return refusal(folder.path(), [&] { read_experiment(folder.write("a.toml", bytes)); });
    };
    const std::string good = "scenes = [\"lamp.xml\"]\npasses = 1\n[[method]]\nintegrator = \"ppm\"\n";
    EXPECT_EQ(message(good), "no error");
    EXPECT_EQ(message("\xef\xbb\xbf" + good), "no error") << "a byte order mark";
    EXPECT_EQ(message("scenes = [\"lamp.xml\"]\r\npasses = 1\r\n[[method]]\r\nintegrator = \"ppm\"\r\n"), "no error");
    EXPECT_EQ(message(""), "a.toml: passes is missing: how many passes each run has");
    for (const std::string title : {R"("größ\"er")", R"('größ\')", "\"\"\"gr\n\"ö\"\n\"\"\"", "'''\nö'''"})
        EXPECT_EQ(message("title = " + title + " # ö\n" + good), "no error") << title;
    // Where toml++ asks whether a letter beyond ASCII is a space.
    EXPECT_EQ(message("title = \"\"\"\n\"\"\" ö\n" + good).substr(0, 9), "a.toml:2:");
    EXPECT_EQ(message("я = 1\n" + good).substr(0, 9), "a.toml:1:");
    EXPECT_EQ(message("a = 1PP[\"я\"]\n" + good).substr(0, 9), "a.toml:1:");
    EXPECT_EQ(message("# a\xdf\n").substr(0, 9), "a.toml:1:");
    EXPECT_EQ(message(good + std::string(1, '\0')).substr(0, 9), "a.toml:5:");
    EXPECT_EQ(message(std::string((1 << 24) + 1, '#')), "a.toml: expected at most 16777216 bytes, got 16777217");
    EXPECT_EQ(message(std::string(1'000'000, '[')).substr(0, 9), "a.toml:1:");
    EXPECT_EQ(message("a = " + std::string(1'000'000, '{')).substr(0, 9), "a.toml:1:");
    std::string many = good + "alpha = [0.5";
    for (int i = 0; i < 200'000; ++i) many += ", 0.25";
    EXPECT_EQ(message(many + "]\n"),
              "a.toml:3: two runs are called lamp_ppm_alpha-0.25_seed-1: give methods and scenes "
              "names of their own, and values and seeds once");
}

TEST(ExperimentMistakes, WhatIsNoFileIsRefusedNotWaitedFor) {
    const MistakesFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    const auto message = [&](const std::filesystem::path& file) {
        return refusal(folder.path(), [&] { read_experiment(file); });
    };
    EXPECT_EQ(message(folder / "pipe"), "pipe: expected a file, this is a pipe or a device");
    EXPECT_EQ(message("/dev/zero"), "/dev/zero: expected a file, this is a pipe or a device");
    EXPECT_EQ(message(folder / "none.toml"), "none.toml: cannot be read: No such file or directory");
    EXPECT_EQ(message(mistakes_folder("experiment")),
              mistakes_folder("experiment").string() + ": expected a file, this is a folder");
}

}  // namespace
}  // namespace photonlab::test
