// What a scene file may say besides its plugins: other ids for them, lights of the scene itself that shapes name,
// folders to look for files in, spectra that are plugins, and what only tells another program how to render.

#include <algorithm>

#include "tests/scene/scene_folder.h"

namespace photonlab {
namespace {

class StructureTest : public SceneFolderTest {
protected:
    Color reflectance(const std::string& property) const {
        const auto scene =
            load_as("3.0.0", "<shape type='sphere'><bsdf type='diffuse'>" + property + "</bsdf></shape>");
        return std::get<Diffuse>(scene.materials.at(0).bsdf).reflectance;
    }
};

bool has_note(const SceneDescription& scene, const std::string& text) {
    return std::any_of(scene.notes.begin(), scene.notes.end(),
                       [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

TEST_F(StructureTest, AnAliasIsAnotherIdOfTheSamePlugin) {
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        const auto scene =
            load_as(version,
                    "<bsdf type='diffuse' id='a'/><alias id='a' as='b'/><alias id='b' as='c'/>"
                    "<shape type='cube'><ref id='c'/></shape><shape type='cube'><ref id='a'/></shape>"
                    "<bsdf type='twosided' id='d'><bsdf type='diffuse' id='e'/></bsdf><alias id='e' as='f'/>"
                    "<shape type='cube'><ref name='bsdf' id='f'/></shape>");
        EXPECT_EQ(scene.materials.size(), 3u);
        EXPECT_EQ(scene.shapes.at(0).material, scene.shapes.at(1).material);
        EXPECT_FALSE(scene.materials.at(scene.shapes.at(2).material).two_sided);
    }
}

TEST_F(StructureTest, AnAliasMayNameALightOrATexture) {
    write("grey.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n\x80\x80\x80\x7f");
    const auto scene = load_as("3.0.0",
                               "<emitter type='area' id='lamp'/><alias id='lamp' as='light'/>"
                               "<texture type='bitmap' id='grey'><string name='filename' value='grey.hdr'/>"
                               "</texture><alias id='grey' as='gray'/><shape type='cube'><ref id='light'/>"
                               "<bsdf type='diffuse'><ref name='reflectance' id='gray'/></bsdf></shape>");
    EXPECT_TRUE(scene.shapes.at(0).radiance);
    EXPECT_EQ(scene.materials.at(0).textures.size(), 1u);
}

TEST_F(StructureTest, ALightOfTheSceneShinesFromTheShapeThatNamesIt) {
    const std::string lamp = "<emitter type='area' id='lamp'><rgb name='radiance' value='1 2 3'/></emitter>";
    const std::string shape = "<shape type='rectangle'><ref id='lamp'/></shape>";
    for (const std::string& order : {lamp + shape, shape + lamp}) {
        const auto scene = load_as("3.0.0", order);
        EXPECT_EQ(scene.shapes.at(0).radiance.value(), ColorD(1, 2, 3));
        EXPECT_TRUE(is_black(scene.materials.at(scene.shapes.at(0).material).bsdf));
        EXPECT_TRUE(scene.lights.empty());
    }
}

TEST_F(StructureTest, SamplingWeightsAreReadAndChangeNoRadiance) {
    for (const std::string name : {"sampling_weight", "samplingWeight"}) {
        const std::string weight = "<float name='" + name + "' value='2'/>";
        const auto scene = load_as("3.0.0", "<shape type='cube'><emitter type='area'>" + weight +
                                                "</emitter></shape><emitter type='point'>" + weight + "</emitter>");
        EXPECT_EQ(scene.shapes.at(0).radiance.value(), ColorD(1.0));
        EXPECT_EQ(scene.shapes.at(0).sampling_weight, 2.0);
        EXPECT_EQ(std::get<PointLightDescription>(scene.lights.at(0)).sampling_weight, 2.0);
        EXPECT_TRUE(scene.notes.empty());
    }
}

// parser.cpp: <path> puts its folder before all others, and the last before the ones before it.
TEST_F(StructureTest, PathsAreFoldersInWhichFilesAreLookedForFirst) {
    const auto mesh = [](const std::string& size) { return "v 0 0 0\nv " + size + " 0 0\nv 0 1 0\nf 1 2 3\n"; };
    const auto size_of = [&](const std::string& paths, const std::string& name) {
        const auto scene =
            load_as("3.0.0", paths + "<shape type='obj'><string name='filename' value='" + name + "'/></shape>");
        return std::get<MeshDescription>(scene.shapes.at(0).geometry).positions.at(1).x;
    };
    write("mesh.obj", mesh("1"));
    write("a/mesh.obj", mesh("2"));
    write("b/mesh.obj", mesh("3"));
    write("b/other.obj", mesh("4"));
    EXPECT_EQ(size_of("", "mesh.obj"), 1.0);
    EXPECT_EQ(size_of("<path value='a'/>", "mesh.obj"), 2.0);
    EXPECT_EQ(size_of("<path value='a'/><path value='b'/>", "mesh.obj"), 3.0);
    EXPECT_EQ(size_of("<path value='b'/><path value='a'/>", "mesh.obj"), 2.0);
    EXPECT_EQ(size_of("<path value='b'/><path value='a'/>", "other.obj"), 4.0);
    EXPECT_EQ(size_of("<path value='" + (folder_ / "b").string() + "'/>", "mesh.obj"), 3.0);
    write("b/part.xml",
          "<scene version='3.0.0'><path value='../a'/><shape type='obj'><string name='filename' "
          "value='mesh.obj'/></shape></scene>");
    EXPECT_EQ(size_of("<path value='b'/><include filename='part.xml'/>", "mesh.obj"), 2.0) << "of the include itself";
}

TEST_F(StructureTest, APathThatIsNotThereIsNoted) {
    write("file", "");
    for (const std::string name : {"none", "file", "none/below"}) {
        const auto scene = load_as("3.0.0", "\n<path value='" + name + "'/>");
        EXPECT_TRUE(has_note(scene, "scene.xml:2: path: there is no folder \"" + name + "\"")) << name;
    }
}

// uniform.cpp, srgb.cpp and d65.cpp of Mitsuba 3, in its RGB variants: all of them white or the colour itself.
TEST_F(StructureTest, SpectraMayBePlugins) {
    EXPECT_FLOAT_EQ(
        reflectance("<spectrum name='reflectance' type='uniform'><float name='value' value='0.25'/></spectrum>").y,
        0.25f);
    EXPECT_EQ(
        reflectance("<spectrum name='reflectance' type='srgb'><rgb name='color' value='0.1 0.2 0.3'/></spectrum>"),
        Color(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(reflectance("<rgb name='reflectance' type='reflectance' value='0.1 0.2 0.3'/>"), Color(0.1f, 0.2f, 0.3f));
    EXPECT_EQ(reflectance("<rgb name='reflectance' intent='reflectance' value='0.1 0.2 0.3'/>"),
              Color(0.1f, 0.2f, 0.3f));
    const auto intensity = [&](const std::string& inside) {
        return std::get<PointLightDescription>(
                   load_as("3.0.0", "<emitter type='point'>" + inside + "</emitter>").lights.at(0))
            .intensity;
    };
    EXPECT_EQ(intensity("<spectrum name='intensity' type='uniform'><float name='value' value='3'/></spectrum>"),
              ColorD(3.0));
    EXPECT_EQ(intensity("<spectrum name='intensity' type='d65'><float name='scale' value='3'/></spectrum>"),
              ColorD(3.0));
    EXPECT_EQ(intensity("<spectrum name='intensity' type='d65'/>"), ColorD(1.0));
    EXPECT_EQ(intensity("<spectrum name='intensity' type='d65'><rgb name='color' value='1 2 3'/><float name='scale' "
                        "value='2'/></spectrum>"),
              ColorD(2, 4, 6));
}

TEST_F(StructureTest, AnObjFileWithoutFacesIsAnEmptyMeshWithANote) {
    write("empty.obj", "# nothing\n");
    const auto scene = load_as("3.0.0",
                               "<shape type='obj'><string name='filename' value='empty.obj'/></shape>"
                               "<shape type='obj'><string name='filename' value='empty.obj'/><emitter "
                               "type='area'/></shape>");
    EXPECT_TRUE(std::get<MeshDescription>(scene.shapes.at(0).geometry).triangles.empty());
    EXPECT_TRUE(has_note(scene, "empty.obj: has no faces"));
}

TEST_F(StructureTest, TheDirectIntegratorIsDepthTwo) {
    const auto scene = load_as("0.6.0", "<integrator type='direct'/>");
    EXPECT_EQ(scene.max_depth, 2);
    EXPECT_TRUE(has_note(scene, "integrator \"direct\": read as max_depth 2"));
    EXPECT_TRUE(has_note(load_as("0.6.0", ""), "no integrator: Mitsuba 0.6 would render direct light alone"));
    EXPECT_EQ(load_as("3.0.0", "").notes.size(), 0u);
}

TEST_F(StructureTest, WhatTellsAnotherProgramHowToRenderIsReadPast) {
    for (const std::string property : {"<integer name='rr_depth' value='5'/>", "<integer name='rrDepth' value='5'/>",
                                       "<boolean name='hideEmitters' value='true'/>"}) {
        const auto scene = load_as(
            "3.0.0", "<integrator type='path'><integer name='max_depth' value='7'/>" + property + "</integrator>");
        EXPECT_EQ(scene.max_depth, 7);
        EXPECT_EQ(scene.notes, std::vector<std::string>{"of integrator \"path\" only max_depth is read"}) << property;
    }
}

TEST_F(StructureTest, PointsAndVectorsAreGivenByOneValueOrByThree) {
    for (const std::string tag : {"point", "vector"})
        for (const std::string version : {"0.6.0", "3.0.0"})
            for (const std::string numbers : {"x='1' y='2' z='3'", "value='1, 2, 3'", "value='1 2 3'"}) {
                const auto scene = load_as(version, "<emitter type='point'><" + tag + " name='position' " + numbers +
                                                        "/></emitter><shape type='sphere'><" + tag + " name='center' " +
                                                        numbers + "/></shape>");
                const VectorD expected(1, 2, 3);
                EXPECT_EQ(std::get<PointLightDescription>(scene.lights.at(0)).position, expected) << tag << numbers;
                EXPECT_EQ(std::get<SphereDescription>(scene.shapes.at(0).geometry).centre, expected) << tag << numbers;
            }
}

TEST_F(StructureTest, NotesNameFilesAsTheSceneDoes) {
    write("meshes/empty.obj", "v 0 0 0\n");
    write("parts/more.xml", "<scene version='0.6.0'>\n<path value='nowhere'/></scene>");
    const auto scene = load_as("0.6.0",
                               "<integrator type='path'/><include filename='parts/more.xml'/><shape type='obj'>"
                               "<string name='filename' value='meshes/empty.obj'/></shape>");
    EXPECT_TRUE(has_note(scene, "meshes/empty.obj: has no faces"));
    EXPECT_TRUE(has_note(scene, "parts/more.xml:2: path: there is no folder"));
    for (const std::string& note : scene.notes) EXPECT_EQ(note.find(folder_.string()), note.npos) << note;
}

}  // namespace
}  // namespace photonlab
