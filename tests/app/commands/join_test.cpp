// `join` puts ranges of passes together to the bytes of a run of all, says which are missing, and refuses what does not
// belong together; references grow by ranges to the same bytes.

#include "core/text/csv.h"
#include "tests/app/program.h"

namespace photonlab {
namespace {

class Join : public ProgramTest {
protected:
    std::string scene() const { return (folder_ / "walls/scene.xml").string(); }
    std::string file(const std::string& name) const { return (folder_ / name).string(); }

    /// `render` of these passes with Knaus and Zwicker's radii, and `more`.
    int render(const std::vector<std::string>& more, std::string& said) const {
        std::vector<std::string> words{"render",    scene(), "--schedule", "knaus-zwicker",
                                       "--photons", "300",   "--threads",  "1"};
        words.insert(words.end(), more.begin(), more.end());
        return run_program(words, said);
    }

    void render_parts(const std::vector<std::string>& more = {}) const {
        for (const auto& [passes, name] : {std::pair{"1..3", "a.ck"}, {"4..4", "b.ck"}, {"5..12", "c.ck"}}) {
            std::vector<std::string> words{"--passes", passes, "--checkpoint", file(name)};
            words.insert(words.end(), more.begin(), more.end());
            std::string said;
            ASSERT_EQ(render(words, said), 0) << said;
        }
    }

    int join(const std::vector<std::string>& names, std::string& said,
             const std::vector<std::string>& more = {"-o", "joined.exr"}) const {
        std::vector<std::string> words{"join"};
        for (const std::string& name : names) words.push_back(file(name));
        words.insert(words.end(), {more[0], file(more[1]), "--threads", "1"});
        words.insert(words.end(), more.begin() + 2, more.end());
        return run_program(words, said);
    }

