// What commands say of the reference that they judge by: that it is disputed, or has changed since.

#include "tests/app/program.h"

namespace photonlab {
namespace {

class ReferenceWords : public ProgramTest {
protected:
    ReferenceWords() {
        folder_.write("runs.toml",
                      "scenes = [{path = \"walls/scene.xml\", reference = \"reference\"}]\nseeds = 2\npasses = 2\n"
                      "photons_per_pass = 200\n[[method]]\nintegrator = \"ppm\"\nalpha = [0.5, 0.7]\n");
    }
    std::vector<std::string> run() const {
        return {"run", (folder_ / "runs.toml").string(), "-o", (folder_ / "results").string()};
    }
    std::vector<std::string> render() const {
        return {"render",      (folder_ / "walls/scene.xml").string(),
                "-o",          (folder_ / "image.exr").string(),
                "--passes",    "1",
                "--photons",   "100",
                "--reference", (folder_ / "reference").string()};
    }
    std::vector<std::string> compare() const {
        return {"compare", (folder_ / "image.exr").string(), (folder_ / "reference").string()};
    }
    std::string said_by(const std::vector<std::string>& words) const {
        std::string said;
        EXPECT_EQ(run_program(words, said), 0) << said;
        return said;
    }
    static std::size_t times(const std::string& said, const std::string& text) {
        std::size_t count = 0;
        for (std::size_t at = 0; (at = said.find(text, at)) != std::string::npos; at += text.size()) ++count;
        return count;
    }
    void set_check(const std::string& verdict, const std::string& why) const {
        Json json = read_reference_json(folder_ / "reference");
        json["check"] = {{"verdict", verdict}, {"why", why}};
        folder_.write("reference/reference.json", json.dump());
    }
};

TEST_F(ReferenceWords, ADisputedOneIsNamedOnceByAllThatJudgeByIt) {
    set_check("disputed", "half of it is missing");
    const std::string warning =
        "the reference " + (folder_ / "reference").string() + " is disputed: half of it is missing\n";
    EXPECT_EQ(times(said_by(render()), warning), 1u);
    EXPECT_EQ(times(said_by(compare()), warning), 1u);
    EXPECT_EQ(times(said_by(run()), warning), 1u);
    for (const auto& folder : std::filesystem::directory_iterator(folder_ / "results/runs")) {
        const Json check = Json::parse(read_text_file(folder.path() / "run.json")).at("reference").at("check");
        EXPECT_EQ(check.at("verdict"), "disputed");
        EXPECT_EQ(check.at("why"), "half of it is missing");
    }
}

TEST_F(ReferenceWords, OfOthersNothingIsSaid) {
    for (const char* verdict : {"not disputed", "undecided", "not made"}) {
        set_check(verdict, "");
        for (const auto& words : {render(), compare()}) EXPECT_EQ(said_by(words).find("disputed"), std::string::npos);
    }
    Json json = read_reference_json(folder_ / "reference");
    json.erase("check");
    folder_.write("reference/reference.json", json.dump());
    for (const auto& words : {render(), compare(), run()})
        EXPECT_EQ(said_by(words).find("disputed"), std::string::npos);
    for (const auto& folder : std::filesystem::directory_iterator(folder_ / "results/runs"))
        EXPECT_EQ(Json::parse(read_text_file(folder.path() / "run.json")).at("reference").at("check").at("verdict"),
                  "not compared");
}

TEST_F(ReferenceWords, OneThatHasChangedIsNamedBeforeItsRunsAreMadeAgain) {
    const std::string changed = "has changed since";
    EXPECT_EQ(times(said_by(run()), changed), 0u);
    EXPECT_EQ(times(said_by(run()), changed), 0u);
    EXPECT_EQ(times(said_by({"reference", (folder_ / "walls/scene.xml").string(), "-o",
                             (folder_ / "reference").string(), "--samples", "1"}),
                    "adds to the 8 samples a half that are there; runs that were judged by them will be made again"),
              1u);
    EXPECT_EQ(times(said_by(run()), (folder_ / "reference").string() +
                                        ": has changed since 4 finished runs were judged by it; they are made again\n"),
              1u);
    EXPECT_EQ(times(said_by(run()), changed), 0u);
}

}  // namespace
}  // namespace photonlab
