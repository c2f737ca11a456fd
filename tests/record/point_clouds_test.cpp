// Point clouds hold what is gathered and where, in scene units, and no more of it than was asked for.

#include "record/images/point_clouds.h"

#include <gtest/gtest.h>

#include <cstring>

#include "tests/support/two_walls.h"

namespace photonlab {
namespace {

constexpr std::size_t photon_bytes = 9 * sizeof(float) + 1 + 2;
constexpr std::size_t point_bytes = 6 * sizeof(float) + 2 * 2 + sizeof(float) + 2;

class PointClouds : public ::testing::Test {
protected:
    /// What follows the header, which must promise `count` vertices of so many bytes.
    static std::string vertices_of(const std::string& ply, std::size_t count, std::size_t bytes) {
        EXPECT_EQ(ply.substr(0, 4), "ply\n");
        EXPECT_NE(ply.find("\nelement vertex " + std::to_string(count) + "\n"), std::string::npos);
        const std::string end = "end_header\n";
        const std::string rest = ply.substr(ply.find(end) + end.size());
        EXPECT_EQ(rest.size(), count * bytes);
        return rest;
    }

    static float number(const std::string& vertices, std::size_t byte) {
        float value = 0.0f;
        std::memcpy(&value, vertices.data() + byte, sizeof(value));
        return value;
    }

    TestFolder folder_;
    const Scene scene_ = build_scene(load_scene_file(folder_.write("scene.xml", two_walls_scene)));
};

// Of light that comes straight from the lamp every path leaves at most one photon, with its share of all power, on a
// wall below or behind it: y is 0, or z is -2.
TEST_F(PointClouds, PhotonsLieOnTheWallsWithTheirShareOfThePower) {
    const PhotonPass pass = trace_photons(scene_, {.paths = 4000, .max_depth = 2, .store_direct = true}, 1, 1);
    const std::size_t count = pass.photons.size();
    ASSERT_GT(count, 1000u);
    const std::string all = vertices_of(photons_as_ply(scene_, pass, 1'000'000), count, photon_bytes);
    const auto lamp = static_cast<float>(8.0 * pi);  // red, of 8 a steradian and area: pi L A, and A is 1
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t at = i * photon_bytes;
        const float x = number(all, at), y = number(all, at + 4), z = number(all, at + 8);
        EXPECT_LT(std::abs(x), 2.0001f);
        EXPECT_TRUE(std::abs(y) < 1e-4f || std::abs(z + 2.0f) < 1e-4f) << y << ' ' << z;
        EXPECT_LT(number(all, at + 16), 0.0f) << "it flew down from the lamp";
        EXPECT_NEAR(number(all, at + 24), lamp / 4000.0f, 1e-5f * lamp / 4000.0f);
        EXPECT_EQ(all[at + 36], 0) << "no caustic";
        EXPECT_EQ(all[at + 37], 1) << "one edge";
    }
    const std::string sample = vertices_of(photons_as_ply(scene_, pass, 10), 10, photon_bytes);
    EXPECT_EQ(sample.substr(0, photon_bytes), all.substr(0, photon_bytes));
    EXPECT_EQ(sample.substr(9 * photon_bytes), all.substr(9 * count / 10 * photon_bytes, photon_bytes));
    vertices_of(photons_as_ply(scene_, {}, 10), 0, photon_bytes);
}

TEST_F(PointClouds, HitPointsSayWhichPixelTheyBelongTo) {
    const HitPoints points = trace_hit_points(scene_, 1, 1);
    const std::size_t count = points.points.size();
    const std::string all = vertices_of(hit_points_as_ply(scene_, points, count), count, point_bytes);
    for (std::size_t i = 0; i < count; ++i) {
        std::uint16_t pixel[2];
        std::memcpy(pixel, all.data() + i * point_bytes + 24, 4);
        EXPECT_EQ(pixel[1] * 12u + pixel[0], points.points[i].pixel);
        const float y = number(all, i * point_bytes + 4), z = number(all, i * point_bytes + 8);
        EXPECT_TRUE(std::abs(y) < 1e-4f || std::abs(z + 2.0f) < 1e-4f || std::abs(y - 3.0f) < 1e-4f) << y << ' ' << z;
        EXPECT_EQ(number(all, i * point_bytes + 28), 1.0f);
    }
}

}  // namespace
}  // namespace photonlab