    void expect_refusal(int code, const std::string& said, const std::string& expected) const {
        EXPECT_EQ(code, 2);
        EXPECT_NE(said.find(expected), std::string::npos) << said;
        EXPECT_FALSE(std::filesystem::exists(folder_ / "joined.exr"));
    }
};

TEST_F(Join, PartsInAnyOrderHaveTheBytesOfTheWhole) {
    std::string said;
    ASSERT_EQ(render({"--passes", "12", "-o", file("whole.exr")}, said), 0) << said;
    render_parts();
    ASSERT_EQ(join({"c.ck", "a.ck", "b.ck"}, said, {"-o", "joined.exr", "--csv", file("joined.csv")}), 0) << said;
    EXPECT_NE(said.find("12 passes, 1..3 4..4 5..12,"), std::string::npos) << said;
    EXPECT_TRUE(read_text_file(folder_ / "joined.exr") == read_text_file(folder_ / "whole.exr"));
    EXPECT_NE(read_text_file(folder_ / "joined.csv").find(",12,1..3 4..4 5..12,total,"), std::string::npos);
}

TEST_F(Join, APartThatWasStoppedGoesOnAndOneThatIsWholeIsLeft) {
    render_parts();
    const std::string whole = read_text_file(folder_ / "c.ck");
    std::string said;
    ASSERT_EQ(render({"--passes", "5..12", "--checkpoint", file("c.ck"), "--resume"}, said), 0) << said;
    EXPECT_NE(said.find("has passes 5..12 already"), std::string::npos) << said;
    EXPECT_TRUE(read_text_file(folder_ / "c.ck") == whole);
    EXPECT_EQ(render({"--passes", "5..13", "--checkpoint", file("c.ck"), "--resume"}, said), 2);
}

TEST_F(Join, SaysWhichPassesAreMissing) {
    render_parts();
    std::string said;
    ASSERT_EQ(join({"c.ck", "a.ck"}, said), 0) << said;
    EXPECT_NE(said.find("passes 4..4 are in none of these"), std::string::npos) << said;
}

TEST_F(Join, RefusesAPassTwiceAndPartsOfAnotherRun) {
    render_parts();
    std::string said;
    std::string other;
    int code = join({"a.ck", "b.ck", "a.ck"}, said);
    expect_refusal(code, said, "a pass would count twice");
    ASSERT_EQ(render({"--passes", "13..14", "--checkpoint", file("d.ck"), "--alpha", "0.5", "--seed", "2"}, other), 0);
    code = join({"a.ck", "d.ck"}, said);
    expect_refusal(code, said,
                   "is of another run: alpha is 0.5 here and 0.7 in " + file("a.ck") + ", seed is 2 here and 1 in " +
                       file("a.ck"));
}

TEST_F(Join, RefusesWhatIsNoPartAndASceneThatHasChanged) {
    render_parts();
    std::string said;
    folder_.write("a.txt", "photons");
    int code = join({"a.ck", "a.txt"}, said);
    expect_refusal(code, said, "is no checkpoint of photonlab");
    code = join({"a.ck", "nothing.ck"}, said);
    EXPECT_EQ(code, 2);
    std::string scene_text = read_text_file(scene());
    scene_text.replace(scene_text.find("0."), 2, "1.");
    write_text_file(scene(), scene_text);
    code = join({"a.ck"}, said);
    EXPECT_EQ(code, 2);
    EXPECT_NE(said.find("is not the scene that"), std::string::npos) << said;
}

// A laptop joins what the nodes of a cluster made, where the scene has another path.
TEST_F(Join, RefusesToWriteOverWhatItReadsOrTwiceToOneFile) {
    render_parts();
    std::filesystem::copy_file(folder_ / "a.ck", folder_ / "a.png");
    const std::string reference = file("reference.exr");
    std::string said;
    expect_refusal(join({"a.ck", "b.ck", "c.ck"}, said, {"-o", "reference.exr", "--reference", reference}), said,
                   "reference.exr: -o: is read from here");
    expect_refusal(join({"a.png", "b.ck"}, said, {"-o", "joined.exr", "--png", file("a.png")}), said,
                   "a.png: --png: is read from here");
    expect_refusal(join({"a.ck", "b.ck"}, said, {"-o", "joined.exr", "--csv", file("joined.exr")}), said,
                   "joined.exr: --csv: is written by -o already");
}

TEST_F(Join, TheSceneMayBeElsewhereByNow) {
    std::string said;
    ASSERT_EQ(render({"--passes", "12", "-o", file("whole.exr")}, said), 0) << said;
    render_parts();
    std::filesystem::create_directory(folder_ / "elsewhere");
    std::filesystem::rename(folder_ / "walls", folder_ / "elsewhere/walls");
    EXPECT_EQ(join({"a.ck", "b.ck", "c.ck"}, said), 2);
    EXPECT_NE(said.find("scene.xml: is not there any more; --scene names"), std::string::npos) << said;
    const std::string moved = (folder_ / "elsewhere/walls/scene.xml").string();
    ASSERT_EQ(join({"a.ck", "b.ck", "c.ck"}, said, {"-o", "joined.exr", "--scene", moved}), 0) << said;
    EXPECT_TRUE(read_text_file(folder_ / "joined.exr") == read_text_file(folder_ / "whole.exr"));
}

TEST_F(Join, PassesThatFollowFromOthersAreRefusedWithTheReason) {
    std::string said;
    const std::vector<std::string> range{"--passes", "1..3", "--checkpoint", file("a.ck")};
    const auto refused = [&](std::vector<std::string> more, const std::string& reason) {
        more.insert(more.end(), range.begin(), range.end());
        more.insert(more.begin(), {"render", scene()});
        EXPECT_EQ(run_program(more, said), 2) << said;
        EXPECT_NE(said.find(reason), std::string::npos) << said;
        EXPECT_FALSE(std::filesystem::exists(folder_ / "a.ck"));
    };
    refused({"--schedule", "hachisuka"}, "its radii follow from what earlier passes found");
    refused({"--integrator", "photonmapper"}, "it gathers the photons of all passes together");
    refused({"--schedule", "knaus-zwicker", "--photon-paths", "visible"}, "the chains of photon_paths visible");
    refused({"--schedule", "knaus-zwicker", "--estimate-error", "on"}, "estimate_error compares each pass");
    refused({"--schedule", "knaus-zwicker", "--emission", "adaptive"}, "emission learns in passes 1..16");
    EXPECT_EQ(render({"--passes", "3..1", "--checkpoint", file("a.ck")}, said), 2);
    EXPECT_NE(said.find("a range of them such as 17..32, got \"3..1\""), std::string::npos) << said;
    EXPECT_EQ(render({"--passes", "1..3"}, said), 2);
    EXPECT_NE(said.find("expected --checkpoint FILE as well"), std::string::npos) << said;
}

TEST_F(Join, EmissionThatWasLearntServesTheOtherParts) {
    const std::vector<std::string> learning{"--emission", "adaptive", "--learn-passes", "3"};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.end(), learning.begin(), learning.end());
        return more;
    };
    std::string said;
    ASSERT_EQ(render(with({"--passes", "9", "-o", file("whole.exr")}), said), 0) << said;
    ASSERT_EQ(render(with({"--passes", "1..4", "--checkpoint", file("a.ck")}), said), 0) << said;
    EXPECT_EQ(render(with({"--passes", "5..9", "--checkpoint", file("b.ck")}), said), 2);
    EXPECT_NE(said.find("expected --emission-from FILE as well"), std::string::npos) << said;
    ASSERT_EQ(render(with({"--passes", "5..9", "--checkpoint", file("b.ck"), "--emission-from", file("a.ck")}), said),
              0)
        << said;
    ASSERT_EQ(join({"a.ck", "b.ck"}, said), 0) << said;
    EXPECT_TRUE(read_text_file(folder_ / "joined.exr") == read_text_file(folder_ / "whole.exr"));
}

