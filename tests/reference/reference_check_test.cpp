// Means by paths and by photons: what they say of light that paths never find, and how sure they are.

#include "reference/reference_check.h"

#include <gtest/gtest.h>

#include <cmath>

#include "image/exr.h"
#include "tests/support/two_walls.h"

namespace photonlab {
namespace {

/// A closed box with two lamps of about the same power: one in the open, and a tiny one of so many scene units inside a
/// ball of glass.
std::string box_with_lamp_behind_glass(double lamp_radius) {
    return R"(<scene version="3.0.0">
    <default name="resolution" value="32"/>
    <sensor type="perspective">
        <float name="fov" value="75"/>
        <transform name="to_world"><lookat origin="0.1, -0.2, -0.9" target="0, 0, 1" up="0, 1, 0"/></transform>
        <film type="hdrfilm"><integer name="width" value="$resolution"/><integer name="height" value="$resolution"/></film>
    </sensor>
    <bsdf type="twosided" id="grey"><bsdf type="diffuse"><rgb name="reflectance" value="0.6, 0.5, 0.4"/></bsdf></bsdf>
    <bsdf type="diffuse" id="black"><rgb name="reflectance" value="0"/></bsdf>
    <shape type="cube"><ref id="grey"/></shape>
    <shape type="sphere"><point name="center" x="0.3" y="0.2" z="0.4"/><float name="radius" value="0.3"/>
        <bsdf type="dielectric"/></shape>
    <shape type="sphere"><point name="center" x="0.25" y="0.25" z="0.35"/><float name="radius" value=")" +
           std::to_string(lamp_radius) + R"("/><ref id="black"/>
        <emitter type="area"><rgb name="radiance" value=")" +
           std::to_string(0.01 / (lamp_radius * lamp_radius)) + R"("/></emitter></shape>
    <shape type="sphere"><point name="center" x="-0.6" y="0.4" z="0.2"/><float name="radius" value="0.1"/>
        <ref id="black"/><emitter type="area"><rgb name="radiance" value="1"/></emitter></shape>
</scene>
)";
}

MeanByPaths by_paths(double mean, double standard_error, double pixels = 1e6) {
    return {mean, standard_error, pixels, pixels / 3.0};
}

MeanByPhotons by_photons(double within_radius, double within_half, double standard_error) {
    const double extrapolated = 2.0 * within_half - within_radius;
    return {.within_radius = {within_radius, standard_error},
            .within_half = {within_half, standard_error},
            .extrapolated = {extrapolated, standard_error},
            .passes = 1e6,
            .photons = 1e5};
}

// Quantiles of Student's distribution that are as rare as 4 of a normal one: never taken for more, nor for much less.
TEST(NormalDeviate, IsThatOfStudentsDistribution) {
    const std::pair<double, double> quantiles[] = {
        {5, 12.281424348}, {10, 6.567178768}, {20, 5.035537882}, {31, 4.621632082}, {100, 4.176597681}};
    for (const auto& [degrees_of_freedom, quantile] : quantiles) {
        EXPECT_GT(normal_deviate(quantile, degrees_of_freedom), 3.95) << degrees_of_freedom;
        EXPECT_LT(normal_deviate(quantile, degrees_of_freedom), 4.0) << degrees_of_freedom;
        EXPECT_EQ(normal_deviate(-quantile, degrees_of_freedom), -normal_deviate(quantile, degrees_of_freedom));
    }
    EXPECT_NEAR(normal_deviate(4.0, 1e9), 4.0, 1e-6);
    EXPECT_EQ(normal_deviate(0.0, 3), 0.0);
    EXPECT_LT(normal_deviate(4.0, 1), 1.5);  // one in six
}

TEST(ComparedMeans, AreDisputedBeyondFourStandardErrorsOfBothTogether) {
    // 0.03 and 0.04 together are 0.05: 0.19 is 3.8 of them, 0.21 is 4.2.
    for (const double sign : {-1.0, 1.0}) {
        const ComparedMeans near = compare_means(by_paths(1.0 + sign * 0.19, 0.03), by_photons(1.0, 1.0, 0.04));
        EXPECT_EQ(near.verdict, Verdict::Agreed);
        EXPECT_NEAR(near.standard_errors, sign * 3.8, 1e-3);
        EXPECT_NEAR(near.standard_error, 0.05, 1e-12);
        EXPECT_NEAR(near.seen, 0.2, 1e-12);
        const ComparedMeans far = compare_means(by_paths(1.0 + sign * 0.21, 0.03), by_photons(1.0, 1.0, 0.04));
        EXPECT_EQ(far.verdict, Verdict::Disputed);
        EXPECT_NEAR(far.standard_errors, sign * 4.2, 1e-3);
    }
}

// Bias in proportion to the radius: photons find 0.8 within r and 0.9 within r/2 of what is 1.
TEST(ComparedMeans, AreNotDisputedForWhatIsBiasOfTheRadius) {
    const MeanByPhotons photons = by_photons(0.8, 0.9, 1e-3);
    EXPECT_EQ(compare_means(by_paths(1.0, 1e-3), photons).verdict, Verdict::Agreed);
    EXPECT_EQ(compare_means(by_paths(0.95, 1e-3), photons).verdict, Verdict::Agreed);
    EXPECT_EQ(compare_means(by_paths(0.85, 1e-3), photons).verdict, Verdict::Agreed);
    EXPECT_EQ(compare_means(by_paths(1.02, 1e-3), photons).verdict, Verdict::Disputed);
    EXPECT_EQ(compare_means(by_paths(0.78, 1e-3), photons).verdict, Verdict::Disputed);
    EXPECT_NEAR(compare_means(by_paths(0.85, 1e-3), photons).seen, 0.1 + 4e-3 * std::sqrt(2.0), 1e-9);
    // Where hit points are few, what is left of the bias is uncertain.
    MeanByPhotons few = photons;
    few.change_scatter = 0.05;
    EXPECT_EQ(compare_means(by_paths(1.15, 1e-3), few).verdict, Verdict::Agreed);
    EXPECT_EQ(compare_means(by_paths(1.25, 1e-3), few).verdict, Verdict::Disputed);
}

TEST(ComparedMeans, NeedMoreStandardErrorsWhereTheseRestOnFewNumbers) {
    const MeanByPhotons photons = by_photons(1.0, 1.0, 1e-6);
    EXPECT_EQ(compare_means(by_paths(0.95, 0.01), photons).verdict, Verdict::Disputed);
    EXPECT_EQ(compare_means(by_paths(0.95, 0.01, 10), photons).verdict, Verdict::Agreed);
    EXPECT_EQ(compare_means(by_paths(0.93, 0.01, 10), photons).verdict, Verdict::Disputed);
    EXPECT_EQ(compare_means(by_paths(0.5, 0.01, 1), photons).verdict, Verdict::Agreed);
}

TEST(ComparedMeans, DecideNothingWhereTheyCannot) {
    MeanByPhotons photons = by_photons(1.0, 1.0, 0.01);
    photons.photons = 99;
    EXPECT_EQ(compare_means(by_paths(0.5, 0.01), photons).why, "only 99 photons reached what the camera sees");
    EXPECT_EQ(compare_means(by_paths(1.0, 0.3), by_photons(1.0, 1.0, 0.01)).verdict, Verdict::Undecided);
    // Photons find twice as much within half the radius: so they may miss anything.
    EXPECT_EQ(compare_means(by_paths(5.0, 0.01), by_photons(0.5, 1.0, 0.01)).verdict, Verdict::Undecided);
    EXPECT_EQ(compare_means(by_paths(0.1, 0.01), by_photons(0.5, 1.0, 0.01)).verdict, Verdict::Disputed);
}

TEST(ComparedMeans, OfNoLightAgree) {
    MeanByPhotons none = by_photons(0.0, 0.0, 0.0);
    none.photons = 0;
    EXPECT_EQ(compare_means({}, none).verdict, Verdict::Agreed);
}

// Both halves in closed form: differences of 2, -4 and 0, so the mean's variance is (4 + 16) / 4 / 3^2.
TEST(MeanByPathsOfHalves, HasTheStandardErrorOfTheirDifferences) {
    const auto half = [](float first, float second, float third) {
        return Image{3,
                     1,
                     {{"direct", std::vector<Color>(3, Color(0.5f))},
                      {"gathered", {Color(first), Color(second), Color(third)}}}};
    };
    const Image a = half(4, 2, 1);
    const Image b = half(2, 6, 1);
    const MeanByPaths gathered = mean_by_paths(a, b, ComparedLight::Gathered);
    EXPECT_NEAR(gathered.mean, 8.0 / 3.0, 1e-6);
    EXPECT_NEAR(gathered.standard_error, std::sqrt(5.0) / 3.0, 1e-6);
    EXPECT_EQ(gathered.pixels, 2.0);
    EXPECT_NEAR(gathered.effective_pixels, 400.0 / 272.0, 1e-6);
    EXPECT_NEAR(mean_by_paths(a, b, ComparedLight::DirectAndGathered).mean, 8.0 / 3.0 + 0.5, 1e-6);
}

class ReferenceCheck : public ::testing::Test {
protected:
    Scene scene_of(const std::string& text) { return build_scene(load_scene_file(folder_.write("scene.xml", text))); }

