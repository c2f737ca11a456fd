// Light from infinity: where an image of the surroundings stands, how it is drawn, and that photons and connections
// bring the irradiance of closed forms, whatever lies around the scene.
//
// Means are compared within 4.5 standard errors, which chance exceeds with 7e-6; seeds are fixed.

#include <gtest/gtest.h>

#include "core/error.h"
#include "image/read_image.h"
#include "scene/emitter.h"
#include "scene/emitters/light_reader.h"
#include "scene/mitsuba/xml_reader.h"
#include "tests/scene/described.h"
#include "tests/scene/scene_folder.h"
#include "tests/support/chi_square.h"

namespace photonlab {
namespace {

using Rows = EnvironmentImage::Rows;

ColorImage black(int width, int height) {
    return {width, height, std::vector<Color>(static_cast<std::size_t>(width * height), Color(0.0f))};
}

/// Towards (u, v) of the image: u = atan2(x, -z) / (2 pi), v = acos(y) / pi.
VectorD direction_at(double u, double v) {
    return {std::sin(pi * v) * std::sin(2.0 * pi * u), std::cos(pi * v), -std::sin(pi * v) * std::cos(2.0 * pi * u)};
}

TEST(EnvironmentImages, HaveOneBrightTexelWhereMitsubaHasIt) {
    ColorImage image = black(8, 5);
    image.pixels[3 * 8 + 6] = Color(2.0f, 4.0f, 8.0f);  // row 3, column 6
    const EnvironmentImage old(image, Rows::Centred);
    const EnvironmentImage current(image, Rows::FromPoleToPole);
    const auto at = [](const EnvironmentImage& map, double u, double v) { return map.radiance(direction_at(u, v)).y; };
    EXPECT_NEAR(at(old, 6.5 / 8, 3.5 / 5), 4.0, 1e-9);
    EXPECT_NEAR(at(current, 6.5 / 8, 3.0 / 4), 4.0, 1e-9);
    EXPECT_NEAR(at(old, 7.0 / 8, 3.5 / 5), 2.0, 1e-9) << "half a column to the right";
    EXPECT_NEAR(at(old, 6.5 / 8, 3.0 / 5), 2.0, 1e-9) << "half a row up";
    EXPECT_NEAR(at(current, 6.5 / 8, 2.5 / 4), 2.0, 1e-9);
    EXPECT_EQ(at(old, 5.4 / 8, 3.5 / 5), 0.0);
    EXPECT_EQ(at(current, 6.5 / 8, 1.99 / 4), 0.0);
}

TEST(EnvironmentImages, GoAroundAndReachThePoles) {
    ColorImage image = black(4, 3);
    image.pixels[1 * 4 + 0] = Color(1.0f);
    image.pixels[0 * 4 + 1] = Color(3.0f);
    const EnvironmentImage old(image, Rows::Centred);
    EXPECT_NEAR(old.radiance(direction_at(0.0, 0.5)).x, 0.5, 1e-9) << "between the last column and the first";
    EXPECT_NEAR(old.radiance(direction_at(1.5 / 4, 0.05)).x, 3.0, 1e-9) << "above the middle of the first row";
    const EnvironmentImage current(image, Rows::FromPoleToPole);
    EXPECT_NEAR(current.radiance(direction_at(1.5 / 4, 1e-6)).x, 3.0, 1e-4);
}

class EnvironmentDensity : public ::testing::TestWithParam<Rows> {};
INSTANTIATE_TEST_SUITE_P(Both, EnvironmentDensity, ::testing::Values(Rows::Centred, Rows::FromPoleToPole));

TEST_P(EnvironmentDensity, IsThatOfItsSamplesAndCoversWhatShines) {
    ColorImage image = black(16, 9);
    for (int i = 0; i < 16 * 9; ++i)
        image.pixels[static_cast<std::size_t>(i)] = Color(0.1f + 0.01f * static_cast<float>((i * 7) % 13));
    image.pixels[2 * 16 + 15] = Color(20.0f);
    image.pixels[0] = Color(0.0f);
    const EnvironmentImage map(image, GetParam());
    RandomStream random = stream_of_scenes();
    expect_distributed(
        [&] {
            const VectorD direction = map.sample(random.next_2d());
            return std::pair(direction.y, turn_to(-direction.z, direction.x));
        },
        [&](double y, double u) { return map.density(direction_at(u, std::acos(y) / pi)) * 2.0 * pi; }, -1.0, 1.0, 0.0,
        1.0, 200'000, 64);
    for (int i = 0; i < 2000; ++i) {
        const VectorD direction = VectorD(sample_unit_sphere(random.next_2d())).normalized();
        if (map.radiance(direction).x > 0.0) {
            EXPECT_GT(map.density(direction), 0.0);
        }
    }
}

// ---------------------------------------------------------------------------------------------------------------------

constexpr double floor_size = 8.0;

/// A floor of 8 x 8 around the origin that faces up (+z), and what else there is.
SceneDescription open_floor(LightDescription light, bool on_a_plain = false) {
    SceneDescription description = describe({floor_of_eight()});
    description.lights = {std::move(light)};
    description.materials[0].two_sided = false;
    description.camera.to_world[3][2] = 5.0;
    if (on_a_plain) description.shapes.push_back(shape(square({0, 0, -3}, {4e6, 0, 0}, {0, 4e6, 0})));
    return description;
}

/// Irradiance on the floor's upper side by photons that come straight from the light: mean and standard error.
std::pair<double, double> irradiance_by_photons(const Scene& scene, int paths) {
    RandomStream random = stream_of_scenes();
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < paths; ++i) {
        const Imath::V2f u = random.next_2d();
        const double u_triangle = random.next_double();
        const EmissionSample emission = sample_emission(scene, 0, u, u_triangle, random.next_2d());
        const auto hit = intersect(scene, emission.ray);
        const bool arrives = hit && hit->shape == 0 && emission.ray.direction.z < 0.0f;
        const double value = arrives ? static_cast<double>(emission.weight.y) : 0.0;
        sum += value;
        squares += value * value;
    }
    const double area = floor_size * floor_size / (scene.unit_length * scene.unit_length);
    const double scale = scene.total_power / area;
    const double mean = sum / paths;
    return {mean * scale, scale * std::sqrt((squares / paths - mean * mean) / paths)};
}

std::pair<double, double> irradiance_by_connections(const Scene& scene, int samples) {
    RandomStream random = stream_of_scenes();
    double sum = 0.0, squares = 0.0;
    const Vector receiver = to_box(scene, {1.0, 2.0, 0.0});
    for (int i = 0; i < samples; ++i) {
        const Imath::V2f u = random.next_2d();
        const auto light = sample_direct(scene, 0, receiver, u, random.next_double());
        const bool arrives =
            light && light->direction.z > 0.0f &&
            !is_occluded(scene, {offset_from_surface(receiver, {0, 0, 1}, light->direction), light->position});
        const double value = arrives ? light->radiance.y * light->direction.z / light->density : 0.0;
        sum += value;
        squares += value * value;
    }
    const double mean = sum / samples;
    return {mean, std::sqrt(std::max(0.0, squares / samples - mean * mean) / samples)};
}

void expect_irradiance(const SceneDescription& description, double expected) {
    const Scene scene = build_scene(description);
    for (const auto& [mean, error] :
         {irradiance_by_photons(scene, 200'000), irradiance_by_connections(scene, 100'000)}) {
        EXPECT_NEAR(mean, expected, 4.5 * error + 2e-5 * expected);
        EXPECT_LT(error, 0.01 * expected) << "too noisy to see an error";
    }
}

TEST(LightFromInfinity, OfOneColourGivesPiTimesItsRadiance) {
    for (const bool on_a_plain : {false, true})
        expect_irradiance(open_floor(ConstantDescription{.radiance = ColorD(2.0), .place = "test:1"}, on_a_plain),
                          2.0 * pi);
}

TEST(LightFromInfinity, FromOneDirectionGivesItsCosine) {
    for (const bool on_a_plain : {false, true})
        expect_irradiance(open_floor(
                              DirectionalDescription{
                                  .direction = VectorD(0.6, 0, -0.8), .irradiance = ColorD(3.0), .place = "test:1"},
                              on_a_plain),
                          3.0 * 0.8);
}

// A sky that is 1 in the upper half and dark below: local y is turned to the world's z.
TEST(LightFromInfinity, FromAnImageGivesWhatShinesOnTheFloor) {
    ColorImage image = black(64, 33);
    for (std::size_t i = 0; i < 64 * 16; ++i) image.pixels[i] = Color(1.0f);
    const auto sky = std::make_shared<const EnvironmentImage>(image, Rows::FromPoleToPole);
    const TextureAxes axes{VectorD(1, 0, 0), VectorD(0, 0, 1), VectorD(0, -1, 0)};
    // From the row at the horizon, which is dark, to the one above it, at 1/32 of a half turn, it rises linearly:
    // E = 2 pi (integral of L cos sin): half of it without that band is 0.5 cos^2 of it.
    const double band = pi / 32.0;
    double in_band = 0.0;
    for (int i = 0; i < 1000; ++i) {
        const double above = band * (i + 0.5) / 1000.0;
        in_band += above / band * std::sin(above) * std::cos(above) * band / 1000.0;
    }
    const double expected = 2.0 * pi * (0.5 * std::cos(band) * std::cos(band) + in_band);
    for (const bool on_a_plain : {false, true})
        expect_irradiance(
            open_floor(EnvironmentMapDescription{.image = sky, .axes = axes, .place = "test:1"}, on_a_plain), expected);
}

TEST(LightFromInfinity, IsSeenByRaysThatLeaveTheScene) {
    ColorImage image = black(8, 5);
    image.pixels[2 * 8 + 2] = Color(5.0f);  // towards +x
    const auto sky = std::make_shared<const EnvironmentImage>(image, Rows::FromPoleToPole);
    const Scene scene =
        build_scene(open_floor(EnvironmentMapDescription{.image = sky, .scale = 2.0, .place = "test:1"}));
    ASSERT_TRUE(scene.environment);
    const Vector centre(direction_at(2.5 / 8, 0.5));
    EXPECT_NEAR(escaped_radiance(scene, centre).x, 10.0, 1e-4);
    EXPECT_EQ(escaped_radiance(scene, -centre), ColorD(0.0));
    EXPECT_EQ(escaped_radiance(build_scene(describe({floor_of_eight()})), centre), ColorD(0.0));
}

TEST(LightFromInfinity, AroundTheSceneIsOnce) {
    SceneDescription description = open_floor(ConstantDescription{.radiance = ColorD(1.0), .place = "test:1"});
    description.lights.push_back(ConstantDescription{.radiance = ColorD(1.0), .place = "test:2"});
    EXPECT_THROW(build_scene(description), InputError);
}

TEST(UnitBox, IsMadeForWhatStandsOnAPlain) {
    SceneDescription description = open_floor(ConstantDescription{.radiance = ColorD(1.0), .place = "test:1"}, true);
    EXPECT_NEAR(build_scene(description).unit_length, floor_size, 1e-9);
    EXPECT_EQ(build_scene(description).notes.size(), 1u);
    description.camera.to_world[3][2] = 5e6;  // from there the plain is what is seen
    EXPECT_NEAR(build_scene(description).unit_length, 8e6, 1.0);
}

/// A square of that size at the origin, and a camera that looks down on it from `distance`.
SceneDescription seen_from_above(double distance, double fov_degrees, std::vector<ShapeDescription> shapes) {
    SceneDescription description = describe(std::move(shapes));
    description.camera.to_world = Matrix(1, 0, 0, 0, 0, -1, 0, 0, 0, 0, -1, 0, 0, 0, distance, 1);
    description.camera.fov_x = fov_degrees;
    description.lights = {ConstantDescription{.radiance = ColorD(1.0), .place = "test:1"}};
    return description;
}

ShapeDescription flat(double size, double height = 0.0) {
    return shape(square({0, 0, height}, {0.5 * size, 0, 0}, {0, 0.5 * size, 0}));
}

// What a narrow view shows large is what the scene is about, from however far.
TEST(UnitBox, IsMadeForWhatALongLensShows) {
    EXPECT_NEAR(build_scene(seen_from_above(25.0, 5.0, {flat(1.0), flat(8e6, -1.0)})).unit_length, 1.0, 1e-9);
    EXPECT_NEAR(build_scene(seen_from_above(300.0, 0.5, {flat(1.0), flat(8e6, -1.0)})).unit_length, 1.0, 1e-9);
    EXPECT_NEAR(build_scene(seen_from_above(300.0, 60.0, {flat(1.0), flat(8e6, -1.0)})).unit_length, 8e6, 1.0);
}

TEST(UnitBox, IsMadeForTheInnermostThatIsSeen) {
    EXPECT_NEAR(build_scene(seen_from_above(3.0, 40.0, {flat(1.0), flat(300.0, -1.0), flat(1e6, -2.0)})).unit_length,
                1.0, 1e-9);
    EXPECT_NEAR(build_scene(seen_from_above(300.0, 40.0, {flat(1.0), flat(300.0, -1.0), flat(1e6, -2.0)})).unit_length,
                300.0, 1e-6);
}

// A lamp or a trinket close to the camera does not make the room around it a surrounding.
TEST(UnitBox, HoldsTheRoomAroundASmallLamp) {
    const ShapeDescription room = shape(cube({0, 0, 0}, 2.0));
    const ShapeDescription lamp = shape(SphereDescription{.centre = {0, 0, 0.9}, .radius = 0.01}, ColorD(1.0));
    EXPECT_EQ(build_scene(seen_from_above(1.0, 40.0, {room, lamp})).unit_length, 4.0);
    SceneDescription trinket = seen_from_above(1.0, 40.0, {room, shape(lamp.geometry)});
    trinket.lights = {PointLightDescription{.position = {0, 0, 1.5}, .intensity = ColorD(1.0), .place = "test:1"}};
    EXPECT_EQ(build_scene(trinket).unit_length, 4.0);
    // On a plain beyond what floats resolve it is what the scene is about all the same.
    SceneDescription lamp_on_a_plain = seen_from_above(1.0, 40.0, {flat(8e6), lamp});
    EXPECT_NEAR(build_scene(lamp_on_a_plain).unit_length, 0.02, 1e-9);
}

// ---------------------------------------------------------------------------------------------------------------------

class LightsInFiles : public SceneFolderTest {};

TEST_F(LightsInFiles, AreReadWithTheirNamesInBothFamilies) {
    const std::string lights =
        "<emitter type='directional'><vector name='direction' x='0' y='0' z='-2'/>"
        "<rgb name='irradiance' value='3'/><float name='NAME' value='4'/></emitter>";
    for (const auto& [version, name] : {std::pair("0.6.0", "samplingWeight"), std::pair("3.0.0", "sampling_weight")}) {
        std::string text = lights;
        text.replace(text.find("NAME"), 4, name);
        const auto scene = load_as(version, text);
        const auto& light = std::get<DirectionalDescription>(scene.lights.at(0));
        EXPECT_EQ(light.direction, VectorD(0, 0, -1));
        EXPECT_EQ(light.irradiance, ColorD(3.0));
        EXPECT_EQ(light.sampling_weight, 4.0);
    }
}

TEST_F(LightsInFiles, AreChosenByTheirSamplingWeight) {
    const auto description = load_as("3.0.0",
                                     "<shape type='rectangle'/>"
                                     "<emitter type='point'><float name='sampling_weight' value='3'/></emitter>"
                                     "<emitter type='point'/>");
    const Scene scene = build_scene(description);
    EXPECT_NEAR(scene.emitters[0].choice_probability, 0.75, 1e-12);
    EXPECT_NEAR(scene.emitters[0].photon_power.x * 0.75 + scene.emitters[1].photon_power.x * 0.25, 1.0, 1e-6);
}

TEST_F(LightsInFiles, OfTheSkyAreRefusedWithTheWayRound) {
    for (const std::string kind : {"sky", "sun", "sunsky"})
        EXPECT_EQ(message_of("<scene version='0.6.0'>\n<emitter type='" + kind + "'/></scene>"),
                  "scene.xml:2: emitter \"" + kind +
                      "\": models of the sky are not built in; an image of it can light the scene: <emitter "
                      "type=\"envmap\"> with a filename");
}

/// An image of one grey in 8 bits, as a TGA, and one of radiances, as an HDR.
class SurroundingsInFiles : public LightsInFiles {
protected:
    void SetUp() override {
        LightsInFiles::SetUp();
        std::string tga(18, '\0');
        tga[2] = 2;  // without compression, in colour
        tga[12] = 4;
        tga[14] = 2;
        tga[16] = 24;
        write("grey.tga", tga + std::string(4 * 2 * 3, '\x80'));
        std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 4\n";
        for (int i = 0; i < 8; ++i) hdr += "\x80\x80\x80\x82";  // 2
        write("two.hdr", hdr);
    }

