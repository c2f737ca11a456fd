// `compare` and `render --reference` print the errors that the library computes, and refuse what cannot be compared.

#include <cmath>

#include "image/exr.h"
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
