// Scenes that are large in an odd way: many notes, long names, many scenes at a time, surfaces that cover each other
// many times over.

#include <string>

#include "scene/narrow_gaps.h"
#include "scene/scene.h"
#include "tests/scene/described.h"
#include "tests/scene/scene_folder.h"

namespace photonlab {
namespace {

class LimitsTest : public SceneFolderTest {};

TEST_F(LimitsTest, NotesAreTextOfBoundedLengthEachOnce) {
    std::string many;
    for (int i = 0; i < 3000; ++i)
        many += "<integrator type='x" + std::to_string(i) + "'/><integrator type='x" + std::to_string(i) + "'/>";
    const auto scene = load_as("3.0.0", many);
    ASSERT_EQ(scene.notes.size(), 3000u);
    EXPECT_EQ(scene.notes.at(0), "of integrator \"x0\" only max_depth is read");
    EXPECT_EQ(scene.notes.at(2999), "of integrator \"x2999\" only max_depth is read");

    const std::string letters(60'000, 'a');
    std::string umlauts;
    for (int i = 0; i < 30'000; ++i) umlauts += "\xc3\xa4";
    for (const std::string& type : {letters, umlauts}) {
        const auto noted = load_as("3.0.0", "<integrator type='" + type + "'/>");
        ASSERT_EQ(noted.notes.size(), 1u);
        EXPECT_LT(noted.notes.at(0).size(), 1100u);
        EXPECT_TRUE(noted.notes.at(0).ends_with(type.substr(0, 2) + "..."));
    }
}

// The longest of the names that fit, however many there are and however long: not tried length by length.
TEST_F(LimitsTest, NamesOfValuesMayBeLongAndMany) {
    std::string defaults, name;
    for (int i = 0; i < 200; ++i) {
        name += "ab";
        defaults += "<default name='" + name + "' value='" + std::to_string(i + 1) + "'/>";
    }
    const auto width_of = [&](const std::string& value, const std::string& more) {
        return load("<scene version='3.0.0'>" + defaults + more +
                    "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='" + value +
                    "'/></film></sensor></scene>")
            .camera.width;
    };
    EXPECT_EQ(width_of("$ab", ""), 1);
    EXPECT_EQ(width_of("$ababab", ""), 3);
    EXPECT_EQ(width_of("$ababab0", "<default name='ababab1' value='7'/>"), 30) << "the 0 is no part of it";
    EXPECT_EQ(width_of("$ababab1", "<default name='ababab1' value='7'/>"), 7);
}

TEST_F(LimitsTest, AValueOfManyLettersThatIsNoNameIsRefusedAtOnce) {
    const std::string letters(60'000, 'a');
    EXPECT_EQ(message_of("<scene version='3.0.0'>\n<default name='" + letters + "b' value='1'/><shape type='$" +
                         letters + "'/></scene>"),
              "scene.xml:2: $" + letters.substr(0, 60) + "... has no <default> before it and no value was given");
}

// Embree makes about a thousand devices: its scenes share one.
TEST_F(LimitsTest, ThousandsOfScenesAreHeldAtATime) {
    std::vector<Scene> scenes;
    const auto description = describe({shape(square({0, 0, 0}, {1, 0, 0}, {0, 1, 0}))});
    for (int i = 0; i < 3000; ++i) scenes.push_back(build_scene(description));
    for (const Scene& scene : {std::cref(scenes.front()), std::cref(scenes.back())})
        EXPECT_TRUE(intersect(scene, {Vector(0.1f, 0.1f, 1.0f), Vector(0.0f, 0.0f, -1.0f)}));
}

/// So many triangles: of a grid, or each from wall to wall.
MeshDescription many_triangles(std::uint32_t count, bool is_crowded) {
    MeshDescription mesh;
    RandomStream random = stream_of_scenes();
    for (std::uint32_t i = 0; i < count; ++i) {
        const VectorD corner(i % 100, i / 100, 0.0);
        for (const VectorD& step : {VectorD(0, 0, 0), VectorD(0.5, 0, 0), VectorD(0, 0.5, 0)})
            mesh.positions.push_back(is_crowded ? VectorD(random.next(), random.next(), random.next()) : corner + step);
        mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    }
    return mesh;
}

// A ray meets the boxes of all triangles around it: where there are thousands, fewer points are tried.
TEST_F(LimitsTest, GapsAreLookedForWithBoundedWork) {
    constexpr std::uint32_t count = 20'000;
    EXPECT_EQ(find_narrow_gaps(build_scene(describe({shape(many_triangles(count, false))}))).tried, 4 * count);
    const NarrowGaps crowded = find_narrow_gaps(build_scene(describe({shape(many_triangles(count, true))})));
    EXPECT_LT(crowded.tried, count);
    EXPECT_GT(crowded.tried, count / 20);
    // What covers all is found all the same.
    MeshDescription twice = many_triangles(count, true);
    const auto triangles = twice.triangles;
    twice.triangles.insert(twice.triangles.end(), triangles.begin(), triangles.end());
    const NarrowGaps gaps = find_narrow_gaps(build_scene(describe({shape(std::move(twice))})));
    EXPECT_GT(gaps.found, gaps.tried / 4);
}

TEST_F(LimitsTest, ClippingPlanesAreNotedWhereTheyWouldCut) {
    const auto notes = [&](const std::string& sensor, const std::string& distance) {
        return load("<scene version='3.0.0'><sensor type='perspective'>" + sensor +
                    "</sensor><shape type='rectangle'><transform name='to_world'><translate z='" + distance +
                    "'/></transform></shape></scene>")
            .notes;
    };
    EXPECT_TRUE(notes("", "5").empty());
    EXPECT_TRUE(notes("", "-20000").empty()) << "behind the camera";
    EXPECT_EQ(notes("", "20000"),
              std::vector<std::string>{"far_clip 10000: what is farther from the camera is shown all the same"});
    EXPECT_EQ(notes("", "0.005"),
              std::vector<std::string>{"near_clip 0.01: what is nearer to the camera is shown all the same"});
    EXPECT_TRUE(notes("<float name='near_clip' value='1'/><float name='far_clip' value='100'/>", "5").empty());
    EXPECT_EQ(notes("<float name='near_clip' value='10'/>", "5").size(), 1u);
    EXPECT_EQ(notes("<float name='farClip' value='4'/>", "5").size(), 1u);
}

}  // namespace
}  // namespace photonlab
