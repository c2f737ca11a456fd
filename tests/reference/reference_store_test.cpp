#include "reference/reference_store.h"

#include <gtest/gtest.h>

#include <cmath>

#include "image/exr.h"
#include "tests/support/two_walls.h"

namespace photonlab {
namespace {

class ReferenceStore : public ::testing::Test {
protected:
    ReferenceStore() : scene_(build_scene(load_scene_file(folder_.write("scene.xml", two_walls_scene)))) {}

    ReferenceSettings settings(std::uint64_t samples) {
        ReferenceSettings settings;
        settings.scene_file = folder_ / "scene.xml";
        settings.samples = samples;
        settings.max_depth = scene_.max_depth;
        return settings;
    }
    ReferenceSubject subject() { return {scene_.hash, scene_.camera.width, scene_.camera.height, 1, scene_.max_depth}; }

    TestFolder folder_;
    Scene scene_;
};

void expect_near(const Image& a, const Image& b) {
    const std::vector<ColorD> x = total(a);
    const std::vector<ColorD> y = total(b);
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t i = 0; i < x.size(); ++i)
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(x[i][channel], y[i][channel], 1e-5 * (std::abs(y[i][channel]) + 1e-3));
}

TEST_F(ReferenceStore, ResumedIsTheSameAsUninterrupted) {
    add_reference_samples(scene_, settings(12), folder_ / "whole");
    add_reference_samples(scene_, settings(5), folder_ / "parts");
    const Json json = add_reference_samples(scene_, settings(7), folder_ / "parts");
    EXPECT_EQ(json.at("samples_per_half"), 12u);
    const Reference whole = load_reference(folder_ / "whole", subject());
    const Reference parts = load_reference(folder_ / "parts", subject());
    EXPECT_EQ(whole.key, parts.key);
    expect_near(parts.half_a, whole.half_a);
    expect_near(parts.half_b, whole.half_b);
}

TEST_F(ReferenceStore, HalvesAreIndependent) {
    const Json json = add_reference_samples(scene_, settings(4), folder_ / "reference");
    const Reference reference = load_reference(folder_ / "reference", subject());
    EXPECT_FALSE(*reference.half_a.find(gathered_layer) == *reference.half_b.find(gathered_layer));
    EXPECT_GT(json.at("floor_mse").at("gathered").get<double>(), 0.0);
    EXPECT_EQ(json.at("floor_mse").at("emission").get<double>(), 0.0);
    EXPECT_EQ(reference.floor_mse, json.at("floor_mse").at("total").get<double>());
}

TEST_F(ReferenceStore, SaysWhatDiffersWhenItIsOfSomethingElse) {
    add_reference_samples(scene_, settings(1), folder_ / "reference");
    ReferenceSubject other = subject();
    other.max_depth = 7;
    other.samples_per_pixel = 4;
    const std::string expected =
        (folder_ / "reference").string() +
        ": this is a reference of something else: samples_per_pixel is 1 in the reference and 4 here, "
        "max_depth is 5 in the reference and 7 here";
    EXPECT_EQ(message_of([&] { check_reference(folder_ / "reference", other); }), expected);
    EXPECT_EQ(message_of([&] { load_reference(folder_ / "reference", other); }), expected);
}

TEST_F(ReferenceStore, AddsNothingToAReferenceOfSomethingElseOrOfAnotherSeed) {
    add_reference_samples(scene_, settings(1), folder_ / "reference");
    ReferenceSettings other = settings(1);
    other.max_depth = 7;
    EXPECT_NE(message_of([&] {
                  add_reference_samples(scene_, other, folder_ / "reference");
              }).find("half_a.exr: this is a half of another reference"),
              std::string::npos);
    other = settings(1);
    other.seed = 2;
    EXPECT_NE(message_of([&] {
                  add_reference_samples(scene_, other, folder_ / "reference");
              }).find("was made with seed 1; it cannot be continued with seed 2"),
              std::string::npos);
}

TEST_F(ReferenceStore, MadeByPpmItResumesAndSaysThatItIsBiased) {
    const auto by_ppm = [&](std::uint64_t samples) {
        ReferenceSettings chosen = settings(samples);
        chosen.integrator = "ppm";
        chosen.photons_per_pass = 300;
        return chosen;
    };
    const Json whole_json = add_reference_samples(scene_, by_ppm(12), folder_ / "whole");
    EXPECT_EQ(whole_json.at("estimate"), "consistent, not unbiased");
    EXPECT_EQ(whole_json.at("method"),
              "ppm, knaus-zwicker, alpha 0.6666666666666666, initial radius 1.5 footprints, 300 photons a pass");
    add_reference_samples(scene_, by_ppm(5), folder_ / "parts");
    add_reference_samples(scene_, by_ppm(7), folder_ / "parts");
    const Reference whole = load_reference(folder_ / "whole", subject());
    const Reference parts = load_reference(folder_ / "parts", subject());
    expect_near(parts.half_a, whole.half_a);
    expect_near(parts.half_b, whole.half_b);
    EXPECT_FALSE(*whole.half_a.find(gathered_layer) == *whole.half_b.find(gathered_layer));
    EXPECT_FALSE(*whole.half_a.find(direct_layer) == *whole.half_b.find(direct_layer));
    EXPECT_NE(message_of([&] {
                  add_reference_samples(scene_, settings(1), folder_ / "whole");
              }).find("was made with ppm, knaus-zwicker"),
              std::string::npos);
}

// Where there was a lock meanwhile, the file in its way would be what is refused.
TEST_F(ReferenceStore, HalvesOfAnotherReferenceAreRefusedBeforeAnythingIsWritten) {
    add_reference_samples(scene_, settings(1), folder_ / "reference");
    folder_.write("reference/lock", "combination");
    const auto refusal = [&](const ReferenceSettings& other) {
        return message_of([&] { add_reference_samples(scene_, other, folder_ / "reference"); });
    };
    ReferenceSettings other = settings(1);
    other.max_depth = 3;
    EXPECT_NE(refusal(other).find("half_a.exr: this is a half of another reference"), std::string::npos);
    other = settings(1);
    other.seed = 7;
    EXPECT_NE(refusal(other).find("half_a.exr: was made with seed 1; it cannot be continued with seed 7"),
              std::string::npos);
    EXPECT_NE(refusal(settings(1)).find("lock: is in the way"), std::string::npos);
    folder_.write("reference/reference.json", "[]");
    EXPECT_NE(refusal(settings(1)).find("reference.json: this is no reference"), std::string::npos);
}

TEST_F(ReferenceStore, LightThatNoPathFindsIsRefused) {
    const auto lit_by = [&](const std::string& kind) {
        std::string text = two_walls_scene;
        text.replace(
            text.find("</scene>"), 8,
            "<emitter type='" + kind + "'/><shape type='sphere'><bsdf type='dielectric' id='glass'/></shape></scene>");
        return build_scene(load_scene_file(folder_.write("glass.xml", text)));
    };
    ReferenceSettings by_path = settings(1);
    for (const std::string kind : {"spot", "directional", "point"})
        EXPECT_NE(message_of([&] {
                      add_reference_samples(lit_by(kind), by_path, folder_ / "reference");
                  }).find("cannot be path traced: it has a " + kind + " light and a dielectric (\"glass\")"),
                  std::string::npos)
            << kind;
    const Scene scene = lit_by("point");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "reference/half_a.exr"));
    by_path.max_depth = 2;  // no path of two edges meets a caustic
    EXPECT_EQ(add_reference_samples(scene, by_path, folder_ / "shallow").at("estimate"), "unbiased");
}

