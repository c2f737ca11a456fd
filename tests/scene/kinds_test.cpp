// What a material, texture, light or shape must answer to be one. Each kind here is sound but for what its name says.

#include <gtest/gtest.h>

#include "scene/emitters/light.h"
#include "scene/materials/material_reader.h"
#include "scene/shapes/shape_reader.h"

namespace photonlab {
namespace {

struct SoundBsdf : Diffuse {
    static SoundBsdf read(MaterialReader&);
};
struct BsdfWithoutCheck : Diffuse {
    static BsdfWithoutCheck read(MaterialReader&);
    void check(const MaterialCheck&) const = delete;
};
struct BsdfWithoutReader : Diffuse {
    static BsdfWithoutReader read(MaterialReader&) = delete;
};
struct BsdfWithoutLobe {
    static constexpr const char* name = "none";
    static constexpr bool is_transmissive = false;
    static BsdfWithoutLobe read(MaterialReader&);
    void check(const MaterialCheck&) const;
    bool is_black() const;
};
struct TransmissiveBsdfOfOneSide : Diffuse {
    static constexpr bool is_transmissive = true;
    static TransmissiveBsdfOfOneSide read(MaterialReader&);
};

TEST(Kinds, OfMaterialsHaveAReaderAndChecksAndALobe) {
    EXPECT_TRUE(BsdfKind<SoundBsdf>);
    EXPECT_FALSE(BsdfKind<BsdfWithoutCheck>);
    EXPECT_FALSE(BsdfKind<BsdfWithoutReader>);
    EXPECT_FALSE(BsdfKind<BsdfWithoutLobe>);
    EXPECT_FALSE(BsdfKind<TransmissiveBsdfOfOneSide>) << "how it looks from behind is not said";
}

TEST(Kinds, OfMaterialsSayWhatTheyAre) {
    EXPECT_TRUE(is_scattering(Diffuse{}) && !is_specular(Diffuse{}) && uniform_value(Diffuse{}));
    EXPECT_TRUE(is_specular(Conductor{}) && !is_scattering(Conductor{}) && !uniform_value(Conductor{}));
    EXPECT_TRUE(is_scattering(Merl{}) && !is_specular(Merl{}) && !uniform_value(Merl{}));
    EXPECT_EQ(uniform_value(Diffuse{Color(0.5f)}), evaluate(Diffuse{Color(0.5f)}, {0, 0, 1}, {0, 0, 1}));
}

struct SoundTexture : Bitmap {
    static SoundTexture read(Plugin&);
};
struct TextureWithoutCheck : Bitmap {
    static TextureWithoutCheck read(Plugin&);
    void check(const std::string&) const = delete;
};

TEST(Kinds, OfTexturesHaveChecks) {
    EXPECT_TRUE(TextureKind<SoundTexture>);
    EXPECT_FALSE(TextureKind<TextureWithoutCheck>);
}

struct SoundLight : PointLight {
    struct Description : PointLightDescription {
        SoundLight placed(const SceneExtent&) const;
    };
    static Description read(LightReader&);
};
struct LightWithoutCheck : PointLight {
    struct Description : PointLightDescription {
        void check() const = delete;
        LightWithoutCheck placed(const SceneExtent&) const;
    };
    static Description read(LightReader&);
};

TEST(Kinds, OfLightsHaveChecksAndSayWhetherRaysMeetThem) {
    EXPECT_TRUE(SceneLightKind<SoundLight>);
    EXPECT_FALSE(SceneLightKind<LightWithoutCheck>);
    EXPECT_TRUE(is_met_by_rays({AreaLight{}, ColorD(1.0), 1.0, 1.0}));
    EXPECT_TRUE(is_met_by_rays({TexturedAreaLight{}, ColorD(1.0), 1.0, 1.0}));
    EXPECT_FALSE(is_met_by_rays({PointLight{}, ColorD(1.0), 1.0, 1.0}));
}

struct SoundShape : Sphere {
    struct Description : SphereDescription {
        SoundShape placed(const ToUnitBox&, const ShapeUse&) const;
    };
    static Description read(ShapeReader&);
};
struct ShapeWithoutCheck : Sphere {
    struct Description : SphereDescription {
        void check(const std::string&) const = delete;
        ShapeWithoutCheck placed(const ToUnitBox&, const ShapeUse&) const;
    };
    static Description read(ShapeReader&);
};

TEST(Kinds, OfShapesHaveChecks) {
    EXPECT_TRUE(AnalyticKind<SoundShape>);
    EXPECT_FALSE(AnalyticKind<ShapeWithoutCheck>);
}

}  // namespace
}  // namespace photonlab
