// Rough and layered materials, textures and films as scene files have them, in the spelling of 0.6 and of 3.

#include <gtest/gtest.h>

#include "image/png.h"
#include "scene/scene.h"
#include "tests/scene/described.h"
#include "tests/scene/scene_folder.h"

namespace photonlab {
namespace {

/// The image whose bytes these are, three a pixel.
void write_bytes(const std::filesystem::path& file, int width, int height, const std::vector<std::uint8_t>& bytes) {
    std::vector<ColorD> pixels;
    for (std::size_t i = 0; i + 2 < bytes.size(); i += 3)
        pixels.emplace_back(srgb_to_linear(bytes[i] / 255.0), srgb_to_linear(bytes[i + 1] / 255.0),
                            srgb_to_linear(bytes[i + 2] / 255.0));
    write_png(file, width, height, pixels);
}

class LayeredFiles : public SceneFolderTest {
protected:
    Material material(const std::string& version, const std::string& bsdf) const {
        const auto scene = load_as(version, "<shape type='rectangle'>" + bsdf + "</shape>");
        return scene.materials.at(scene.shapes.at(0).material);
    }
    template <typename Kind>
    Kind bsdf(const std::string& version, const std::string& text) const {
        return std::get<Kind>(material(version, text).bsdf);
    }
    std::string refusal_of(const std::string& version, const std::string& bsdf) const {
        return message_of("<scene version='" + version + "'><sensor type='perspective'/>\n" + bsdf + "</scene>");
    }
};

TEST_F(LayeredFiles, HaveMitsubasDefaults) {
    const auto old_metal = bsdf<RoughConductor>("0.6.0", "<bsdf type='roughconductor'/>");
    EXPECT_EQ(old_metal.facets.slopes, FacetSlopes::Beckmann);
    EXPECT_EQ(old_metal.facets.alpha_u, 0.1f);
    EXPECT_NEAR(old_metal.eta.x, 0.200438 / 1.000277, 1e-6) << "copper in air";
    EXPECT_EQ(bsdf<RoughConductor>("3.0.0", "<bsdf type='roughconductor'/>").eta, Color(0.0f)) << "a white mirror";
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        EXPECT_NEAR(bsdf<Plastic>(version, "<bsdf type='plastic'/>").index_inside, 1.49f, 1e-6f);
        EXPECT_NEAR(bsdf<RoughPlastic>(version, "<bsdf type='roughplastic'/>").index_inside, 1.49f, 1e-6f);
        EXPECT_NEAR(bsdf<RoughDielectric>(version, "<bsdf type='roughdielectric'/>").index_beyond, 1.5046f, 1e-6f);
        EXPECT_NEAR(bsdf<ThinDielectric>(version, "<bsdf type='thindielectric'/>").index_inside, 1.5046f, 1e-6f);
        EXPECT_EQ(bsdf<Mask>(version, "<bsdf type='mask'><bsdf type='diffuse'/></bsdf>").opacity, Color(0.5f));
    }
    EXPECT_EQ(bsdf<Phong>("0.6.0", "<bsdf type='phong'/>").colors.specular_reflectance, Color(0.2f));
}

TEST_F(LayeredFiles, HaveWardOf06) {
    const auto ward = bsdf<Ward>("0.6.0", "<bsdf type='ward'/>");
    EXPECT_EQ(ward.facets.alpha_u, 0.1f);
    EXPECT_EQ(ward.form, WardForm::Balanced);
    EXPECT_EQ(ward.colors.specular_reflectance, Color(0.2f));
    const Material brushed = material("0.6.0",
                                      "<bsdf type='ward'><string name='variant' value='ward-duer'/><float name='alpha' "
                                      "value='0.3'/><float name='alphaV' value='0.05'/></bsdf>");
    EXPECT_EQ(std::get<Ward>(brushed.bsdf).facets.alpha_u, 0.3f);
    EXPECT_EQ(std::get<Ward>(brushed.bsdf).facets.alpha_v, 0.05f);
    EXPECT_EQ(std::get<Ward>(brushed.bsdf).form, WardForm::Duer);
    EXPECT_TRUE(brushed.is_anisotropic);
    EXPECT_NE(refusal_of("0.6.0", "<bsdf type='ward'><string name='variant' value='wardd'/></bsdf>")
                  .find("unknown variant \"wardd\"; did you mean \"ward\"?"),
              std::string::npos);
}

TEST_F(LayeredFiles, MeanTheSameInBothSpellings) {
    const auto same = [&](const std::string& old_text, const std::string& text) {
        const Material old_material = material("0.6.0", old_text);
        const Material new_material = material("3.0.0", text);
        const Bsdf& a = old_material.bsdf;
        const Bsdf& b = new_material.bsdf;
        ASSERT_EQ(a.index(), b.index());
        const Vector out = Vector(0.3f, -0.2f, 0.9f).normalized();
        for (const Vector& in : {Vector(-0.3f, 0.2f, 0.9f), Vector(0.1f, 0.5f, 0.4f), Vector(0.2f, 0.1f, -0.8f)}) {
            const Vector unit = in.normalized();
            EXPECT_EQ(evaluate(a, out, unit), evaluate(b, out, unit));
            EXPECT_EQ(density(a, out, unit), density(b, out, unit));
        }
    };
    same(
        "<bsdf type='roughconductor'><string name='material' value='Au'/><float name='extEta' value='1'/><string "
        "name='distribution' value='ggx'/><float name='alpha' value='0.3'/></bsdf>",
        "<bsdf type='roughconductor'><string name='material' value='Au'/><string name='distribution' value='ggx'/>"
        "<float name='alpha' value='0.3'/></bsdf>");
    same(
        "<bsdf type='roughdielectric'><float name='intIOR' value='1.5'/><string name='extIOR' value='air'/>"
        "<float name='alphaU' value='0.2'/><float name='alphaV' value='0.2'/></bsdf>",
        "<bsdf type='roughdielectric'><float name='int_ior' value='1.5'/><string name='ext_ior' value='air'/>"
        "<float name='alpha' value='0.2'/></bsdf>");
    same("<bsdf type='mask'><rgb name='opacity' value='0.3'/><bsdf type='diffuse'/></bsdf>",
         "<bsdf type='mask'><float name='opacity' value='0.3'/><bsdf type='diffuse'/></bsdf>");
    same(
        "<bsdf type='blendbsdf'><float name='weight' value='0.3'/><bsdf type='diffuse'/><bsdf type='roughconductor'>"
        "<float name='extEta' value='1'/><string name='material' value='Al'/></bsdf></bsdf>",
        "<bsdf type='blendbsdf'><float name='weight' value='0.3'/><bsdf type='diffuse'/><bsdf type='roughconductor'>"
        "<string name='material' value='Al'/></bsdf></bsdf>");
}

// In 0.6 the weights of a mixture are of its nested materials in their order, and what lacks to 1 is black.
TEST_F(LayeredFiles, MixTheirPartsByTheirWeights) {
    const std::string parts =
        "<bsdf type='diffuse'><rgb name='reflectance' value='1 0 0'/></bsdf><bsdf type='diffuse'><rgb "
        "name='reflectance' value='0 1 0'/></bsdf><bsdf type='diffuse'><rgb name='reflectance' value='0 0 1'/></bsdf>";
    const auto f = [&](const std::string& weights) {
        const Material mixed = material(
            "0.6.0", "<bsdf type='mixturebsdf'><string name='weights' value='" + weights + "'/>" + parts + "</bsdf>");
        return evaluate(bsdf_at(mixed, {0, 0}, false), {0, 0, 1}, {0, 0, 1}) * static_cast<float>(pi);
    };
    const auto near = [](const Color& a, const Color& b) {
        for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-6f);
    };
    near(f("0.2, 0.3, 0.1"), {0.2f, 0.3f, 0.1f});
    near(f("1 2 1"), {0.25f, 0.5f, 0.25f});
    EXPECT_EQ(
        refusal_of("0.6.0", "<bsdf type='mixturebsdf'><string name='weights' value='0 0 0'/>" + parts + "</bsdf>"),
        "scene.xml:2: mixturebsdf: expected weights that add up to more than 0, got \"0 0 0\"");
    EXPECT_EQ(refusal_of("0.6.0", "<bsdf type='mixturebsdf'><string name='weights' value='1'/>" + parts + "</bsdf>"),
              "scene.xml:2: mixturebsdf: expected 1 nested bsdf, got 3");
}