    double radiance(const std::string& version, const std::string& file, const std::string& properties) const {
        const auto scene = load_as(version, "<emitter type='envmap'><string name='filename' value='" + file + "'/>" +
                                                properties + "</emitter>");
        return std::get<EnvironmentMapDescription>(scene.lights.at(0)).image->radiance({0, 0, 1}).x;
    }
};

// envmap.cpp of 0.6: gamma in place of the file's own; 1 is linear whatever the file, -1 is sRGB.
TEST_F(SurroundingsInFiles, AreDecodedByTheirGamma) {
    const auto gamma = [](const std::string& value) { return "<float name='gamma' value='" + value + "'/>"; };
    constexpr double grey = 128.0 / 255.0;
    EXPECT_NEAR(radiance("3.0.0", "grey.tga", ""), srgb_to_linear(grey), 1e-6);
    EXPECT_NEAR(radiance("0.6.0", "grey.tga", ""), srgb_to_linear(grey), 1e-6);
    EXPECT_NEAR(radiance("0.6.0", "grey.tga", gamma("1")), grey, 1e-6);
    EXPECT_NEAR(radiance("0.6.0", "grey.tga", gamma("-1")), srgb_to_linear(grey), 1e-6);
    EXPECT_NEAR(radiance("0.6.0", "grey.tga", gamma("2.2")), std::pow(grey, 2.2), 1e-6);
    EXPECT_NEAR(radiance("0.6.0", "two.hdr", gamma("1")), 2.0, 1e-6);
    EXPECT_NEAR(radiance("0.6.0", "two.hdr", ""), 2.0, 1e-6);
    EXPECT_NEAR(radiance("3.0.0", "two.hdr", ""), 2.0, 1e-6);
}

// Each is large, so the second is refused where the file is read.
TEST_F(SurroundingsInFiles, AreOnceInAFile) {
    const std::string map = "<emitter type='envmap'><string name='filename' value='two.hdr'/></emitter>\n";
    EXPECT_EQ(message_of("<scene version='3.0.0'><sensor type='perspective'/>\n" + map + map + map + "</scene>"),
              "scene.xml:3: expected one light around the scene, got a second; the first is at scene.xml:2");
}

// A scene's images have at most 2^27 pixels in all; this one has 8.
TEST_F(SurroundingsInFiles, CountAsTexturesDo) {
    write("scene.xml",
          "<scene version='3.0.0'>\n<emitter type='envmap'><string name='filename' value='two.hdr'/>"
          "</emitter></scene>");
    BytesRead bytes_read;
    const XmlElement scene = read_scene_xml(folder_ / "scene.xml", {}, bytes_read);
    std::map<std::string, std::shared_ptr<const ColorImage>> images;
    std::map<std::array<double, 4>, std::shared_ptr<const RoughCoats>> rough_coats;
    for (const std::size_t room : {8u, 7u}) {
        std::size_t pixels = (std::size_t{1} << 27) - room;
        const SceneSource source{.resolve = [](const XmlElement& element) -> const XmlElement& { return element; },
                                 .bytes_read = bytes_read,
                                 .image_pixels = pixels,
                                 .note = [](const std::string&) {},
                                 .images = images,
                                 .rough_coats = rough_coats};
        if (room == 8) {
            EXPECT_NO_THROW(read_scene_light(scene.children.at(0), source));
            EXPECT_EQ(pixels, std::size_t{1} << 27);
        } else {
            EXPECT_THROW(read_scene_light(scene.children.at(0), source), InputError);
        }
    }
}

TEST_F(SurroundingsInFiles, AreRefusedWithThePlaceOfWhatIsWrong) {
    const auto refusal = [&](const std::string& file, const std::string& transform) {
        return message_of(
            "<scene version='3.0.0'><sensor type='perspective'/>\n<emitter type='envmap'>\n"
            "<string name='filename' value='" +
            file + "'/>\n<transform name='to_world'>" + transform + "</transform></emitter></scene>");
    };
    EXPECT_EQ(refusal("two.hdr", "<rotate z='1' angle='45'/><scale x='2' z='1.5811388300841898'/>"),
              "scene.xml:4: to_world: expected a transform without shear, whose axes stay at right angles");
    write("text.hdr", "text");
    EXPECT_TRUE(refusal("text.hdr", "").starts_with("scene.xml:3: text.hdr: "));
    EXPECT_EQ(refusal("two.hdr", ""), "no error");
}

TEST_F(LightsInFiles, AreTurnedAndNotStretched) {
    const std::string light = "<emitter type='directional'>\n<transform name='to_world'>";
    const auto refusal = [&](const std::string& version, const std::string& transform) {
        return message_of("<scene version='" + version + "'><sensor type='perspective'/>" + light + transform +
                          "</transform></emitter></scene>");
    };
    EXPECT_EQ(refusal("3.0.0", "<scale x='2'/>"),
              "scene.xml:2: to_world: expected a transform that scales alike along all axes");
    EXPECT_EQ(refusal("3.0.0", "<scale z='0'/>").substr(0, 12), "scene.xml:2:");
    const auto notes = [&](const std::string& transform) {
        return load_as("3.0.0", light + transform + "</transform></emitter>").notes;
    };
    EXPECT_TRUE(notes("<rotate x='1' angle='30'/>").empty());
    EXPECT_TRUE(notes("<scale x='-1'/>").empty());
    ASSERT_EQ(notes("<scale value='2'/>").size(), 1u);
    EXPECT_EQ(notes("<scale value='2'/>")[0],
              "emitter \"directional\": the scale of its to_world, 2, changes nothing of a light");
}

TEST_F(LightsInFiles, OfOneColourMayBeTurned) {
    const auto scene = load_as("3.0.0",
                               "<emitter type='constant'><transform name='to_world'><rotate x='1' angle='90'/>"
                               "</transform></emitter>");
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_EQ(scene.notes[0], "emitter \"constant\": not read: to_world: it is the same from everywhere");
}

}  // namespace
}  // namespace photonlab
