// What a scene lets the program leave out, as `photonlab info` says it.

#include "transport/camera/left_out.h"

#include <gtest/gtest.h>

#include "tests/statistical/scenes.h"

namespace photonlab::test {
namespace {

std::string left_out_of(const SceneDescription& description) {
    const Scene scene = build_scene(description);
    std::string sentences;
    for (const std::string& sentence : what_is_left_out(scene, trace_hit_points(scene, 1, 1)))
        sentences += sentence + "\n";
    return sentences;
}

TEST(LeftOut, IsAllThatADiffuseSceneWithoutTexturesDoesNotNeed) {
    const std::string left_out = left_out_of(floor_seen_at_origin(Color(0.5f)));
    EXPECT_NE(left_out.find("no mirror, no glass"), std::string::npos);
    EXPECT_NE(left_out.find("(photonmapper: 12 bytes)"), std::string::npos);
    EXPECT_NE(left_out.find("no textures"), std::string::npos);
    EXPECT_NE(left_out.find("diffuse surfaces alone"), std::string::npos);
    EXPECT_NE(left_out.find("no turn of hit points' frames (4 bytes)"), std::string::npos);
}

TEST(LeftOut, IsNothingThatAMirrorATextureOrAShineNeeds) {
    SceneDescription scene = floor_seen_at_origin(Color(0.5f));
    scene.materials.push_back({.id = "mirror", .bsdf = Conductor{}});
    scene.shapes.push_back(disk({0, 50, 0}, {0, 1, 0}, 1.0, scene.materials.size() - 1));
    EXPECT_EQ(left_out_of(scene).find("no mirror"), std::string::npos);
    scene.materials[0].textures = {textured(
        &Diffuse::reflectance,
        std::make_shared<Texture>(Bitmap{std::make_shared<ColorImage>(ColorImage{1, 1, {Color(0.5f)}}), Matrix()}))};
    EXPECT_EQ(left_out_of(scene).find("no textures"), std::string::npos);
    const auto table = std::make_shared<MerlTable>();
    scene.materials.push_back({.id = "shiny", .bsdf = Merl{table.get()}, .data = table});
    scene.shapes.push_back(disk({0, 60, 0}, {0, 1, 0}, 1.0, scene.materials.size() - 1));
    EXPECT_EQ(left_out_of(scene).find("diffuse surfaces alone"), std::string::npos);
    scene.materials.push_back(
        {.id = "brushed", .bsdf = RoughConductor{.facets = {FacetSlopes::Ggx, 0.3f, 0.1f}}, .is_anisotropic = true});
    scene.shapes.push_back(disk({0, 70, 0}, {0, 1, 0}, 1.0, scene.materials.size() - 1));
    EXPECT_EQ(left_out_of(scene).find("no turn"), std::string::npos);
}

}  // namespace
}  // namespace photonlab::test