TEST_F(LayeredFiles, AreNotScaledWhereTheyForbidIt) {
    const auto refusal = [&](const std::string& kind, const std::string& inside, const std::string& value) {
        return refusal_of("0.6.0", "<bsdf type='" + kind + "'><boolean name='ensureEnergyConservation' value='" +
                                       value + "'/>" + inside + "</bsdf>");
    };
    const std::string bright = "<rgb name='reflectance' value='1.2 0.5 0.5'/>";
    EXPECT_EQ(refusal("diffuse", bright, "true"), "no error");
    EXPECT_EQ(refusal("diffuse", "<rgb name='reflectance' value='0.5'/>", "false"), "no error");
    EXPECT_NE(refusal("diffuse", bright, "false").find("reflectance is 1.2, and ensureEnergyConservation is false"),
              std::string::npos);
    EXPECT_NE(refusal("mixturebsdf", "<string name='weights' value='1 1'/><bsdf type='diffuse'/><bsdf type='diffuse'/>",
                      "false")
                  .find("the sum of the weights is 2"),
              std::string::npos);
}

// 0.6 scales both by 0.99 over the largest sum of their largest values, image or not: the image is 0 and 1.
TEST_F(LayeredFiles, OfPhongAreScaledByTheSumOfTheirLargestValues) {
    write_bytes(folder_ / "two.png", 2, 1, {0, 0, 0, 255, 255, 255});
    const Phong plain = bsdf<Phong>("0.6.0",
                                    "<bsdf type='phong'><rgb name='diffuseReflectance' value='1.2'/><rgb "
                                    "name='specularReflectance' value='0.2'/></bsdf>");
    EXPECT_NEAR(plain.colors.diffuse_reflectance.x, 1.2 * 0.99 / 1.4, 1e-6);
    EXPECT_NEAR(plain.colors.specular_reflectance.x, 0.2 * 0.99 / 1.4, 1e-6);
    const Material textured = material("0.6.0",
                                       "<bsdf type='phong'><texture name='diffuseReflectance' type='bitmap'><string "
                                       "name='filename' value='two.png'/></texture><rgb name='specularReflectance' "
                                       "value='0.2'/></bsdf>");
    const auto at = [&](float u) { return std::get<Phong>(bsdf_at(textured, {u, 0.5f}, false)); };
    EXPECT_NEAR(at(0.75f).colors.diffuse_reflectance.x, 0.99 / 1.2, 1e-6);
    EXPECT_NEAR(at(0.25f).colors.diffuse_reflectance.x, 0.0, 1e-6);
    EXPECT_NEAR(at(0.25f).colors.specular_reflectance.x, 0.2 * 0.99 / 1.2, 1e-6);
}