    Json reference_of(const Scene& scene, std::uint64_t samples, std::uint64_t seed = 1) {
        ReferenceSettings settings;
        settings.scene_file = folder_ / "scene.xml";
        settings.samples = samples;
        settings.max_depth = scene.max_depth;
        settings.seed = seed;
        return add_reference_samples(scene, settings, folder_ / "reference");
    }
    TestFolder folder_;
};

TEST_F(ReferenceCheck, HalfOfTheLightThatNoPathFindsIsDisputed) {
    const Scene scene = scene_of(box_with_lamp_behind_glass(1e-4));
    const Json json = reference_of(scene, 32);
    const Json& check = json.at("check");
    EXPECT_EQ(check.at("verdict"), "disputed") << check.dump(1);
    EXPECT_EQ(json.at("estimate"), "unbiased, but disputed");
    for (const char* light : {"gathered", "direct_and_gathered"}) {
        EXPECT_EQ(check.at(light).at("verdict"), "disputed");
        EXPECT_LT(check.at(light).at("standard_errors_beyond_photons"), -10.0) << check.dump(1);
    }
    EXPECT_LT(check.at("gathered").at("paths").at("mean").get<double>(),
              0.6 * check.at("gathered").at("photons").at("within_half_of_r").at("mean").get<double>());
    const std::string why = check.at("why").get<std::string>();
    EXPECT_EQ(why.rfind("the mean of gathered is ", 0), 0u) << why;
    EXPECT_NE(why.find("paths from the camera miss light that photons find"), std::string::npos) << why;

    const Reference reference = load_reference(folder_ / "reference", std::nullopt);
    EXPECT_EQ(warning_about(reference), "the reference " + (folder_ / "reference").string() + " is disputed: " + why);
}

TEST_F(ReferenceCheck, TheSameLampInTheOpenIsNot) {
    std::string text = box_with_lamp_behind_glass(0.05);
    text.replace(text.find("dielectric"), 10, "null");
    const std::size_t glass = text.find("<shape type=\"sphere\"><point name=\"center\" x=\"0.3\"");
    text.erase(glass, text.find("</shape>", glass) + 8 - glass);
    const Json json = reference_of(scene_of(text), 32);
    EXPECT_EQ(json.at("check").at("verdict"), "not disputed") << json.dump(1);
    EXPECT_EQ(json.at("estimate"), "unbiased");
}

TEST_F(ReferenceCheck, MoreSamplesAreComparedAnew) {
    const Scene scene = scene_of(two_walls_scene);
    const Json first = reference_of(scene, 4).at("check");
    const Json second = reference_of(scene, 60).at("check");
    EXPECT_EQ(second.at("verdict"), "not disputed") << second.dump(1);
    const auto error = [](const Json& check) {
        return check.at("gathered").at("paths").at("standard_error").get<double>();
    };
    EXPECT_NEAR(error(second) / error(first), 0.25, 0.1);
}

TEST_F(ReferenceCheck, IsNotMadeOfWhatPhotonsMadeNorWithoutLight) {
    const Scene scene = scene_of(two_walls_scene);
    ReferenceSettings by_ppm;
    by_ppm.scene_file = folder_ / "scene.xml";
    by_ppm.integrator = "ppm";
    by_ppm.photons_per_pass = 100;
    by_ppm.samples = 1;
    by_ppm.max_depth = scene.max_depth;
    const Json json = add_reference_samples(scene, by_ppm, folder_ / "by-ppm");
    EXPECT_EQ(json.at("check").at("verdict"), "not made");
    EXPECT_EQ(json.at("check").at("why"), "it is made by photons itself");

    std::string dark = two_walls_scene;
    dark.erase(dark.find("<emitter"), dark.find("</emitter>") + 10 - dark.find("<emitter"));
    const Json of_dark = reference_of(scene_of(dark), 1).at("check");
    EXPECT_EQ(of_dark.at("verdict"), "not made");
    EXPECT_EQ(of_dark.at("why"), "there is no light");
}

TEST_F(ReferenceCheck, ComparingAgainChangesNeitherKeyNorHalves) {
    const Scene scene = scene_of(two_walls_scene);
    Json old = reference_of(scene, 16);
    const std::string key = check_reference(folder_ / "reference", {scene.hash, 12, 8, 1, scene.max_depth});
    const Json check = old.at("check");
    old.erase("check");
    folder_.write("reference/reference.json", old.dump());
    EXPECT_EQ(load_reference(folder_ / "reference", std::nullopt).check.verdict, "not compared");

    ReferenceSettings settings;
    settings.max_depth = scene.max_depth;
    Json again = compare_reference_with_photons(scene, settings, folder_ / "reference");
    EXPECT_EQ(again.at("check").at("gathered"), check.at("gathered"));
    EXPECT_EQ(check_reference(folder_ / "reference", {scene.hash, 12, 8, 1, scene.max_depth}), key);
    EXPECT_EQ(load_reference(folder_ / "reference", std::nullopt).check.verdict,
              check.at("verdict").get<std::string>());
    again.erase("check");
    EXPECT_EQ(again, old);

    settings.max_depth = 3;
    EXPECT_NE(message_of([&] {
                  compare_reference_with_photons(scene, settings, folder_ / "reference");
              }).find("this is a reference of something else: max_depth is 5"),
              std::string::npos);
    EXPECT_NE(message_of([&] {
                  compare_reference_with_photons(scene, settings, folder_ / "nowhere");
              }).find("this is no reference"),
              std::string::npos);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "nowhere"));
}

}  // namespace
}  // namespace photonlab
