// What is written is what its name says: other names are refused before anything is read, and nothing is written.

#include <fmt/format.h>

#include "image/exr.h"
#include "tests/app/program.h"

namespace photonlab {
namespace {

class WrittenNames : public ::testing::Test {
protected:
    WrittenNames() { folder_.write("scene.xml", two_walls_scene); }

    std::string in(const std::string& name) const { return (folder_ / name).string(); }

    /// Its exit code; what it said is in said_.
    int run(const std::vector<std::string>& words) {
        Program program(words, folder_ / "messages");
        const int code = program.wait();
        said_ = program.messages();
        return code;
    }
    int render(const std::string& output, const std::vector<std::string>& more = {}) {
        std::vector<std::string> words{"render", in("scene.xml"), "-o", in(output), "--passes",
                                       "1",      "--photons",     "100"};
        words.insert(words.end(), more.begin(), more.end());
        return run(words);
    }
    void expect_said(const std::string& text) const { EXPECT_NE(said_.find(text), std::string::npos) << said_; }
    bool exists(const std::string& name) const { return std::filesystem::exists(folder_ / name); }

    const TestFolder folder_;
    std::string said_;
};

TEST_F(WrittenNames, AnImageEndsInExr) {
    for (const std::string name : {"a.png", "a.PNG", "a.csv", "a.jpg", "a.exr.gz", "a", "exr", "a.exr.png", "a.exr."}) {
        EXPECT_EQ(render(name), 2) << name;
        expect_said(in(name) + ": -o: writes OpenEXR: expected a name that ends in .exr");
        EXPECT_FALSE(exists(name));
    }
    EXPECT_EQ(render("a.png"), 2);
    expect_said("; --png writes PNG");
    for (const std::string name : {"a.exr", "B.EXR", "c.d.Exr"}) {
        EXPECT_EQ(render(name), 0) << said_;
        EXPECT_EQ(read_exr(folder_ / name).width, 12);
    }
}

TEST_F(WrittenNames, PicturesAndTablesEndAsTheyAreWritten) {
    EXPECT_EQ(render("a.exr", {"--png", in("b.exr")}), 2);
    expect_said(in("b.exr") + ": --png: writes PNG: expected a name that ends in .png; -o writes OpenEXR");
    EXPECT_EQ(render("a.exr", {"--png", in("b.jpeg")}), 2);
    EXPECT_EQ(render("a.exr", {"--csv", in("b.png")}), 2);
    expect_said(in("b.png") + ": --csv: writes CSV: expected a name that ends in .csv; --png writes PNG");
    EXPECT_EQ(render("a.exr", {"--csv", in("b.txt")}), 2);
    EXPECT_EQ(render("a.exr", {"--checkpoint", in("b.exr")}), 2);
    expect_said(in("b.exr") + ": --checkpoint: writes the state of the render: expected another name");
    for (const std::string name : {"a.exr", "b.exr", "b.jpeg", "b.png", "b.txt"}) EXPECT_FALSE(exists(name)) << name;
    EXPECT_EQ(
        render("a.exr", {"--png", in("b.PNG"), "--csv", in("b.Csv"), "--checkpoint", in("state"), "--snapshots", "1"}),
        0)
        << said_;
    for (const std::string name : {"a.exr", "b.PNG", "b.Csv", "a-pass-1.exr"}) EXPECT_TRUE(exists(name)) << name;
}

// A render that ends before its last pass: the image of the pass it ended with is a snapshot of that pass, if it was
// asked for, and none has the name of a pass that was not made.
TEST_F(WrittenNames, SnapshotsOfARenderThatStopsAreOfThePassesThatItMade) {
    EXPECT_EQ(run({"render", in("scene.xml"), "-o", in("a.exr"), "--passes", "64", "--photons", "2000",
                   "--estimate-error", "on", "--stop-at", "1e6", "--snapshots", "1,2,3,64"}),
              0)
        << said_;
    expect_said("2 passes of ppm");  // the first with a noise that is known
    for (const std::string name : {"a.exr", "a-pass-1.exr", "a-pass-2.exr"}) {
        EXPECT_TRUE(exists(name)) << name;
        expect_said("wrote       " + in(name));
    }
    for (const std::string name : {"a-pass-3.exr", "a-pass-64.exr"}) EXPECT_FALSE(exists(name)) << name;
}

TEST_F(WrittenNames, FoldersAreNotCalledAsFilesAre) {
    for (const std::string name : {"a.exr", "a.PNG", "a.csv"}) {
        EXPECT_EQ(run({"reference", in("scene.xml"), "-o", in(name), "--samples", "1"}), 2);
        expect_said("-o: expected the name of a folder, got \"" + in(name) + "\", that of a file of ");
        EXPECT_EQ(run({"run", in("no.toml"), "-o", in(name)}), 2);
        expect_said("-o: expected the name of a folder, got \"" + in(name) + "\", that of a file of ");
        EXPECT_FALSE(exists(name));
    }
    std::filesystem::create_directory(folder_ / "old.exr");  // whoever has one keeps it
    EXPECT_EQ(run({"reference", in("scene.xml"), "-o", in("old.exr"), "--samples", "1"}), 0) << said_;
}

TEST_F(WrittenNames, OfAReferenceThatIsThereItIsSaidThatSamplesAreAdded) {
    const std::vector<std::string> add{"reference", in("scene.xml"), "-o", in("reference"), "--samples", "3"};
    EXPECT_EQ(run(add), 0);
    EXPECT_EQ(said_.find("adds to"), std::string::npos) << said_;
    EXPECT_EQ(run(add), 0);
    expect_said(in("reference") +
                ": adds to the 3 samples a half that are there; runs that were judged by them will be made again");
}

}  // namespace
}  // namespace photonlab