// Both clamp the weight of a blend; 0.6 takes the mean of a texture's channels, 3 their brightness.
TEST_F(LayeredFiles, OfBlendsHaveTheirWeightsClampedAndAsOneNumber) {
    const std::string parts = "<bsdf type='diffuse'/><bsdf type='diffuse'/></bsdf>";
    write_bytes(folder_ / "green.png", 1, 1, {0, 255, 0});
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        const auto constant = [&](const std::string& weight) {
            return bsdf<Blend>(version, "<bsdf type='blendbsdf'><float name='weight' value='" + weight + "'/>" + parts)
                .weight;
        };
        EXPECT_EQ(constant("1.5"), 1.0f);
        EXPECT_EQ(constant("-0.5"), 0.0f);
        const Material green = material(version,
                                        "<bsdf type='blendbsdf'><texture name='weight' type='bitmap'><string "
                                        "name='filename' value='green.png'/></texture>" +
                                            parts);
        EXPECT_NEAR(std::get<Blend>(bsdf_at(green, {0.5f, 0.5f}, false)).weight,
                    version == "0.6.0" ? 1.0 / 3.0 : 0.71516, 1e-5);
    }
}

TEST_F(LayeredFiles, OfManyPartsAreRefusedBeforeTheyAreRead) {
    std::string inside = "<bsdf type='diffuse' id='m0'/>";
    for (int level = 1; level <= 16; ++level) {
        std::string weights, parts;
        for (int i = 0; i < 10; ++i) {
            weights += " 0.1";
            parts += "<ref id='m" + std::to_string(level - 1) + "'/>";
        }
        inside += "\n<bsdf type='mixturebsdf' id='m" + std::to_string(level) + "'><string name='weights' value='" +
                  weights + "'/>" + parts + "</bsdf>";
    }
    EXPECT_NE(refusal_of("0.6.0", inside + "<shape type='sphere'><ref id='m16'/></shape>")
                  .find("expected at most 256 bsdfs inside one"),
              std::string::npos);
}

