// Where Mitsuba 0.6 and Mitsuba 3 read the same elements differently, the version of the file decides. The sources are
// named beside each: of 0.6, and of 3.9 and what followed it.

#include <cmath>

#include "scene/scene.h"
#include "tests/scene/geometry.h"
#include "tests/scene/scene_folder.h"

namespace photonlab {
namespace {

class FamiliesTest : public SceneFolderTest {
protected:
    Color reflectance(const std::string& version, const std::string& property) const {
        const auto scene =
            load_as(version, "<shape type='sphere'><bsdf type='diffuse'>" + property + "</bsdf></shape>");
        return std::get<Diffuse>(scene.materials.at(0).bsdf).reflectance;
    }
};

const ColorD white(1.0);
const ColorD equal_energy(1.204795, 0.948291, 0.908917);  // XYZ (1, 1, 1) in linear sRGB

TEST_F(FamiliesTest, FollowTheVersionAndWhatHasNoneIsRefused) {
    const auto message = [&](const std::string& attributes) {
        return message_of("<scene" + attributes + ">\n<sensor type='perspective'/></scene>");
    };
    for (const std::string version :
         {"0.4.0", "0.5.0", "0.6.0", "0.6.1", "2.0.0", "2.1.0", "3.0.0", "3.9.1", " 3.0.0 "})
        EXPECT_EQ(message(" version='" + version + "'"), "no error") << version;
    // scenehandler.cpp and parser.cpp: "missing version".
    EXPECT_EQ(message(""),
              "scene.xml:1: <scene> needs an attribute \"version\", that of the Mitsuba it is written for: "
              "three numbers such as 0.6.0 or 3.0.0");
    // Two files of 0.3 and older mean other things by the same elements, which 0.6 has stylesheets for; 1 and 4 are
    // no Mitsuba's; and three numbers it must be (plugin.cpp and util.cpp: Version).
    for (const std::string version : {"", "3", "3.0", "3.0.0.0", "1.0", "1.0.0", "4.0.0", "0.3.0", "0.7.0", "-3.0.0",
                                      "3.-1.0", "3.0.x", "three", "0x3.0.0", "3,0,0", "99999999999999999999.0.0"})
        EXPECT_EQ(message(" version='" + version + "'"),
                  "scene.xml:1: version: expected 0.4.0 to 0.6.0, or 2 or 3 in three numbers such as 3.0.0, got \"" +
                      version + "\"");
}

// parser.cpp: an included file is of its own version.
TEST_F(FamiliesTest, AnIncludedFileIsOfItsOwnVersion) {
    write("old.xml",
          "<scene version='0.6.0'><emitter type='point'><spectrum name='intensity' value='1'/></emitter></scene>");
    const auto scene = load_as("3.0.0",
                               "<include filename='old.xml'/><emitter type='point'><spectrum name='intensity' "
                               "value='1'/></emitter>");
    expect_near(std::get<PointLightDescription>(scene.lights.at(0)).intensity, white, 1e-12);
    expect_near(std::get<PointLightDescription>(scene.lights.at(1)).intensity, equal_energy, 1e-4);
    write("none.xml", "<scene><emitter type='point'/></scene>");
    EXPECT_EQ(message_of("<scene version='3.0.0'><include filename='none.xml'/></scene>").substr(0, 40),
              "none.xml:1: <scene> needs an attribute \"");
}

// scenehandler.cpp: Spectrum::getD65() * value, and spectrum.cpp: 1 in builds of three samples. properties.cpp:
// xyz_to_srgb(1).
TEST_F(FamiliesTest, ANumberAsASpectrumOfALightIsWhiteIn06AndEqualEnergyIn3) {
    const std::string lights =
        "<shape type='sphere'><emitter type='area'><spectrum name='radiance' value='2'/></emitter></shape>"
        "<emitter type='point'><spectrum name='intensity' value='2'/></emitter>";
    for (const auto& [version, color] : {std::pair("0.6.0", white), std::pair("3.0.0", equal_energy)}) {
        const auto scene = load_as(version, lights);
        expect_near(scene.shapes.at(0).radiance.value(), color * 2.0, 1e-4);
        expect_near(std::get<PointLightDescription>(scene.lights.at(0)).intensity, color * 2.0, 1e-4);
    }
}

// spectrum.cpp: fromContinuousSpectrum() has no illuminant. properties.cpp: reflectances are under D65.
TEST_F(FamiliesTest, ReflectancesByWavelengthAreUnderD65In3Alone) {
    const std::string half = "<spectrum name='reflectance' value='300:0.5, 900:0.5'/>";
    expect_near(VectorD(reflectance("3.0.0", half)), ColorD(0.5), 2e-4);
    expect_near(VectorD(reflectance("0.6.0", half)), equal_energy * 0.5, 2e-3);
    const auto eta = [&](const std::string& version) {
        const auto scene = load_as(version,
                                   "<shape type='sphere'><bsdf type='conductor'><spectrum name='eta' "
                                   "value='300:2, 900:2'/><float name='k' value='1'/></bsdf></shape>");
        return VectorD(std::get<Conductor>(scene.materials.at(0).bsdf).eta);
    };
    expect_near(eta("3.0.0"), ColorD(2.0), 2e-3);
    expect_near(eta("0.6.0"), equal_energy * 2.0 / 1.000277, 5e-3);
}

// bsdf.cpp: ensureEnergyConservation(). srgb.cpp: "must be in the range [0, 1]".
TEST_F(FamiliesTest, WhatReflectsMoreThanAllIsScaledIn06AndRefusedIn3) {
    const std::string bright = "<rgb name='reflectance' value='2 1 0.5'/>";
    expect_near(VectorD(reflectance("0.6.0", bright)), ColorD(0.99, 0.495, 0.2475), 1e-6);
    EXPECT_THROW(reflectance("3.0.0", bright), InputError);
    const auto scene = load_as("0.6.0", "<shape type='sphere'><bsdf type='diffuse'>\n" + bright + "</bsdf></shape>");
    ASSERT_EQ(scene.notes.size(), 2u);
    EXPECT_EQ(scene.notes[0].substr(scene.notes[0].rfind('/') + 1),
              "scene.xml:2: reflectance of 2.000 1.000 0.500 is scaled by 0.4950, as in Mitsuba 0.6");
    const Color paper = reflectance("0.6.0", "<spectrum name='reflectance' value='300:1, 900:1'/>");
    expect_near(VectorD(paper), equal_energy * (0.99 / equal_energy.x), 2e-3);
}

// scenehandler.cpp: the bytes of an <rgb> go to fromLinearRGB(), those of an <srgb> to fromSRGB().
TEST_F(FamiliesTest, BytesOfAnRgbAreLinearIn06) {
    EXPECT_NEAR(reflectance("0.6.0", "<rgb name='reflectance' value='#ff8000'/>").y, 128.0 / 255.0, 1e-6);
    EXPECT_NEAR(reflectance("0.6.0", "<srgb name='reflectance' value='#ff8000'/>").y, 0.2158605, 1e-6);
    EXPECT_NEAR(reflectance("3.0.0", "<rgb name='reflectance' value='#ff8000'/>").y, 0.2158605, 1e-6);
}

// diffuse.cpp of 0.6.
TEST_F(FamiliesTest, DiffuseReflectanceIsANameOfReflectanceIn06Alone) {
    EXPECT_NEAR(reflectance("0.6.0", "<rgb name='diffuseReflectance' value='0.25'/>").y, 0.25, 1e-6);
    EXPECT_THROW(reflectance("3.0.0", "<rgb name='diffuseReflectance' value='0.25'/>"), InputError);
}

// conductor.cpp of 0.6: eta and k are over that of the medium around the metal, air where it is left out; and they
// replace those of the material. Of 3: "Should specify either (eta, k) or material, not both."
TEST_F(FamiliesTest, MetalsHaveAMediumAroundThemIn06) {
    const auto conductor = [&](const std::string& version, const std::string& inside) {
        const auto scene =
            load_as(version, "<shape type='sphere'><bsdf type='conductor'>" + inside + "</bsdf></shape>");
        return std::get<Conductor>(scene.materials.at(0).bsdf);
    };
    const std::string gold = "<string name='material' value='Au'/>";
    const std::string eta = "<rgb name='eta' value='0.5'/>";
    EXPECT_NEAR(conductor("0.6.0", gold).eta.x, 0.143119 / 1.000277, 1e-7);
    EXPECT_NEAR(conductor("0.6.0", gold + "<string name='extEta' value='Water'/>").eta.x, 0.143119 / 1.333, 1e-7);
    EXPECT_NEAR(conductor("0.6.0", gold + "<float name='extEta' value='1'/>").k.x, 3.983160, 1e-6);
    EXPECT_NEAR(conductor("0.6.0", gold + eta).eta.x, 0.5 / 1.000277, 1e-7);
    EXPECT_NEAR(conductor("0.6.0", gold + eta).k.x, 3.983160 / 1.000277, 1e-6);
    EXPECT_FLOAT_EQ(conductor("3.0.0", gold).eta.x, 0.143119f);
    EXPECT_THROW(conductor("3.0.0", gold + eta), InputError);
    EXPECT_THROW(conductor("3.0.0", gold + "<float name='extEta' value='1'/>"), InputError);
    EXPECT_FLOAT_EQ(conductor("3.0.0", "<string name='material' value='none'/>" + eta).k.x, 1.0f);
}

// sphere.cpp of 0.6 divides to_world by its scale before it applies it to the centre; that of 3 turns the normals when
// the scale is negative.
TEST_F(FamiliesTest, SpheresTakeTheirScaleDifferently) {
    const auto sphere = [&](const std::string& version, const std::string& transform) {
        const auto scene = load_as(version,
                                   "<shape type='sphere'><point name='center' x='1' y='2' z='3'/><transform "
                                   "name='to_world'>" +
                                       transform + "</transform></shape>");
        return std::get<SphereDescription>(scene.shapes.at(0).geometry);
    };
    const std::string ten = "<scale value='10'/><translate x='5'/>";
    expect_near(sphere("3.0.0", ten).centre, {15, 20, 30}, 1e-12);
    expect_near(sphere("0.6.0", ten).centre, {6, 2, 3}, 1e-12);
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        EXPECT_DOUBLE_EQ(sphere(version, ten).radius, 10.0);
        EXPECT_FALSE(sphere(version, ten).flip_normals);
        EXPECT_FALSE(sphere(version, "<scale x='-1' y='-1'/>").flip_normals) << "a rotation";
    }
    EXPECT_TRUE(sphere("3.0.0", "<scale x='-1'/>").flip_normals);
    EXPECT_FALSE(sphere("0.6.0", "<scale x='-1'/>").flip_normals);
}

// obj.cpp and trimesh.cpp of 0.6: positions are in the world when the winding says what is outside. mesh_utils.cpp of
// 3: PackedMesh::set_transform() turns triangles back.
TEST_F(FamiliesTest, AMirroringTurnsAMeshWithoutNormalsInsideOutIn06) {
    write("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write("given.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
    const auto side = [&](const std::string& version, const std::string& file, const std::string& rest = "") {
        const auto scene = load_as(version, "<shape type='obj'><string name='filename' value='" + file + "'/>" + rest +
                                                "<transform name='to_world'><scale x='-1'/></transform></shape>");
        return normal_of(std::get<MeshDescription>(scene.shapes.at(0).geometry)).z;
    };
    const std::string flat = "<boolean name='face_normals' value='true'/>";
    const std::string flip = "<boolean name='flip_normals' value='true'/>";
    EXPECT_EQ(side("0.6.0", "bare.obj"), -1.0);
    EXPECT_EQ(side("0.6.0", "bare.obj", flip), 1.0);
    EXPECT_EQ(side("0.6.0", "given.obj", flat), -1.0);
    EXPECT_EQ(side("0.6.0", "given.obj", flat + flip), 1.0);
    EXPECT_EQ(side("0.6.0", "given.obj"), 1.0) << "normals are taken to the world as normals";
    EXPECT_EQ(side("0.6.0", "given.obj", flip), -1.0);
    for (const std::string file : {"bare.obj", "given.obj"}) {
        EXPECT_EQ(side("3.0.0", file), 1.0) << file;
        EXPECT_EQ(side("3.0.0", file, flip), -1.0) << file;
        EXPECT_EQ(side("3.0.0", file, flat), 1.0) << file;
        EXPECT_EQ(side("3.0.0", file, flat + flip), -1.0) << file;
    }
}

// skdtree.h of 0.6 turns the face to its vertices' normals; in 3 a bsdf and an area light ask the shading frame.
TEST_F(FamiliesTest, VertexNormalsSayWhichSideIsWhich) {
    write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0.1 -1\nf 1//1 2//1 3//1\n");
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        const auto scene = load_as(version, "<shape type='obj'><string name='filename' value='mesh.obj'/></shape>");
        EXPECT_EQ(normal_of(std::get<MeshDescription>(scene.shapes.at(0).geometry)).z, -1.0) << version;
    }
}

// obj.cpp of 0.6: equal positions are one vertex, and groups and materials are meshes of their own, whose normals are
// computed apart. In 3 vertices are told apart by their index, and there is one mesh.
TEST_F(FamiliesTest, ComputedNormalsStopAtGroupsIn06AndAtVerticesIn3) {
    const auto normal = [&](const std::string& version, const std::string& text, const std::string& rest = "") {
        write("mesh.obj", text);
        const auto scene =
            load_as(version, "<shape type='obj'><string name='filename' value='mesh.obj'/>" + rest + "</shape>");
        const auto& mesh = std::get<MeshDescription>(scene.shapes.at(0).geometry);
        return mesh.normals[mesh.triangles.at(0).x];
    };
    const VectorD flat(0, 0, -1), bent = VectorD(0, -1, -1).normalized();
    const std::string corners = "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\nv 0 0 0\nv 1 0 0\n";
    for (const std::string keyword : {"g b\n", "usemtl b\n"}) {
        const std::string roof = corners + "f 1 2 3\n" + keyword + "f 1 3 4\n";
        expect_near(normal("0.6.0", roof), flat, 1e-12);
        expect_near(normal("0.6.0", roof, "<boolean name='collapse' value='true'/>"), bent, 1e-12);
        expect_near(normal("3.0.0", roof), bent, 1e-12);
    }
    for (const std::string keyword : {"o b\n", "s 1\n", "g a\n"}) {
        const std::string roof = (keyword == "g a\n" ? keyword : "") + corners + "f 1 2 3\n" +
                                 (keyword == "g a\n" ? "" : keyword) + "f 5 6 4\n";
        expect_near(normal("0.6.0", roof), bent, 1e-12);
        expect_near(normal("3.0.0", roof), flat, 1e-12);
    }
}

// obj.cpp of 0.6: loadMaterials, and addChild() for a bsdf with a name.
TEST_F(FamiliesTest, MaterialsOfAnObjFileAreNotTakenForGreyIn06) {
    write("mesh.obj", "mtllib my materials.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n");
    const auto message = [&](const std::string& version, const std::string& inside) {
        return message_of("<scene version='" + version +
                          "'><sensor type='perspective'/>\n<shape type='obj'><string "
                          "name='filename' value='mesh.obj'/>" +
                          inside + "</shape></scene>");
    };
    const std::string bsdf = "<bsdf type='diffuse'/>";
    EXPECT_EQ(message("0.6.0", ""), "no error") << "there is no such library";
    write("my materials.mtl", "newmtl red\nKd 1 0 0\n");
    EXPECT_EQ(
        message("0.6.0", ""),
        "scene.xml:2: obj: its materials are in \"my materials.mtl\", which is not read here: expected a bsdf, or "
        "<boolean name=\"loadMaterials\" value=\"false\"/>");
    EXPECT_EQ(message("0.6.0", bsdf), "no error");
    EXPECT_EQ(message("0.6.0", "<boolean name='loadMaterials' value='false'/>"), "no error");
    EXPECT_EQ(message("3.0.0", ""), "no error");
    const std::string named = "\n<bsdf type='diffuse' name='red'/>";
    EXPECT_EQ(message("0.6.0", named).substr(0, 40), "scene.xml:3: obj: in version 0.6 a bsdf ");
    EXPECT_EQ(message("3.0.0", named), "no error");
}

// scenehandler.cpp and parser.cpp: an up that is left out, or 0, is the first of coordinateSystem() and of
// coordinate_system().
TEST_F(FamiliesTest, WithoutAnUpEachTurnsTheCameraItsOwnWay) {
    const auto left = [&](const std::string& version, const std::string& target, const std::string& up) {
        const auto scene = load("<scene version='" + version +
                                "'><integrator type='path'/><sensor type='perspective'><transform name='to_world'>\n"
                                "<lookat origin='0 0 0' target='" +
                                target + "'" + up + "/></transform></sensor></scene>");
        EXPECT_EQ(scene.notes.size(), 2u);
        const std::string note = scene.notes.front();
        EXPECT_EQ(note.substr(note.rfind('/') + 1),
                  "scene.xml:2: lookat without an up: turned about the view as Mitsuba " +
                      std::string(version == "0.6.0" ? "0.6" : "3") + " does");
        const Matrix& m = scene.camera.to_world;
        expect_near({m[2][0], m[2][1], m[2][2]}, VectorD(std::stod(target), 0, -1).normalized(), 1e-12);
        return VectorD(m[0][0], m[0][1], m[0][2]);
    };
    for (const std::string up : {"", " up=''", " up='0, 0, 0'"}) {
        expect_near(left("0.6.0", "0 0 -1", up), {0, 1, 0}, 1e-12);
        expect_near(left("3.0.0", "0 0 -1", up), {0, 1, 0}, 1e-12);
        // By hand: up is (0, -1, 0) in 0.6 and (1, 0, 1) / sqrt(2) in 3, and left is up x forward.
        expect_near(left("0.6.0", "1 0 -1", up), VectorD(1, 0, 1).normalized(), 1e-12);
        expect_near(left("3.0.0", "1 0 -1", up), {0, 1, 0}, 1e-12);
    }
}

// texture.cpp of 0.6: uv * scale + offset. bitmap.cpp of 0.6: gamma, and filters over a pixel, which at a point are
// bilinear. Of 3: to_uv and raw.
TEST_F(FamiliesTest, BitmapsHaveOtherPropertiesIn06) {
    write("grey.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x80\x80\x7f\x80\x80\x80\x80");
    const auto texture = [&](const std::string& version, const std::string& inside) {
        const auto scene = load_as(version,
                                   "<shape type='sphere'><bsdf type='diffuse'><texture type='bitmap' "
                                   "name='reflectance'><string name='filename' value='grey.hdr'/>" +
                                       inside + "</texture></bsdf></shape>");
        return std::get<Bitmap>(*scene.materials.at(0).textures.at(0).texture);
    };
    const auto moved = [&](const std::string& inside) {
        const Matrix& to_uv = texture("0.6.0", inside).to_uv;
        return VectorD(0.5, 0.25, 0.0) * to_uv;
    };
    expect_near(moved(""), {0.5, 0.25, 0}, 1e-12);
    expect_near(moved("<float name='uvscale' value='4'/>"), {2, 1, 0}, 1e-12);
    expect_near(moved("<float name='uvscale' value='4'/><float name='vscale' value='8'/><float name='uoffset' "
                      "value='0.1'/><float name='voffset' value='0.2'/>"),
                {2.1, 2.2, 0}, 1e-12);
    for (const std::string filter : {"ewa", "trilinear", "bilinear"}) {
        const std::string property = "<string name='filterType' value='" + filter + "'/>";
        EXPECT_NEAR(texture("0.6.0", property).color_at({0.5f, 0.5f}).x, 0.375, 1e-6) << filter;
        if (filter != "bilinear") {
            EXPECT_THROW(texture("3.0.0", property), InputError) << filter;
        }
    }
    EXPECT_NEAR(texture("0.6.0", "<float name='gamma' value='1'/>").image->pixels.at(0).x, 0.25, 1e-6);
    for (const std::string other :
         {"<boolean name='raw' value='true'/>", "<transform name='to_uv'/>", "<float name='gamma' value='-2.2'/>"})
        EXPECT_THROW(texture("0.6.0", other), InputError) << other;
    for (const std::string other : {"<float name='uscale' value='2'/>", "<float name='gamma' value='1'/>"})
        EXPECT_THROW(texture("3.0.0", other), InputError) << other;
}

// parser.cpp: an <include> is looked for beside the file that it stands in first; scenehandler.cpp: beside the scene.
TEST_F(FamiliesTest, IncludesAreLookedForInTheOrderOfTheirFamily) {
    write("part.xml", "<scene version='3.0.0'><bsdf type='diffuse' id='beside the scene'/></scene>");
    write("parts/part.xml", "<scene version='3.0.0'><bsdf type='diffuse' id='beside the part'/></scene>");
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        write("parts/all.xml", "<scene version='" + version + "'><include filename='part.xml'/></scene>");
        const auto scene = load_as(version, "<include filename='parts/all.xml'/>");
        EXPECT_EQ(scene.materials.at(0).id, version == "3.0.0" ? "beside the part" : "beside the scene");
    }
}

}  // namespace
}  // namespace photonlab
