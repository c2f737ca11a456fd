// The loader by example: what public scene files contain is read as Mitsuba reads it, and every mistake in the table
// below gets exactly the message beside it.

#include "scene/loader.h"
#include "scene/shapes/meshes/obj.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "core/error.h"
#include "tests/scene/geometry.h"

namespace photonlab {
namespace {

/// A folder of its own for a test's files, removed afterwards.
class LoaderTest : public ::testing::Test {
protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() /
                  (std::string("photonlab-") + test->test_suite_name() + "-" + test->name());
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

    SceneDescription load(const std::string& text, const std::map<std::string, std::string>& parameters = {}) const {
        write("scene.xml", text);
        return load_scene_file(folder_ / "scene.xml", parameters);
    }

    /// Loads `inside` as the inside of a scene that has a sensor already.
    SceneDescription load_with_sensor(const std::string& inside) const {
        return load("<scene version='3.0.0'><sensor type='perspective'/>" + inside + "</scene>");
    }

    /// The message of the error that `text` raises, with the folder taken out.
    std::string message_of(const std::string& text) const {
        try {
            load(text);
        } catch (const InputError& error) {
            std::string message = error.what();
            const std::string prefix = folder_.string() + "/";
            for (std::size_t at; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
            return message;
        }
        return "no error";
    }

    std::filesystem::path folder_;
};

const MeshDescription& mesh_of(const SceneDescription& scene, std::size_t shape = 0) {
    return std::get<MeshDescription>(scene.shapes.at(shape).geometry);
}

TEST_F(LoaderTest, OneValueStandsForThreeAsInMitsuba) {
    const auto scene = load_with_sensor(
        "<shape type='cube'><transform name='to_world'><scale value='2'/><translate value='3'/>"
        "</transform></shape><shape type='sphere'><point name='center' value='4'/></shape>");
    for (const VectorD& corner : mesh_of(scene).positions)
        for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(std::abs(corner[axis] - 3.0), 2.0, 1e-12);
    expect_near(std::get<SphereDescription>(scene.shapes.at(1).geometry).centre, {4, 4, 4});
}

TEST_F(LoaderTest, DisksMayBeScaledAlongTheirNormal) {
    const auto scene = load_with_sensor(
        "<shape type='disk'><transform name='to_world'><scale x='2' y='2' z='7'/><rotate x='1' angle='90'/>"
        "</transform></shape>");
    const auto& disk = std::get<DiskDescription>(scene.shapes.at(0).geometry);
    EXPECT_DOUBLE_EQ(disk.radius, 2.0);
    expect_near(disk.normal, {0, -1, 0});
}

TEST_F(LoaderTest, ACropOfTheWholeFilmIsNoCrop) {
    const auto scene = load(
        "<scene version='3.0.0'><sensor type='perspective'><film type='hdrfilm'><integer name='width' value='8'/>"
        "<integer name='height' value='6'/><integer name='cropOffsetX' value='0'/><integer name='crop_offset_y' "
        "value='0'/>"
        "<integer name='crop_width' value='8'/><integer name='cropHeight' value='6'/></film></sensor></scene>");
    EXPECT_EQ(scene.camera.height, 6);
}

TEST_F(LoaderTest, TransformsApplyInTheOrderInWhichTheyStand) {
    const auto scene = load_with_sensor(
        "<shape type='rectangle'><transform name='to_world'><scale x='2' y='3'/><rotate y='1' angle='90'/>"
        "<translate value='10, 20, 30'/></transform></shape>");
    // (1, 1, 0) scaled is (2, 3, 0), turned by 90 degrees about y is (0, 3, -2).
    expect_near(mesh_of(scene).positions[2], {10, 23, 28});
    expect_near(normal_of(mesh_of(scene), 0), {1, 0, 0});
}

TEST_F(LoaderTest, MatricesAreRowsOfColumnVectorsWithOldExponents) {
    const auto scene = load_with_sensor(
        "<shape type='rectangle'><transform name='toWorld'><matrix value='-4.37114e-008 1 4.37114e-008 5 0 "
        "-8.74228e-008 2 6 "
        "1 4.37114e-008 1.91069e-015 7 0 0 0 1'/></transform></shape>");
    expect_near(mesh_of(scene).positions[2], {1 + 5 - 4.37114e-8, 6 - 8.74228e-8, 8 + 4.37114e-8}, 1e-9);
}

TEST_F(LoaderTest, LookAtHasXToTheLeftYUpAndZForward) {
    const auto scene = load(
        "<scene version='3.0.0'><sensor type='perspective'><transform name='to_world'>"
        "<lookat origin='1,2,3' target='1,2,10' up='0,1,0'/></transform></sensor></scene>");
    const Matrix& m = scene.camera.to_world;
    expect_near({m[0][0], m[0][1], m[0][2]}, {1, 0, 0});
    expect_near({m[1][0], m[1][1], m[1][2]}, {0, 1, 0});
    expect_near({m[2][0], m[2][1], m[2][2]}, {0, 0, 1});
    expect_near({m[3][0], m[3][1], m[3][2]}, {1, 2, 3});
}

TEST_F(LoaderTest, MirroringKeepsTheOutsideOutside) {
    const auto scene = load_with_sensor(
        "<shape type='cube'><transform name='to_world'><scale x='-1'/></transform></shape>"
        "<shape type='cube'/><shape type='cube'><boolean name='flipNormals' value='true'/></shape>");
    for (std::size_t shape = 0; shape < 3; ++shape)
        for (std::size_t triangle = 0; triangle < 12; ++triangle) {
            const MeshDescription& mesh = mesh_of(scene, shape);
            const double outwards = normal_of(mesh, triangle).dot(mesh.positions[mesh.triangles[triangle].x]);
            EXPECT_NEAR(outwards, shape == 2 ? -1.0 : 1.0, 1e-12);
        }
}

TEST_F(LoaderTest, FieldOfViewFollowsItsAxis) {
    const auto fov = [&](const std::string& axis) {
        return load(
                   "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='60'/><string "
                   "name='fovAxis' value='" +
                   axis +
                   "'/><film type='hdrfilm'><integer name='width' value='200'/><integer name='height' "
                   "value='100'/></film>"
                   "</sensor></scene>")
            .camera.fov_x;
    };
    const double t = std::tan(pi / 6);
    EXPECT_NEAR(fov("x"), 60.0, 1e-12);
    EXPECT_NEAR(fov("larger"), 60.0, 1e-12);
    EXPECT_NEAR(fov("y"), 2 * std::atan(2 * t) * 180 / pi, 1e-12);
    EXPECT_NEAR(fov("smaller"), 2 * std::atan(2 * t) * 180 / pi, 1e-12);
    EXPECT_NEAR(fov("diagonal"), 2 * std::atan(2 * t / std::sqrt(5.0)) * 180 / pi, 1e-12);
}

TEST_F(LoaderTest, WithoutAnAngleTheLensIsFiftyMillimetres) {
    const auto scene = load(
        "<scene version='3.0.0'><sensor type='perspective'><film type='hdrfilm'><integer name='width' value='300'/>"
        "<integer name='height' value='200'/></film></sensor></scene>");
    EXPECT_NEAR(scene.camera.fov_x, 2 * std::atan(36.0 / 100.0) * 180 / pi, 1e-9);
}

TEST_F(LoaderTest, DefaultsAreReplacedByParameters) {
    const std::string text =
        "<scene version='3.0.0'><default name='w' value='12'/><default name='ww' value='34'/><sensor "
        "type='perspective'>"
        "<film type='hdrfilm'><integer name='width' value='$ww'/><integer name='height' value='$w'/></film>"
        "</sensor></scene>";
    EXPECT_EQ(load(text).camera.width, 34);
    EXPECT_EQ(load(text).camera.height, 12);
    EXPECT_EQ(load(text, {{"w", "56"}}).camera.height, 56);
    EXPECT_NE(load(text).hash, load(text, {{"w", "56"}}).hash);
    EXPECT_THROW(load(text, {{"v", "1"}}), InputError);
}

TEST_F(LoaderTest, IncludesAndNestedReferencesAreFollowed) {
    std::filesystem::create_directories(folder_ / "parts");
    write("parts/materials.xml",
          "<scene version='3.0.0'><include filename='inner.xml'/><bsdf type='twosided' id='wall'><ref "
          "id='paint'/></bsdf></scene>");
    write("parts/inner.xml",
          "<scene version='3.0.0'><bsdf type='diffuse' id='paint'><rgb name='reflectance' "
          "value='$level'/></bsdf></scene>");
    const auto scene = load(
        "<scene version='3.0.0'><default name='level' value='0.25'/><sensor type='perspective'/>"
        "<shape type='sphere'><ref name='bsdf' id='wall'/></shape><include filename='parts/materials.xml'/></scene>");
    const Material& material = scene.materials.at(scene.shapes.at(0).material);
    EXPECT_TRUE(material.two_sided);
    EXPECT_FLOAT_EQ(std::get<Diffuse>(material.bsdf).reflectance.x, 0.25f);
}

TEST_F(LoaderTest, FilesOfAnIncludeAreLookedForBesideTheSceneAndThenBesideTheInclude) {
    std::filesystem::create_directories(folder_ / "fragments");
    const std::string mesh = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    write("a.obj", mesh);
    write("fragments/b.obj", mesh);
    write("fragments/shapes.xml",
          "<scene version='3.0.0'><shape type='obj'><string name='filename' value='a.obj'/></shape>"
          "<shape type='obj'><string name='filename' value='b.obj'/></shape></scene>");
    EXPECT_EQ(load_with_sensor("<include filename='fragments/shapes.xml'/>").shapes.size(), 2u);
}

TEST_F(LoaderTest, PublicCornellBoxesOpenUnmodified) {
    // In the manner of the scenes that come with Mitsuba 3 and of public collections: defaults, references before use
    // in a bsdf, a light with black reflectance, settings for other programs.
    const auto scene = load(R"(<?xml version="1.0" encoding="utf-8"?>
<scene version="3.0.0">
    <default name="spp" value="64"/> <default name="resx" value="256"/> <default name="max_depth" value="6"/>
    <default name="integrator" value="path"/>
    <integrator type="$integrator"> <integer name="max_depth" value="$max_depth"/> <boolean name="hide_emitters" value="true"/> </integrator>
    <sensor type="perspective" id="sensor">
        <string name="fov_axis" value="smaller"/> <float name="near_clip" value="0.001"/> <float name="far_clip" value="100.0"/>
        <float name="focus_distance" value="1000"/> <float name="fov" value="39.3077"/>
        <transform name="to_world"> <lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/> </transform>
        <sampler type="independent"> <integer name="sample_count" value="$spp"/> </sampler>
        <film type="hdrfilm"> <integer name="width" value="$resx"/> <integer name="height" value="$resx"/>
            <rfilter type="tent"/> <string name="pixel_format" value="rgb"/> <string name="component_format" value="float32"/> </film>
    </sensor>
    <bsdf type="twosided" id="White"><bsdf type="diffuse"><rgb name="reflectance" value="0.725, 0.71, 0.68"/></bsdf></bsdf>
    <bsdf type="diffuse" id="Light"><rgb name="reflectance" value="0, 0, 0"/></bsdf>
    <shape type="rectangle" id="Floor"><transform name="to_world">
        <matrix value="-4.37114e-008 1 4.37114e-008 0 0 -8.74228e-008 2 0 1 4.37114e-008 1.91069e-015 0 0 0 0 1"/></transform>
        <ref id="White"/></shape>
    <shape type="rectangle" id="Lamp"><transform name="to_world">
        <matrix value="0.235 -1.66103e-008 -7.80685e-009 -0.005 -2.05444e-008 3.90343e-009 -0.0893 1.98 2.05444e-008 0.19 8.30516e-009 -0.03 0 0 0 1"/>
        </transform><ref id="Light"/><emitter type="area"><rgb name="radiance" value="17, 12, 4"/></emitter></shape>
</scene>)");
    EXPECT_EQ(scene.max_depth, 6);
    EXPECT_EQ(scene.camera.width, 256);
    ASSERT_EQ(scene.shapes.size(), 2u);
    EXPECT_DOUBLE_EQ(scene.shapes[1].radiance->y, 12.0);
    EXPECT_TRUE(is_black(scene.materials[scene.shapes[1].material].bsdf));
    expect_near(normal_of(mesh_of(scene), 0), {0, 1, 0}, 1e-6);
    expect_near(normal_of(mesh_of(scene, 1), 0), {0, -1, 0}, 1e-6);
    EXPECT_FALSE(scene.notes.empty());
}

TEST_F(LoaderTest, OfSeveralSensorsTheFirstIsUsedAndANoteSaysSo) {
    const auto scene = load(
        "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='20'/></sensor>"
        "<sensor type='perspective'><float name='fov' value='70'/></sensor></scene>");
    EXPECT_EQ(scene.camera.fov_x, 20.0);
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_NE(scene.notes[0].find("more than one sensor: the first is used"), std::string::npos) << scene.notes[0];
}

TEST_F(LoaderTest, AMetalMayBeGivenByItsIndex) {
    const auto scene = load_with_sensor(
        "<bsdf type='conductor' id='a'><rgb name='eta' value='0.2, 0.9, 1.1'/><rgb name='k' value='3.9, 2.4, 2.2'/>"
        "</bsdf><shape type='rectangle'><ref id='a'/></shape>");
    const auto& conductor = std::get<Conductor>(scene.materials.at(scene.shapes.at(0).material).bsdf);
    EXPECT_EQ(conductor.eta, Color(0.2f, 0.9f, 1.1f));
    EXPECT_EQ(conductor.k, Color(3.9f, 2.4f, 2.2f));
}

TEST_F(LoaderTest, ColoursAreLinearUnlessTheySayOtherwise) {
    const auto reflectance = [&](const std::string& property) {
        const auto scene =
            load_with_sensor("<shape type='sphere'><bsdf type='diffuse'>" + property + "</bsdf></shape>");
        return std::get<Diffuse>(scene.materials.at(0).bsdf).reflectance;
    };
    EXPECT_FLOAT_EQ(reflectance("<rgb name='reflectance' value='0.1 0.2,0.3'/>").z, 0.3f);
    EXPECT_FLOAT_EQ(reflectance("<spectrum name='reflectance' value='0.4'/>").y, 0.4f);
    EXPECT_FLOAT_EQ(reflectance("<float name='reflectance' value='0.4'/>").y, 0.4f);
    EXPECT_NEAR(reflectance("<srgb name='reflectance' value='0.5'/>").x, 0.2140411f, 1e-6);
    EXPECT_NEAR(reflectance("<rgb name='reflectance' value='#ff8000'/>").y, 0.2158605f, 1e-6);
    EXPECT_FLOAT_EQ(reflectance("").x, 0.5f);
}

TEST_F(LoaderTest, ASpectrumThatEmitsIsEqualEnergyWhiteAndOneThatReflectsIsGrey) {
    const auto scene = load_with_sensor(
        "<shape type='sphere'>"
        "<bsdf type='diffuse'><spectrum name='reflectance' value='300:0.25, 900:0.25'/></bsdf>"
        "<emitter type='area'><spectrum name='radiance' value='300:2, 900:2'/></emitter></shape>"
        "<emitter type='point'><spectrum name='intensity' value='2'/></emitter>");
    const Color reflectance = std::get<Diffuse>(scene.materials.at(scene.shapes.at(0).material).bsdf).reflectance;
    for (const float channel : {reflectance.x, reflectance.y, reflectance.z}) EXPECT_NEAR(channel, 0.25, 1e-4);
    const ColorD white(1.20479, 0.94829, 0.90892);  // XYZ (1, 1, 1) in linear sRGB
    for (int channel = 0; channel < 3; ++channel) {
        EXPECT_NEAR((*scene.shapes.at(0).radiance)[channel], 2.0 * white[channel], 2e-3);
        EXPECT_NEAR(std::get<PointLightDescription>(scene.lights.at(0)).intensity[channel], 2.0 * white[channel], 1e-4);
    }
}

// The red wall as measured at Cornell, and the linear sRGB that Mitsuba's documentation prints for it ("Scene parsing
// and parameters", version 2, which weights with the observer alone).
TEST_F(LoaderTest, TheMeasuredRedWallHasItsPublishedRgb) {
    const auto scene = load_with_sensor(
        "<emitter type='point'><spectrum name='intensity' value='"
        "400:0.04, 404:0.046, 408:0.048, 412:0.053, 416:0.049, 420:0.05, 424:0.053, 428:0.055, 432:0.057, 436:0.056, "
        "440:0.059, "
        "444:0.057, 448:0.061, 452:0.061, 456:0.06, 460:0.062, 464:0.062, 468:0.062, 472:0.061, 476:0.062, 480:0.06, "
        "484:0.059, "
        "488:0.057, 492:0.058, 496:0.058, 500:0.058, 504:0.056, 508:0.055, 512:0.056, 516:0.059, 520:0.057, 524:0.055, "
        "528:0.059, "
        "532:0.059, 536:0.058, 540:0.059, 544:0.061, 548:0.061, 552:0.063, 556:0.063, 560:0.067, 564:0.068, 568:0.072, "
        "572:0.08, "
        "576:0.09, 580:0.099, 584:0.124, 588:0.154, 592:0.192, 596:0.255, 600:0.287, 604:0.349, 608:0.402, 612:0.443, "
        "616:0.487, "
        "620:0.513, 624:0.558, 628:0.584, 632:0.62, 636:0.606, 640:0.609, 644:0.651, 648:0.612, 652:0.61, 656:0.65, "
        "660:0.638, "
        "664:0.627, 668:0.62, 672:0.63, 676:0.628, 680:0.642, 684:0.639, 688:0.657, 692:0.639, 696:0.635, "
        "700:0.642'/></emitter>");
    EXPECT_NEAR(std::get<PointLightDescription>(scene.lights.at(0)).intensity.x, 0.569717, 5e-5);
    EXPECT_NEAR(std::get<PointLightDescription>(scene.lights.at(0)).intensity.y, 0.0430141, 5e-5);
    EXPECT_NEAR(std::get<PointLightDescription>(scene.lights.at(0)).intensity.z, 0.0443234, 5e-5);
}

TEST_F(LoaderTest, ShapesWithoutABsdfAreGreyAndPointLightsHaveAPlace) {
    const auto scene = load_with_sensor(
        "<shape type='disk'><transform name='to_world'><scale value='3'/><translate z='1'/></transform></shape>"
        "<emitter type='point'><transform name='to_world'><translate y='2'/></transform>"
        "<rgb name='intensity' value='1 2 3'/></emitter>");
    EXPECT_FLOAT_EQ(std::get<Diffuse>(scene.materials.at(scene.shapes[0].material).bsdf).reflectance.x, 0.5f);
    const auto& disk = std::get<DiskDescription>(scene.shapes[0].geometry);
    EXPECT_DOUBLE_EQ(disk.radius, 3.0);
    expect_near(disk.centre, {0, 0, 1});
    expect_near(std::get<PointLightDescription>(scene.lights.at(0)).position, {0, 2, 0});
}

TEST_F(LoaderTest, SpheresTakeCentreRadiusAndTransform) {
    const auto scene = load_with_sensor(
        "<shape type='sphere'><point name='center' x='1' y='2' z='3'/><float name='radius' value='2'/>"
        "<transform name='to_world'><scale value='10'/><translate x='5'/></transform></shape>");
    const auto& sphere = std::get<SphereDescription>(scene.shapes.at(0).geometry);
    expect_near(sphere.centre, {15, 20, 30});
    EXPECT_DOUBLE_EQ(sphere.radius, 20.0);
}

TEST_F(LoaderTest, ObjPolygonsAndNegativeIndicesBecomeTriangles) {
    write("mesh.obj", "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 2 0\nv 0 1 0\nf -5 -4 -3 -2 -1\n");
    const MeshDescription mesh = load_obj_mesh(folder_ / "mesh.obj", true);
    ASSERT_EQ(mesh.triangles.size(), 3u);
    EXPECT_TRUE(mesh.normals.empty());
    double area = 0.0;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto& t = mesh.triangles[i];
        area += 0.5 * (mesh.positions[t.y] - mesh.positions[t.x]).cross(mesh.positions[t.z] - mesh.positions[t.x]).z;
    }
    EXPECT_NEAR(area, 3.0, 1e-12);
}

TEST_F(LoaderTest, ObjNormalsAreReadDroppedOrComputed) {
    const std::string roof = "v -1 0 0\nv 0 1 0\nv 0 1 2\nv -1 0 2\nv 1 0 0\nv 1 0 2\n";
    write("bare.obj", roof + "f 1 4 3 2\nf 2 3 6 5\n");
    write("given.obj", roof + "vn 0 2 0\nf 1//1 4//1 3//1 2//1\nf 2//1 3//1 6//1 5//1\n");
    const MeshDescription computed = load_obj_mesh(folder_ / "bare.obj", false);
    ASSERT_EQ(computed.normals.size(), computed.positions.size());
    for (std::size_t i = 0; i < computed.positions.size(); ++i)
        if (computed.positions[i].y == 1.0) expect_near(computed.normals[i], {0, 1, 0}, 1e-12);
    EXPECT_TRUE(load_obj_mesh(folder_ / "bare.obj", true).normals.empty());
    EXPECT_TRUE(load_obj_mesh(folder_ / "given.obj", true).normals.empty());
    for (const VectorD& normal : load_obj_mesh(folder_ / "given.obj", false).normals) expect_near(normal, {0, 1, 0});
}

TEST_F(LoaderTest, TheHashFollowsEveryFileThatWasRead) {
    write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const std::string shape = "<shape type='obj'><string name='filename' value='mesh.obj'/></shape>";
    const std::string before = load_with_sensor(shape).hash;
    EXPECT_EQ(load_with_sensor(shape).hash, before);
    write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 2 0\nf 1 2 3\n");
    EXPECT_NE(load_with_sensor(shape).hash, before);
}

TEST_F(LoaderTest, TheCornellBoxOfThisRepositoryLoads) {
    const auto scene = load_scene_file(std::filesystem::path(PHOTONLAB_SOURCE_DIR) / "scenes/cornell-box/scene.xml");
    EXPECT_EQ(scene.name, "cornell-box");
    EXPECT_EQ(scene.shapes.size(), 8u);
    for (std::size_t shape = 0; shape < 5; ++shape) {
        // The room's surfaces face its middle.
        const MeshDescription& mesh = mesh_of(scene, shape);
        EXPECT_GT(normal_of(mesh, 0).dot(VectorD(278, 274, 280) - mesh.positions[mesh.triangles[0].x]), 0.0) << shape;
    }
}

}  // namespace
}  // namespace photonlab