TEST_F(LayeredFiles, ShareTheRoughCoatsThatAreTheSame) {
    const auto scene =
        load_as("0.6.0",
                "<shape type='sphere'><bsdf type='roughplastic'/></shape><shape type='sphere'><bsdf "
                "type='roughplastic'><rgb name='diffuseReflectance' value='0.1'/></bsdf></shape><shape "
                "type='sphere'><bsdf type='roughplastic'><float name='alpha' value='0.2'/></bsdf></shape>");
    const auto coat = [&](std::size_t i) { return std::get<RoughPlastic>(scene.materials.at(i).bsdf).coats; };
    EXPECT_EQ(coat(0), coat(1));
    EXPECT_NE(coat(0), coat(2));
}

TEST_F(LayeredFiles, OfTwoSidesShowEachItsOwn) {
    const Material both = material("3.0.0",
                                   "<bsdf type='twosided'><bsdf type='diffuse'><rgb name='reflectance' value='1 0 "
                                   "0'/></bsdf><bsdf type='plastic'/></bsdf>");
    EXPECT_TRUE(std::holds_alternative<Diffuse>(bsdf_at(both, {0, 0}, false)));
    EXPECT_TRUE(std::holds_alternative<Plastic>(bsdf_at(both, {0, 0}, true)));
    EXPECT_TRUE(may_be_specular(both));
    EXPECT_TRUE(both.two_sided);
}

TEST_F(LayeredFiles, ReadPastWhatIsOtherPrograms) {
    const auto scene = load_as("0.6.0",
                               "<shape type='rectangle'><boolean name='caustic_caster' value='true'/><bsdf "
                               "type='dielectric'><float name='alpha' value='0.1'/></bsdf></shape>");
    ASSERT_GE(scene.notes.size(), 2u);
    EXPECT_NE(scene.notes[0].find("bsdf \"dielectric\": not read: alpha: it is smooth"), std::string::npos)
        << scene.notes[0];
    EXPECT_NE(scene.notes[1].find("shape \"rectangle\": not read: caustic_caster"), std::string::npos)
        << scene.notes[1];
}

TEST_F(LayeredFiles, NameTheNearestKnownThing) {
    EXPECT_NE(refusal_of("3.0.0", "<bsdf type='roughconductr'/>")
                  .find("unknown bsdf \"roughconductr\"; did you mean "
                        "\"roughconductor\"? Known here: "),
              std::string::npos);
    EXPECT_NE(refusal_of("3.0.0", "<bsdf type='plastic'><float name='int_io' value='1'/></bsdf>")
                  .find("unknown property \"int_io\" of bsdf \"plastic\"; did you mean \"int_ior\"?"),
              std::string::npos);
    EXPECT_NE(refusal_of("3.0.0", "<medium type='homogeneous'/>").find("scene.xml:2: participating media"),
              std::string::npos);
    EXPECT_EQ(refusal_of("3.0.0",
                         "<bsdf type='roughplastic' id='coat'>\n<float name='alpha_u' value='0.1'/>\n<float "
                         "name='alpha_v' value='0.2'/></bsdf>"),
              "scene.xml:2: roughplastic: expected the same roughness in all directions");
    EXPECT_EQ(refusal_of("3.0.0", "<bsdf type='roughconductor'><float name='alpha_u' value='0.1'/></bsdf>"),
              "scene.xml:2: roughconductor: expected alpha, or alpha_u and alpha_v");
}

// ---------------------------------------------------------------------------------------------------------------------
// Textures

class TexturesInFiles : public LayeredFiles {
protected:
    /// 2 x 1 pixels: black and white.
    void write_image() const { write_bytes(folder_ / "two.png", 2, 1, {0, 0, 0, 255, 255, 255}); }

    Texture texture(const std::string& version, const std::string& plugin) const {
        write_image();
        const Material found = material(version, "<bsdf type='diffuse'>" + plugin + "</bsdf>");
        return *found.textures.at(0).texture;
    }
    float value(const std::string& version, const std::string& type, const std::string& inside, float u) const {
        return color_at(texture(version, "<texture type='" + type + "' name='reflectance'>" + inside + "</texture>"),
                        {u, 0.5f})
            .x;
    }
};