TEST_F(Join, AReferenceInUnevenRangesHasTheBytesOfAWholeOne) {
    for (const std::string integrator : {"path", "ppm"}) {
        const std::vector<std::string> words{
            "reference", scene(), "--integrator", integrator, "--photons", "500", "--threads", "1", "-o"};
        const auto make = [&](const std::string& folder, const std::vector<std::string>& more) {
            std::vector<std::string> all(words);
            all.push_back(file(folder));
            all.insert(all.end(), more.begin(), more.end());
            std::string said;
            ASSERT_EQ(run_program(all, said), 0) << said;
        };
        const std::string whole = integrator + "-whole";
        const std::string parts = integrator + "-parts";
        make(whole, {"--samples", "20"});
        std::vector<std::string> files;
        for (const auto& [first, last] : {std::pair{1, 1}, {2, 8}, {9, 11}, {12, 19}, {20, 20}}) {
            make(parts, {"--passes", std::to_string(first) + ".." + std::to_string(last)});
            files.push_back(parts + "/passes-" + std::to_string(first) + "-" + std::to_string(last) + ".ck");
        }
        std::string said;
        ASSERT_EQ(join(files, said, {"-o", parts}), 0) << said;
        for (const std::string half : {"half_a.exr", "half_b.exr"})
            EXPECT_TRUE(read_text_file(folder_ / parts / half) == read_text_file(folder_ / whole / half)) << half;
        Json made = parse_json(read_text_file(folder_ / parts / "reference.json"));
        Json expected = parse_json(read_text_file(folder_ / whole / "reference.json"));
        for (Json* json : {&made, &expected}) {
            json->erase("seconds");
            if (json->at("check").contains("seconds")) json->at("check").erase("seconds");
        }
        EXPECT_EQ(made, expected);

        files.erase(files.begin() + 2);
        EXPECT_EQ(join(files, said, {"-o", parts}), 2);
        EXPECT_NE(said.find("samples 9..11 are in none of these parts"), std::string::npos) << said;
    }
}

}  // namespace
}  // namespace photonlab
