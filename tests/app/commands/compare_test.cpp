// `compare` and `render --reference` print the errors that the library computes, and refuse what cannot be compared.

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>

#include <cmath>
#include <map>

#include "core/files/json.h"
#include "image/exr.h"
#include "image/read_image.h"
#include "reference/reference.h"
#include "tests/app/program.h"

namespace photonlab {
namespace {

class Compare : public ProgramTest {
protected:
    /// The number behind a name at the beginning of a line of what was said; NaN without one.
    static double value_of(const std::string& said, const std::string& name) {
        const std::size_t at = ("\n" + said).find("\n" + name + " ");
        return at == std::string::npos ? std::nan("") : std::stod(said.substr(at + name.size()));
    }

    std::vector<std::string> compare(const std::vector<std::string>& more = {}) const {
        std::vector<std::string> words{"compare", (folder_ / "image.exr").string(), (folder_ / "reference").string()};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
};

TEST_F(Compare, PrintsTheErrorsOfAnImageAsRenderDoes) {
    std::string rendered;
    ASSERT_EQ(run_program({"render", (folder_ / "walls/scene.xml").string(), "-o", (folder_ / "image.exr").string(),
                           "--passes", "3", "--photons", "300", "--reference", (folder_ / "reference").string()},
                          rendered),
              0)
        << rendered;
    const Image image = read_exr(folder_ / "image.exr");
    const Reference reference = load_reference(folder_ / "reference", std::nullopt);
    std::string said;
    for (const std::string component : {"total", "direct", "gathered"}) {
        const auto errors = judge(image, reference, component, false);
        ASSERT_TRUE(errors);
        ASSERT_EQ(run_program(compare({"--component", component}), said), 0) << said;
        for (const Metric& metric : metrics())
            EXPECT_EQ(value_of(said, std::string(metric.name)), errors->of(metric.name).value());
        EXPECT_EQ(value_of(said, "nonfinite"), 0.0);
    }
    const double rmse = std::sqrt(judge(image, reference, "total", false)->of("mse_unbiased").value());
    EXPECT_NEAR(value_of(rendered, "rmse"), rmse, 1e-5 * rmse) << rendered;
}

/// As Blender writes a file of several layers: each has the pass "Combined", and so has what its compositor made of
/// them.
void write_as_blender(const std::filesystem::path& file, const Image& composite, const Image& layer) {
    Imf::Header header(composite.width, composite.height);
    Imf::FrameBuffer frame;
    std::vector<std::vector<float>> planes;
    const auto width = static_cast<std::size_t>(composite.width);
    for (const auto& [name, image] : {std::pair("Composite.Combined.", &composite), {"ViewLayer.Combined.", &layer}}) {
        const std::vector<ColorD> pixels = total(*image);
        for (int channel = 0; channel < 3; ++channel) {
            std::vector<float>& plane = planes.emplace_back();
            for (const ColorD& pixel : pixels) plane.push_back(static_cast<float>(pixel[channel]));
            const std::string called = std::string(name) + "RGB"[channel];
            header.channels().insert(called, Imf::Channel(Imf::FLOAT));
            frame.insert(called, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(plane.data()), sizeof(float),
                                            sizeof(float) * width));
        }
    }
    Imf::OutputFile output(file.string().c_str(), header);
    output.setFrameBuffer(frame);
    output.writePixels(composite.height);
}

TEST_F(Compare, TakesWhatBlendersCompositorMadeAndSaysSo) {
    const Image half = read_exr(folder_ / "reference/half_a.exr");
    Image brighter = half;
    for (Color& pixel : brighter.layers[2].pixels) pixel += Color(0.5f);
    write_as_blender(folder_ / "image.exr", half, brighter);
    std::string said;
    const std::string reference = (folder_ / "reference/half_a.exr").string(), image = (folder_ / "image.exr").string();
    ASSERT_EQ(run_program({"compare", image, reference}, said), 0) << said;
    EXPECT_NEAR(value_of(said, "mse"), 0.0, 1e-12) << said;
    EXPECT_NE(said.find(image + ": has several pictures; Composite.Combined is compared"), std::string::npos) << said;
    ASSERT_EQ(run_program({"compare", reference, reference}, said), 0) << said;
    EXPECT_EQ(said.find("several pictures"), std::string::npos) << said;
}

TEST_F(Compare, SeveralImagesAndRegionsAreTableJsonAndPicture) {
    const Image half = read_exr(folder_ / "reference/half_a.exr");
    Image image = half;
    for (int y = 2; y < 5; ++y)
        for (int x = 3; x < 7; ++x) image.layers[2].pixels[static_cast<std::size_t>(y * half.width + x)] += Color(0.5f);
    write_exr(folder_ / "image.exr", image);
    const std::string changed = (folder_ / "image.exr").string(), same = (folder_ / "reference/half_a.exr").string();
    std::vector<std::string> words{"compare",     same,       changed,   same,          "--region",
                                   "box=3,2,7,5", "--region", "0,0,3,8", "--component", "gathered"};
    std::string said;
    ASSERT_EQ(run_program(words, said), 0) << said;
    EXPECT_NE(said.find(changed + " box"), std::string::npos) << said;
    words.insert(words.end(), {"--json", "--difference", (folder_ / "difference.png").string()});
    ASSERT_EQ(run_program(words, said), 0) << said;
    const Json page = Json::parse(said.substr(0, said.rfind("\n}") + 2));
    EXPECT_EQ(page["component"], "gathered");
    std::map<std::pair<std::string, std::string>, double> mse;
    for (const Json& row : page["errors"]) {
        mse[{row["image"], row["region"]}] = row["mse"];
        EXPECT_TRUE(row["mse_unbiased"].is_null()) << "the reference has no halves";
    }
    EXPECT_EQ(mse.size(), 6u) << said;
    EXPECT_EQ((mse[{same, "image"}]), 0.0);
    EXPECT_NEAR((mse[{changed, "box"}]), 0.25, 1e-6);
    EXPECT_NEAR((mse[{changed, "image"}]), 0.25 * 12 / 96, 1e-6);
    EXPECT_EQ((mse[{changed, "0,0,3,8"}]), 0.0);
    const ColorImage picture = read_color_image(folder_ / "difference.png", false);
    ASSERT_EQ(picture.width, 24) << "two images, side by side";
    const auto at = [&](int x, int y) { return picture.pixels[static_cast<std::size_t>(y * 24 + x)]; };
    EXPECT_EQ(at(3, 2), at(0, 0)) << "the first is the reference: all white";
    EXPECT_GT(at(12 + 3, 2).x, 3.0f * at(12 + 3, 2).z) << "too bright: red";
    EXPECT_EQ(at(12 + 7, 2), at(0, 0));
}

TEST_F(Compare, RefusesRegionsThatAreNoneOrNotInTheImage) {
    ASSERT_EQ(::link((folder_ / "reference/half_a.exr").c_str(), (folder_ / "image.exr").c_str()), 0);
    std::string said;
    for (const std::string region : {"a=1,2,3", "a=1,2,3,4,5", "a=1,2,x,4", "1,2,3,", ""}) {
        EXPECT_EQ(run_program(compare({"--region", region}), said), 2) << region;
        EXPECT_NE(said.find("--region: expected"), std::string::npos) << said;
    }
    for (const std::string region : {"3,3,3,4", "0,0,13,8", "-1,0,2,2", "0,5,2,4"}) {
        EXPECT_EQ(run_program(compare({"--region", region}), said), 2) << region;
        EXPECT_NE(said.find("is empty, or not within the image, 12x8"), std::string::npos) << said;
    }
    EXPECT_EQ(run_program({"compare", (folder_ / "image.exr").string()}, said), 2);
    EXPECT_NE(said.find("expected IMAGE ... REFERENCE"), std::string::npos) << said;
    EXPECT_EQ(run_program(compare({"--difference", (folder_ / "a.exr").string()}), said), 2);
    EXPECT_NE(said.find("--difference"), std::string::npos) << said;
}

TEST_F(Compare, OneImageIsAReferenceOfUnknownNoise) {
    ASSERT_EQ(::link((folder_ / "reference/half_a.exr").c_str(), (folder_ / "image.exr").c_str()), 0);
    std::string said;
    ASSERT_EQ(
        run_program({"compare", (folder_ / "image.exr").string(), (folder_ / "reference/half_b.exr").string()}, said),
        0);
    EXPECT_GT(value_of(said, "mse"), 0.0);
    EXPECT_NE(said.find("reference_floor  not known: the reference has no halves"), std::string::npos) << said;
}

TEST_F(Compare, RefusesOtherSizesMissingLayersAndReferencesThatAreNotFinite) {
    std::string said;
    write_exr(folder_ / "hot.exr", {.width = 2, .height = 1, .layers = {{"total", {Color(1.0f), Color(infinity)}}}});
    EXPECT_EQ(run_program({"compare", (folder_ / "hot.exr").string(), (folder_ / "hot.exr").string()}, said), 2);
    EXPECT_NE(said.find("hot.exr: the reference is not finite at pixel 1"), std::string::npos) << said;
    Image image{.width = 3, .height = 2, .layers = {{"total", std::vector<Color>(6, Color(1.0f))}}};
    write_exr(folder_ / "image.exr", image);
    EXPECT_EQ(run_program(compare(), said), 2);
    EXPECT_NE(said.find("image.exr: the image is 3x2, the reference 12x8"), std::string::npos) << said;
    image = {.width = 12, .height = 8, .layers = {{"total", std::vector<Color>(96, Color(1.0f))}}};
    write_exr(folder_ / "image.exr", image);
    EXPECT_EQ(run_program(compare({"--component", "direct"}), said), 2);
    EXPECT_NE(said.find("--component direct: this image or the reference"), std::string::npos) << said;
}

}  // namespace
}  // namespace photonlab