const std::string two_pixels = "<string name='filename' value='two.png'/>";

TEST_F(TexturesInFiles, WrapAndFilterAsTheySay) {
    const auto wrapped = [&](const std::string& mode, float u) {
        return value("3.0.0", "bitmap", two_pixels + "<string name='wrap_mode' value='" + mode + "'/>", u);
    };
    EXPECT_NEAR(wrapped("repeat", 0.25f), 0.0, 1e-6);
    EXPECT_NEAR(wrapped("repeat", 0.75f), 1.0, 1e-6);
    EXPECT_NEAR(wrapped("repeat", 1.25f), 0.0, 1e-6);
    EXPECT_NEAR(wrapped("repeat", 0.0f), 0.5, 1e-6) << "between the last pixel and the first";
    EXPECT_NEAR(wrapped("clamp", 0.0f), 0.0, 1e-6);
    EXPECT_NEAR(wrapped("clamp", 7.0f), 1.0, 1e-6);
    EXPECT_NEAR(wrapped("clamp", -7.0f), 0.0, 1e-6);
    EXPECT_NEAR(wrapped("mirror", 1.25f), 1.0, 1e-6);
    EXPECT_NEAR(wrapped("mirror", 1.75f), 0.0, 1e-6);
    EXPECT_NEAR(wrapped("mirror", -0.25f), 0.0, 1e-6);
    const std::string nearest = two_pixels + "<string name='filter_type' value='nearest'/>";
    EXPECT_EQ(value("3.0.0", "bitmap", nearest, 0.49f), 0.0f);
    EXPECT_EQ(value("3.0.0", "bitmap", nearest, 0.51f), 1.0f);
    EXPECT_EQ(value("0.6.0", "bitmap", two_pixels + "<string name='wrapModeU' value='one'/>", 5.0f), 1.0f);
    EXPECT_EQ(value("0.6.0", "bitmap", two_pixels + "<string name='wrapMode' value='zero'/>", 5.0f), 0.0f);
}

TEST_F(TexturesInFiles, AreDecodedByTheirGamma) {
    write_bytes(folder_ / "grey.png", 1, 1, {128, 128, 128});
    const auto decoded = [&](const std::string& gamma) {
        return value("0.6.0", "bitmap",
                     "<string name='filename' value='grey.png'/><float name='gamma' value='" + gamma + "'/>", 0.5f);
    };
    EXPECT_NEAR(decoded("1"), 128.0 / 255.0, 1e-6);
    EXPECT_NEAR(decoded("2.2"), std::pow(128.0 / 255.0, 2.2), 1e-6);
    EXPECT_NEAR(decoded("0"), srgb_to_linear(128.0 / 255.0), 1e-6);
    EXPECT_NEAR(decoded("-1"), srgb_to_linear(128.0 / 255.0), 1e-6);
}

TEST_F(TexturesInFiles, ShareTheImagesThatTheyLookUp) {
    write_image();
    const std::string bsdf =
        "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'>" + two_pixels + "</texture></bsdf>";
    const auto scene =
        load_as("3.0.0", "<shape type='sphere'>" + bsdf + "</shape><shape type='sphere'>" + bsdf + "</shape>");
    const auto image = [&](std::size_t i) {
        return std::get<Bitmap>(*scene.materials.at(i).textures.at(0).texture).image;
    };
    EXPECT_EQ(image(0), image(1));
}

// Both have color0 where the halves are the same. (int)(2 u) of 0.6 is 0 from -1/2 to 1/2.
TEST_F(TexturesInFiles, OfCheckerboardsBeginWithTheFirstColour) {
    const auto at = [&](const std::string& version, float u, float v) {
        return color_at(texture(version, "<texture type='checkerboard' name='reflectance'/>"), {u, v}).x;
    };
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        EXPECT_EQ(at(version, 0.25f, 0.25f), 0.4f);
        EXPECT_EQ(at(version, 0.75f, 0.25f), 0.2f);
        EXPECT_EQ(at(version, 0.75f, 0.75f), 0.4f);
    }
    EXPECT_EQ(at("3.0.0", 0.25f, -0.25f), 0.2f);
    EXPECT_EQ(at("0.6.0", 0.25f, -0.25f), 0.4f);
    EXPECT_EQ(at("0.6.0", 0.25f, -0.75f), 0.2f);
    EXPECT_EQ(at("0.6.0", 0.25f, -1.25f), 0.4f);
}

