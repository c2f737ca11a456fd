// Materials that are made of others: what is seen of them from behind, what they may do anywhere on a surface, how
// textures turn their normals on either side, and holes where shading and geometric normal disagree.

#include <gtest/gtest.h>

#include <cmath>

#include "core/random.h"
#include "image/png.h"
#include "scene/scene.h"
#include "tests/scene/described.h"
#include "tests/scene/geometry.h"
#include "tests/scene/scene_folder.h"
#include "tests/support/layered.h"

namespace photonlab {
namespace {

Material lambertian(float reflectance, bool two_sided) {
    return {.id = "lambertian", .bsdf = Diffuse{Color(reflectance)}, .two_sided = two_sided};
}

/// A square in the plane z = 0 that faces +z, of that material.
Scene square_of(const Material& material) {
    SceneDescription description;
    description.materials = {material};
    description.shapes = {shape(square({0, 0, 0}, {4, 0, 0}, {0, 4, 0}))};
    return build_scene(description);
}

/// As a ray along the z axis sees it that comes from the side of `z`, and leaves along `outgoing`.
std::optional<Surface> seen_along_z(const Scene& scene, float z, const Vector& outgoing) {
    const auto hit = intersect(scene, {{0.01f, 0.02f, z}, {0, 0, -z}});
    return hit ? orient(scene, *hit, outgoing) : std::nullopt;
}

/// f pi at 40 degrees, for light from 20 degrees on the other side of the normal.
std::optional<float> reflectance_from(const Scene& scene, float z) {
    const Vector outgoing = at_angle(40.0);
    const auto surface = seen_along_z(scene, z, {outgoing.x, outgoing.y, z * outgoing.z});
    if (!surface) return std::nullopt;
    return evaluate(surface->bsdf, outgoing, at_angle(-20.0)).x * static_cast<float>(pi);
}

// In Mitsuba each part answers for itself: two-sided ones are seen from behind as from the front, others are black.
TEST(Composites, ShowFromBehindWhatTheirPartsShowFromBehind) {
    const Material bright = lambertian(0.8f, true);
    const Material dark = lambertian(0.2f, true);
    const Material one_sided = lambertian(0.2f, false);
    EXPECT_NEAR(reflectance_from(square_of(blended(bright, dark, 0.25f)), -1.0f).value_or(0.0f), 0.65f, 1e-6f);
    EXPECT_NEAR(reflectance_from(square_of(blended(bright, one_sided, 0.25f)), -1.0f).value_or(0.0f), 0.6f, 1e-6f);
    const Material nested = blended(blended(bright, one_sided, 0.5f), one_sided, 0.5f);
    EXPECT_NEAR(reflectance_from(square_of(nested), -1.0f).value_or(0.0f), 0.2f, 1e-6f);
    EXPECT_FALSE(reflectance_from(square_of(blended(one_sided, one_sided, 0.5f)), -1.0f));
    EXPECT_NEAR(reflectance_from(square_of(masked(bright, Color(0.5f))), -1.0f).value_or(0.0f), 0.4f, 1e-6f);
}

// coating.cpp of 0.6 has its own reflection on both sides.
TEST(Composites, AreCoatedFromBehindToo) {
    const Scene both = square_of(coated(lambertian(0.8f, true)));
    ASSERT_TRUE(reflectance_from(both, -1.0f));
    EXPECT_EQ(*reflectance_from(both, -1.0f), *reflectance_from(both, 1.0f));
    const Scene one = square_of(coated(lambertian(0.8f, false)));
    EXPECT_EQ(reflectance_from(one, -1.0f).value_or(1.0f), 0.0f);
    const auto behind = seen_along_z(one, -1.0f, Vector(0.6f, 0.0f, -0.8f));
    ASSERT_TRUE(behind);
    const SpecularBranches branches = specular_branches(behind->bsdf, {0.6f, 0.0f, 0.8f}, Carried::Radiance);
    ASSERT_EQ(branches.count, 1);
    EXPECT_NEAR(branches.branch[0].weight.x, fresnel_dielectric(0.8, 1.0 / 1.5).reflected, 1e-6);
}

// ---------------------------------------------------------------------------------------------------------------------
// What a material may do is asked without a place: an image that is black, or opaque, at its corner says nothing.

class CompositeFiles : public SceneFolderTest {
protected:
    /// 2 x 2 pixels, of which the first is `corner` and the others are `rest`.
    void write_image(const std::string& name, double corner, double rest) const {
        std::vector<ColorD> pixels(4, ColorD(rest));
        pixels[0] = ColorD(corner);
        write_png(folder_ / name, 2, 2, pixels);
    }
    static std::string texture(const std::string& name, const std::string& file) {
        return "<texture type='bitmap' name='" + name + "'><string name='filename' value='" + file +
               "'/><string name='filterType' value='nearest'/></texture>";
    }
    Material material(const std::string& version, const std::string& bsdf) const {
        const auto scene = load_as(version, "<shape type='rectangle'>" + bsdf + "</shape>");
        return scene.materials.at(scene.shapes.at(0).material);
    }
};

TEST_F(CompositeFiles, MayScatterWhereAnImageIsNotBlack) {
    write_image("black.png", 0.0, 1.0);
    const Material coating = material(
        "0.6.0", "<bsdf type='coating'><bsdf type='diffuse'>" + texture("reflectance", "black.png") + "</bsdf></bsdf>");
    EXPECT_FALSE(is_scattering(bsdf_at(coating, {0.1f, 0.1f}, false)));
    EXPECT_TRUE(is_scattering(bsdf_at(coating, {0.9f, 0.9f}, false)));
    EXPECT_TRUE(may_scatter(coating));
    EXPECT_TRUE(may_look_different_from_elsewhere(coating));
}

TEST_F(CompositeFiles, MayBeSpecularWhereAnImageIsNotOpaque) {
    write_image("opaque.png", 1.0, 0.0);
    const Material blend =
        material("0.6.0", "<bsdf type='blendbsdf'><bsdf type='mask'>" + texture("opacity", "opaque.png") +
                              "<bsdf type='diffuse'/></bsdf><bsdf type='diffuse'/></bsdf>");
    EXPECT_FALSE(is_specular(bsdf_at(blend, {0.1f, 0.1f}, false)));
    EXPECT_TRUE(is_specular(bsdf_at(blend, {0.9f, 0.9f}, false)));
    EXPECT_TRUE(may_be_specular(blend));
}

TEST_F(CompositeFiles, MayDoWhatOneOfTheirPartsDoesBehind) {
    const Material mask =
        material("0.6.0",
                 "<bsdf type='mask'><float name='opacity' value='1'/><bsdf type='twosided'><bsdf type='diffuse'/><bsdf "
                 "type='conductor'/></bsdf></bsdf>");
    EXPECT_TRUE(is_specular(bsdf_at(mask, {0, 0}, true)));
    EXPECT_TRUE(may_be_specular(mask));
    EXPECT_TRUE(may_scatter(mask));
}

// ---------------------------------------------------------------------------------------------------------------------

// Mitsuba evaluates nothing below where light is reflected wholly.
TEST(Composites, HaveNoDensityBeyondTotalReflectionByTheirCoat) {
    const Material bubble = made_of({grey}, [](const auto& parts) {
        Coating coating;
        coating.inner.material = &parts[0];
        coating.index_inside = 1.0f;
        coating.index_outside = 1.5f;
        return Bsdf(coating);
    });
    EXPECT_EQ(density(bubble.bsdf, at_angle(60.0), at_angle(10.0)), 0.0f);
    EXPECT_EQ(density(bubble.bsdf, at_angle(10.0), at_angle(60.0)), 0.0f);
    Material dull = bubble;
    std::get<Coating>(dull.bsdf).specular_reflectance = Color(0.0f);
    EXPECT_EQ(density(dull.bsdf, at_angle(60.0), at_angle(10.0)), 0.0f);
    for (const float u : {0.0f, 0.5f, 0.99f}) {
        const auto drawn = sample(dull.bsdf, at_angle(60.0), Carried::Radiance, {u, 0.5f});
        EXPECT_TRUE(!drawn || is_finite(drawn->weight)) << u;
    }
    const Material blend = blended(grey, bubble, 0.5f);
    EXPECT_NEAR(density(blend.bsdf, at_angle(60.0), at_angle(10.0)), 0.5 * std::cos(10.0 * pi / 180.0) / pi, 1e-6);
}

TEST(Composites, HaveADensityWhereAPartIsABlackPhong) {
    const Phong black{.colors = {.diffuse_reflectance = Color(0.0f), .specular_reflectance = Color(0.0f)}};
    const Material blend = blended(grey, {.id = "black", .bsdf = black}, 0.5f);
    EXPECT_TRUE(std::isfinite(density(blend.bsdf, at_angle(60.0), at_angle(10.0))));
}

// f cos over the density of both parts is the blend's reflectance, whichever was drawn.
TEST(Composites, OfDiffusePartsWeighAllSamplesAlike) {
    const Material blend = blended(lambertian(0.2f, false), lambertian(0.8f, false), 0.5f);
    RandomStream random(1, RandomPurpose::Test, 0, 0);
    for (int i = 0; i < 50; ++i) {
        const auto drawn = sample(blend.bsdf, at_angle(30.0), Carried::Flux, random.next_2d());
        ASSERT_TRUE(drawn);
        EXPECT_NEAR(drawn->weight.x, 0.5f, 1e-5f);
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// Normals that a texture turns, and which of them is seen from behind.

const Vector leaning = Vector(0.6f, 0.0f, 0.8f);

/// One normal everywhere: that, in the axes of the square.
NormalTexture normals_that_lean() {
    const Color color(0.5f * leaning.x + 0.5f, 0.5f * leaning.y + 0.5f, 0.5f * leaning.z + 0.5f);
    return {std::make_shared<const Texture>(Checkerboard{color, color}), false, 1.0};
}

class TurnedNormals : public SceneFolderTest {
protected:
    void SetUp() override {
        SceneFolderTest::SetUp();
        write_png(
            folder_ / "lean.png", 1, 1,
            {ColorD(srgb_to_linear(204.0 / 255.0), srgb_to_linear(127.5 / 255.0), srgb_to_linear(230.0 / 255.0))});
    }
    static std::string lean(const std::string& inside) {
        return "<bsdf type='normalmap'><texture type='bitmap' name='normalmap'><string name='filename' "
               "value='lean.png'/><boolean name='raw' value='true'/></texture>" +
               inside + "</bsdf>";
    }
    Vector normal_behind(const std::string& bsdf) const {
        const Scene scene = build_scene(load_as("3.0.0", "<shape type='rectangle'>" + bsdf + "</shape>"));
        const auto surface = seen_along_z(scene, -1.0f, {0.0f, 0.0f, -1.0f});
        return surface ? surface->frame.normal : Vector(0.0f);
    }
    void expect_normal_behind(const std::string& bsdf, const Vector& expected) const {
        const Vector normal = normal_behind(bsdf);
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(normal[i], expected[i], 0.01f) << bsdf;
    }
};

// twosided mirrors directions in the surface and asks what is inside from the front; a map around it asks what is
// inside for directions about its own normal.
TEST_F(TurnedNormals, FromBehindAreMirroredInTwoSidedAndOppositeAroundIt) {
    const std::string grey_bsdf = "<bsdf type='diffuse'/>";
    const auto two_sided = [](const std::string& inside) { return "<bsdf type='twosided'>" + inside + "</bsdf>"; };
    const Vector mirrored_normal(leaning.x, leaning.y, -leaning.z);
    expect_normal_behind(two_sided(lean(grey_bsdf)), mirrored_normal);
    expect_normal_behind(lean(two_sided(grey_bsdf)), -leaning);
    expect_normal_behind(lean(two_sided(grey_bsdf + "<bsdf type='plastic'/>")), -leaning);
    expect_normal_behind(two_sided(grey_bsdf + lean("<bsdf type='plastic'/>")), mirrored_normal);
    expect_normal_behind(two_sided(lean(grey_bsdf) + "<bsdf type='plastic'/>"), {0, 0, -1});
}

TEST_F(TurnedNormals, OfAMaskAreThoseOfThatSideOfItsPart) {
    const std::string sides =
        "<bsdf type='twosided'>" + lean("<bsdf type='diffuse'/>") + "<bsdf type='plastic'/></bsdf>";
    expect_normal_behind("<bsdf type='mask'>" + sides + "</bsdf>", {0, 0, -1});
}

TEST_F(TurnedNormals, SayWhatMitsubaDoesAtGrazingAngles) {
    const auto scene = load_as("3.0.0", "<shape type='rectangle'>" + lean("<bsdf type='diffuse'/>") + "</shape>");
    std::string notes;
    for (const std::string& note : scene.notes) notes += note + "\n";
    EXPECT_NE(notes.find("rendered without flip_invalid_normals and use_shadowing_function"), std::string::npos);
}

// Seen from the side to which its normals do not lean, at 75 degrees: what is not opaque lets light straight through
// whatever the normal, and nothing else is there.
TEST(Holes, StayOpenWhereShadingAndGeometricNormalDisagree) {
    Material mask = masked(grey, Color(0.3f, 0.4f, 0.5f));
    mask.normals = normals_that_lean();
    const Vector outgoing = at_angle(-75.0);
    ASSERT_LT(outgoing.dot(leaning), 0.0f);
    const auto surface = seen_along_z(square_of(mask), 1.0f, outgoing);
    ASSERT_TRUE(surface);
    EXPECT_FALSE(is_scattering(surface->bsdf));
    const SpecularBranches branches =
        specular_branches(surface->bsdf, surface->frame.to_local(outgoing), Carried::Radiance);
    ASSERT_EQ(branches.count, 1);
    EXPECT_NEAR((surface->frame.to_world(branches.branch[0].incoming) + outgoing).length(), 0.0f, 1e-6f);
    EXPECT_TRUE(sides_agree(*surface, -outgoing));
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(branches.branch[0].weight[channel], 0.7f - 0.1f * static_cast<float>(channel), 1e-6f);

    Material opaque = grey;
    opaque.normals = normals_that_lean();
    EXPECT_FALSE(seen_along_z(square_of(opaque), 1.0f, outgoing));
}

}  // namespace
}  // namespace photonlab
