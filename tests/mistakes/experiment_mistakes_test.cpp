// Mistakes in experiment files: one file each in experiment/, and here those that are too large for one.

#include "experiment/file/experiment_file.h"

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
              "names of their own, and values once");
}

// toml++ takes tables down by recursion, one for every name of a key.
TEST(ExperimentMistakes, NamesWithoutEndAreRefusedByTheirLine) {
    const MistakesFolder folder;
    folder.write("lamp.xml", "");
    const auto message = [&](const std::string& bytes) {
        return refusal(folder.path(), [&] { read_experiment(folder.write("a.toml", bytes)); });
    };
    const std::string good = "scenes = [\"lamp.xml\"]\npasses = 1\n[[method]]\nintegrator = \"ppm\"\n";
    for (const std::string name : {"a", "'a'", "\"a\"", "\"\\\"]\"", "a-1", " a ", "\"\"", "''"})
        for (const std::size_t count : {17, 250'000}) {
            std::string joined = name;
            for (std::size_t i = 1; i < count; ++i) joined += "." + name;
            for (const std::string& text : {"[" + joined + "]", "[[" + joined + "]]", joined + " = 1",
                                            "a = {" + joined + " = 1}", "a = [{b = 1, " + joined + " = 1}]"})
                EXPECT_EQ(message(good + text + "\n"), "a.toml:5: expected at most 16 names joined by dots");
        }
    std::string inside;
    for (int i = 0; i < 100'000; ++i) inside += "{a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p = ";
    EXPECT_EQ(message("a = " + inside).substr(0, 9), "a.toml:1:");

    const std::string dots(300, '.');
    EXPECT_EQ(message("title = \"a" + dots + "\" # " + dots + "\n" + good), "no error");
    EXPECT_EQ(message("title = '''\n[a" + dots + "]\n''' #\n" + good), "no error");
    EXPECT_EQ(message("title = \"\"\"\n\\\"\"\"" + dots + "\n\"\"\" #\n" + good), "no error");
    std::string many = good + "alpha = [0.5";
    for (int i = 1; i < 300; ++i) many += ", 0.5" + std::to_string(1000 + i);
    EXPECT_EQ(message(many + "]\n"), "no error");
}

TEST(ExperimentMistakes, RunsThatNoFileCanBeCalledAreRefusedBeforeAnyIsMade) {
    const MistakesFolder folder;
    folder.write("lamp.xml", "");
    const auto message = [&](std::size_t letters) {
        const std::string text = "scenes = [\"lamp.xml\"]\npasses = 1\n[[method]]\nintegrator = \"ppm\"\nname = \"" +
                                 std::string(letters, 'n') + "\"\n";
        return refusal(folder.path(), [&] { read_experiment(folder.write("a.toml", text)); });
    };
    EXPECT_EQ(message(255 - 5 - 7), "no error") << "lamp_ before it and _seed-1 behind";
    EXPECT_EQ(message(255 - 5 - 6).substr(0, 40), "a.toml:3: a run is called lamp_nnnnnnnnn");
    EXPECT_NE(message(2000).find(", which has 2012 letters and can be no file's name"), std::string::npos);
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