// eval_1() of Mitsuba 3's checkerboard has them the other way around than its eval(); 0.6 has one way alone.
TEST_F(TexturesInFiles, OfCheckerboardsAreTheOtherWayAroundAsNumbersIn3) {
    const std::string board =
        "<texture type='checkerboard' name='weight'><rgb name='color0' value='0.4'/><rgb "
        "name='color1' value='0.2'/></texture>";
    const auto weight = [&](const std::string& version) {
        const Material blend = material(
            version, "<bsdf type='blendbsdf'>" + board + "<bsdf type='diffuse'/><bsdf type='diffuse'/></bsdf>");
        return std::get<Blend>(bsdf_at(blend, {0.25f, 0.25f}, false)).weight;
    };
    EXPECT_NEAR(weight("0.6.0"), 0.4f, 1e-6f);
    EXPECT_NEAR(weight("3.0.0"), 0.2f, 1e-6f);
}

TEST_F(TexturesInFiles, AreScaled) {
    write_image();
    EXPECT_NEAR(value("0.6.0", "scale",
                      "<float name='scale' value='0.25'/><texture type='bitmap'>" + two_pixels + "</texture>", 0.75f),
                0.25, 1e-6);
    EXPECT_NEAR(value("0.6.0", "scale", "<rgb name='value' value='0.5'/><rgb name='scale' value='0.5'/>", 0.75f), 0.25,
                1e-6);
}

// A factor above 1 is right where what it scales is dark enough.
TEST_F(TexturesInFiles, AreScaledUpToAReflectance) {
    write_image();
    const auto refusal = [&](const std::string& factor, const std::string& inside) {
        return message_of(
            "<scene version='0.6.0'><sensor type='perspective'/><bsdf type='diffuse'>\n<texture "
            "type='scale' name='reflectance'><float name='scale' value='" +
            factor + "'/>" + inside + "</texture></bsdf></scene>");
    };
    const std::string board = "<texture type='checkerboard'/>";
    EXPECT_EQ(refusal("2", board), "no error");
    EXPECT_EQ(refusal("3", board), "scene.xml:2: scale: expected reflectances in [0, 1], got values from 0.6 to 1.2");
    EXPECT_EQ(refusal("2", "<texture type='bitmap'>" + two_pixels + "</texture>").substr(0, 19), "scene.xml:2: scale:");
    EXPECT_EQ(refusal("4", "<texture type='scale'><float name='scale' value='0.5'/>" + board + "</texture>"),
              "no error");
    EXPECT_EQ(refusal("-1", board).substr(0, 19), "scene.xml:2: scale:");
}

// What other programs add is read past where they add it, and nowhere else.
TEST_F(TexturesInFiles, AndOtherPluginsHaveNoPropertiesOfOthers) {
    EXPECT_EQ(message_of("<scene version='3.0.0'><sensor type='perspective'/>\n<bsdf type='diffuse'>"
                         "<boolean name='srgb' value='true'/></bsdf></scene>")
                  .substr(0, 57),
              "scene.xml:2: unknown property \"srgb\" of bsdf \"diffuse\"; k");
    EXPECT_EQ(message_of("<scene version='3.0.0'><sensor type='perspective'/>\n<shape type='sphere'>"
                         "<boolean name='sample_visible' value='true'/></shape></scene>")
                  .substr(0, 62),
              "scene.xml:2: unknown property \"sample_visible\" of shape \"spher");
    const auto scene = load_as("3.0.0",
                               "<shape type='sphere'><boolean name='caustic_caster' value='true'/></shape>"
                               "<bsdf type='diffuse'><boolean name='use_path_guiding' value='true'/></bsdf>");
    EXPECT_EQ(scene.notes.size(), 2u);
}