TEST_F(ReferenceStore, AnInterruptedSaveIsNoticedAndRepaired) {
    add_reference_samples(scene_, settings(4), folder_ / "whole");
    add_reference_samples(scene_, settings(3), folder_ / "longer");
    add_reference_samples(scene_, settings(2), folder_ / "torn");
    // As if the program had been stopped after half_a was replaced and before half_b and reference.json were.
    std::filesystem::copy_file(folder_ / "longer/half_a.exr", folder_ / "torn/half_a.exr",
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_NE(message_of([&] {
                  load_reference(folder_ / "torn", subject());
              }).find("half_a.exr: is not the file that reference.json was written for"),
              std::string::npos);
    EXPECT_EQ(add_reference_samples(scene_, settings(1), folder_ / "torn").at("samples_per_half"), 4u);
    const Reference repaired = load_reference(folder_ / "torn", subject());
    const Reference whole = load_reference(folder_ / "whole", subject());
    expect_near(repaired.half_a, whole.half_a);
    expect_near(repaired.half_b, whole.half_b);
}

TEST_F(ReferenceStore, AnImageOfAnotherRendererServesAsAReference) {
    const Image foreign{12, 8, {{"total", std::vector<Color>(96, Color(0.5f))}}};
    write_exr(folder_ / "foreign.exr", foreign);
    const Reference reference = load_reference(folder_ / "foreign.exr", subject());
    EXPECT_FALSE(reference.floor_mse.has_value());
    Image image{12, 8, {}};
    for (const std::string_view name : {emission_layer, direct_layer, gathered_layer})
        image.layers.push_back({std::string(name), std::vector<Color>(96, Color(0.25f))});
    const auto errors = judge(image, reference, "total", false);
    ASSERT_TRUE(errors.has_value());
    EXPECT_DOUBLE_EQ(errors->of("rmse").value(), 0.25);
    EXPECT_FALSE(errors->of("mse_unbiased"));
    EXPECT_FALSE(errors->of("reference_floor"));
    EXPECT_FALSE(judge(image, reference, "gathered", false).has_value());

    ReferenceSubject larger = subject();
    larger.width = 13;
    EXPECT_EQ(message_of([&] { load_reference(folder_ / "foreign.exr", larger); }),
              (folder_ / "foreign.exr").string() + ": this reference is 12x8, the image 13x8");
}

TEST_F(ReferenceStore, ThePictureAloneJudgesTheWholeImage) {
    add_reference_samples(scene_, settings(12), folder_ / "layers");
    add_reference_samples(scene_, settings(11), folder_ / "picture");
    ReferenceSettings last = settings(1);
    last.picture_only = true;
    add_reference_samples(scene_, last, folder_ / "picture");
    const Reference layers = load_reference(folder_ / "layers", subject());
    const Reference picture = load_reference(folder_ / "picture", subject());
    EXPECT_EQ(picture.half_a.layers.size(), 1u);
    EXPECT_NEAR(*picture.floor_mse, *layers.floor_mse, 1e-5 * *layers.floor_mse);
    const Image& judged = layers.half_a;
    EXPECT_NEAR(judge(judged, picture, "total", false)->of("mse").value(),
                judge(judged, layers, "total", false)->of("mse").value(),
                1e-4 * judge(judged, layers, "total", false)->of("mse").value());
    EXPECT_FALSE(judge(judged, picture, "gathered", false).has_value());
    EXPECT_NE(message_of([&] {
                  add_reference_samples(scene_, settings(1), folder_ / "picture");
              }).find("half_a.exr: holds the picture without its layers; nothing can be added to it"),
              std::string::npos);
}

TEST_F(ReferenceStore, AFolderWithoutOneIsRefused) {
    EXPECT_NE(message_of([&] { load_reference(folder_.path(), subject()); }).find("this is no reference"),
              std::string::npos);
    folder_.write("bad/reference.json", "{\"schema\": 1}");
    EXPECT_NE(message_of([&] { load_reference(folder_ / "bad", subject()); }).find("this is no reference"),
              std::string::npos);
    folder_.write("worse/reference.json", "not json");
    EXPECT_NE(message_of([&] { load_reference(folder_ / "worse", subject()); }).find("this is no reference"),
              std::string::npos);
}

}  // namespace
}  // namespace photonlab