TEST_F(TexturesInFiles, GiveRoughnessOpacityAndWeight) {
    write_image();
    const std::string map = "<texture type='bitmap' name='NAME'>" + two_pixels + "</texture>";
    const auto named = [&](const std::string& name) {
        std::string text = map;
        return text.replace(text.find("NAME"), 4, name);
    };
    const Material rough = material("3.0.0", "<bsdf type='roughconductor'>" + named("alpha") + "</bsdf>");
    EXPECT_EQ(std::get<RoughConductor>(bsdf_at(rough, {0.75f, 0.5f}, false)).facets.alpha_u, 1.0f);
    EXPECT_EQ(std::get<RoughConductor>(bsdf_at(rough, {0.25f, 0.5f}, false)).facets.alpha_u, smallest_roughness);
    const Material plastic = material("0.6.0", "<bsdf type='roughplastic'>" + named("alpha") + "</bsdf>");
    EXPECT_EQ(std::get<RoughPlastic>(bsdf_at(plastic, {0.75f, 0.5f}, false)).facets.alpha_u, 1.0f);
    EXPECT_EQ(std::get<RoughPlastic>(bsdf_at(plastic, {0.25f, 0.5f}, false)).facets.alpha_v, smallest_roughness);
    EXPECT_FALSE(plastic.is_anisotropic);
    EXPECT_THROW(material("3.0.0", "<bsdf type='roughplastic'>" + named("alpha") + "</bsdf>"), InputError);
    const Material mask = material("0.6.0", "<bsdf type='mask'>" + named("opacity") + "<bsdf type='diffuse'/></bsdf>");
    EXPECT_FALSE(is_scattering(bsdf_at(mask, {0.25f, 0.5f}, false)));
    EXPECT_FALSE(is_specular(bsdf_at(mask, {0.75f, 0.5f}, false)));
    EXPECT_TRUE(is_specular(mask.bsdf) && is_scattering(mask.bsdf)) << "before it is known where";
    const Material blend = material(
        "3.0.0", "<bsdf type='blendbsdf'>" + named("weight") + "<bsdf type='diffuse'/><bsdf type='conductor'/></bsdf>");
    EXPECT_TRUE(is_specular(bsdf_at(blend, {0.75f, 0.5f}, false)));
    EXPECT_FALSE(is_specular(bsdf_at(blend, {0.25f, 0.5f}, false)));
    const Material phong = material("0.6.0", "<bsdf type='phong'>" + named("exponent") + "</bsdf>");
    EXPECT_EQ(std::get<Phong>(bsdf_at(phong, {0.75f, 0.5f}, false)).exponent, 1.0f);
    const Material cloth = material("0.6.0", "<bsdf type='roughdiffuse'>" + named("alpha") + "</bsdf>");
    EXPECT_EQ(std::get<RoughDiffuse>(bsdf_at(cloth, {0.75f, 0.5f}, false)).alpha, 1.0f);
    const Material coat = material("0.6.0", "<bsdf type='coating'><float name='thickness' value='0.3'/>" +
                                                named("sigmaA") + "<bsdf type='diffuse'/></bsdf>");
    EXPECT_NEAR(std::get<Coating>(bsdf_at(coat, {0.75f, 0.5f}, false)).absorption.x, 0.3f, 1e-6f);
    EXPECT_EQ(std::get<Coating>(bsdf_at(coat, {0.25f, 0.5f}, false)).absorption.x, 0.0f);
    const Material inside =
        material("3.0.0", "<bsdf type='mask'><bsdf type='diffuse'>" + named("reflectance") + "</bsdf></bsdf>");
    EXPECT_TRUE(needs_texture_coordinates(inside));
    const Bsdf white = bsdf_at(inside, {0.75f, 0.5f}, false);
    EXPECT_NEAR(evaluate(white, {0, 0, 1}, {0, 0, 1}).x, 0.5 / pi, 1e-6);
}

// Heights that rise linearly with u by h per unit of it, on a square whose u runs over 2 scene units: the normal leans
// back by h / 2. A ramp of 64 pixels from 0 to 1, times 0.5.
TEST_F(TexturesInFiles, OfHeightsTurnTheNormal) {
    std::vector<std::uint8_t> ramp;
    for (int i = 0; i < 64; ++i) ramp.insert(ramp.end(), 3, static_cast<std::uint8_t>(4 * i));
    write_bytes(folder_ / "ramp.png", 64, 1, ramp);
    const double slope = 64.0 * 4.0 / 255.0 * 0.5 / 2.0;  // of height by u, over the two units
    for (const std::string bumped :
         {"<bsdf type='bumpmap'><texture type='bitmap'><string name='filename' value='ramp.png'/><boolean name='raw' "
          "value='true'/></texture><float name='scale' value='0.5'/><bsdf type='diffuse'/></bsdf>",
          "<bsdf type='mask'><bsdf type='bumpmap'><texture type='bitmap'><string name='filename' value='ramp.png'/>"
          "<boolean name='raw' value='true'/></texture><float name='scale' value='0.5'/><bsdf type='diffuse'/></bsdf>"
          "</bsdf>"}) {
        const Scene scene = build_scene(load_as("3.0.0", "<shape type='rectangle'>" + bumped + "</shape>"));
        const auto hit = intersect(scene, {to_box(scene, {0.1, 0.2, 1.0}), {0, 0, -1}});
        ASSERT_TRUE(hit);
        const auto surface = orient(scene, *hit, {0, 0, 1});
        ASSERT_TRUE(surface);
        const VectorD expected = VectorD(-slope, 0.0, 1.0).normalized();
        EXPECT_NEAR(surface->frame.normal.x, expected.x, 1e-4);
        EXPECT_NEAR(surface->frame.normal.z, expected.z, 1e-4);
        EXPECT_EQ(surface->geometric_normal, Vector(0, 0, 1));
    }
}

TEST_F(TexturesInFiles, OfNormalsAreTheNormal) {
    write_bytes(folder_ / "normal.png", 1, 1, {204, 128, 230});
    const Scene scene = build_scene(
        load_as("3.0.0",
                "<shape type='rectangle'><bsdf type='normalmap'><texture type='bitmap' name='normalmap'><string "
                "name='filename' value='normal.png'/><boolean name='raw' value='true'/></texture><bsdf "
                "type='diffuse'/></bsdf></shape>"));
    const auto hit = intersect(scene, {to_box(scene, {0.1, 0.2, 1.0}), {0, 0, -1}});
    const auto surface = orient(scene, hit.value(), {0, 0, 1});
    const VectorD expected =
        VectorD(2.0 * 204.0 / 255.0 - 1.0, 2.0 * 128.0 / 255.0 - 1.0, 2.0 * 230.0 / 255.0 - 1.0).normalized();
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(surface.value().frame.normal[i], expected[i], 1e-5);
}

// ---------------------------------------------------------------------------------------------------------------------

// Each pixel of a part of the film sees what that pixel of the whole film sees.
TEST_F(LayeredFiles, OfCroppedFilmsAreThatPartOfTheFilm) {
    const auto camera = [&](const std::string& crop) {
        return build_scene(load("<scene version='0.6.0'><sensor type='perspective'><float name='fov' value='50'/><film "
                                "type='ldrfilm'><integer name='width' value='40'/><integer name='height' "
                                "value='30'/>" +
                                crop + "</film></sensor></scene>"))
            .camera;
    };
    const Camera whole = camera("");
    const Camera part = camera(
        "<integer name='cropOffsetX' value='5'/><integer name='cropOffsetY' value='7'/><integer name='cropWidth' "
        "value='20'/><integer name='cropHeight' value='9'/>");
    EXPECT_EQ(part.width, 20);
    EXPECT_EQ(part.height, 9);
    EXPECT_NEAR(part.pixel_angle, whole.pixel_angle, 1e-12);
    for (const double x : {0.5, 10.0, 19.5})
        for (const double y : {0.5, 4.5, 8.5}) {
            const Vector a = part.ray(x, y, Imath::V2f(0.0f)).direction;
            const Vector b = whole.ray(x + 5.0, y + 7.0, Imath::V2f(0.0f)).direction;
            for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-6f);
        }
}

TEST_F(LayeredFiles, TakeValuesFromOutsideForTheirNames) {
    write("scene.xml",
          "<scene version='3.0.0'><default name='alpha' value='0.1'/><sensor type='perspective'/><shape "
          "type='rectangle'><bsdf type='roughconductor'><float name='alpha' value='$alpha'/></bsdf></shape></scene>");
    const SceneDescription plain = load_scene_file(folder_ / "scene.xml");
    const SceneDescription changed = load_scene_file(folder_ / "scene.xml", {{"alpha", "0.5"}});
    EXPECT_EQ(std::get<RoughConductor>(changed.materials.at(0).bsdf).facets.alpha_u, 0.5f);
    EXPECT_NE(plain.hash, changed.hash);
    EXPECT_EQ(changed.notes.size(), plain.notes.size() + 1);
}

}  // namespace
}  // namespace photonlab
