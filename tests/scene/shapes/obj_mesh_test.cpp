// OBJ meshes: what the format allows is read exactly, as Mitsuba reads it, and what it does not allow is refused with
// its line.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "scene/loader.h"
#include "scene/shapes/meshes/obj.h"

namespace photonlab {
namespace {

const std::string square_vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

/// Meshes written from text to a folder of the test's own, which is removed afterwards.
class ObjMeshTest : public ::testing::Test {
protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() / (std::string("photonlab-ObjMeshTest-") + test->name());
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    MeshDescription load(const std::string& text, bool face_normals = true) const {
        std::ofstream(folder_ / "mesh.obj", std::ios::binary) << text;
        return load_obj_mesh(folder_ / "mesh.obj", face_normals);
    }

    /// The message of the error that `text` raises, without its folder.
    std::string message_of(const std::string& text) const {
        try {
            load(text);
        } catch (const InputError& error) {
            return std::string(error.what()).substr(folder_.string().size() + 1);
        }
        return "no error";
    }

    std::filesystem::path folder_;
};

double area_of(const MeshDescription& mesh) {
    double area = 0.0;
    for (const auto& t : mesh.triangles)
        area +=
            0.5 * (mesh.positions[t.y] - mesh.positions[t.x]).cross(mesh.positions[t.z] - mesh.positions[t.x]).length();
    return area;
}

TEST_F(ObjMeshTest, LinesEndInEveryWayAndAreCountedTheSame) {
    for (const std::string end : {"\n", "\r\n", "\r"}) {
        const std::string vertices = "v 0 0 0" + end + "v 1 0 0" + end + "v 0 1 0" + end;
        EXPECT_EQ(load(vertices + "f 1 2 3").triangles.size(), 1u);
        EXPECT_EQ(message_of(vertices + end + "f 1 2 4"), "mesh.obj:5: a face names vertex 4, but there are 3");
    }
}

TEST_F(ObjMeshTest, NumbersAreReadExactlyHoweverTheyAreWritten) {
    const auto mesh =
        load("v .5 -.25 +2\nv 1.5e+2 3. -4.37114e-008\nv 552.8 5E-1 0 1.0\nv 549.6 0.1 1 0.9 0.8 0.7\nf 1 2 3 4\n");
    const VectorD expected[] = {{0.5, -0.25, 2.0}, {150.0, 3.0, -4.37114e-8}, {552.8, 0.5, 0.0}, {549.6, 0.1, 1.0}};
    ASSERT_EQ(mesh.positions.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i)
        for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(mesh.positions[i][axis], expected[i][axis]) << i << " " << axis;
}

// Lines as nearly all programs write them are read sooner than others, and no otherwise.
TEST_F(ObjMeshTest, PlainLinesAreReadAsAnyOther) {
    const std::string plain =
        "v 0.1 0 0\nv 1 0 0.3\nv 1 1e-3 0\nv 0 1 0\nvt 0.1 0.7\nvt 1 0\nvn 0 0 2\nvn 0 0.1 1\n"
        "f 1 2 3\nf 1/1 2/2 3/1 4/2\nf 2//1 3//2 4//1\nf 1/2/1 3/1/2 4/1/1\nf 1/ 2// 4\n";
    std::string other;
    for (const char c : plain) other += c == '\n' ? " # a comment\n" : c == ' ' ? "\t " : std::string(1, c);
    const auto as_plain = load(plain, false);
    for (const std::string& text : {other, "# first\n" + other, plain.substr(0, plain.size() - 1)}) {
        const auto mesh = load(text, false);
        EXPECT_EQ(mesh.positions, as_plain.positions);
        EXPECT_EQ(mesh.normals, as_plain.normals);
        EXPECT_EQ(mesh.texture_coordinates, as_plain.texture_coordinates);
        EXPECT_EQ(mesh.triangles, as_plain.triangles);
    }
    EXPECT_EQ(as_plain.triangles.size(), 6u);
}

TEST_F(ObjMeshTest, LinesThatAreNearlyPlainAreRefusedLikeAnyOther) {
    const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    EXPECT_EQ(message_of(vertices + "v 1 2 3x\n"), "mesh.obj:4: expected a finite number, got \"3x\"");
    EXPECT_EQ(message_of(vertices + "v 1 2 inf\n"), "mesh.obj:4: expected a finite number, got \"inf\"");
    EXPECT_EQ(message_of(vertices + "v 1 2\nv 0 0 0\n"), "mesh.obj:4: v: expected 3 numbers, got 2");
    EXPECT_EQ(message_of(vertices + "f 1 2\nf 1 2 3\n"), "mesh.obj:4: f: expected at least 3 corners, got 2");
    EXPECT_EQ(message_of(vertices + "f 1 2 3\nf 1 2 0\n"), "mesh.obj:5: a face names vertex 0, but there are 3");
    EXPECT_EQ(message_of(vertices + "f 1 2 1234567890123\nf 1 2 3\n"),
              "mesh.obj:4: a face names vertex 1234567890123, but there are 3");
    EXPECT_EQ(message_of(vertices + "f 1 2 3\nf 3 2 1/1\nf 1 3 2\n"),
              "mesh.obj:5: a face names texture coordinate 1, but there are 0");
    EXPECT_EQ(message_of(vertices + "f 1/1/1/1 2 3\n"),
              "mesh.obj:4: f: expected a corner as 1, 1/2, 1//3 or 1/2/3, got \"1/1/1/1\"");
}

TEST_F(ObjMeshTest, PolygonsBecomeFansAroundTheirFirstCorner) {
    // Not flat, and shorter along its other diagonal: the cut decides the surface, and must be Mitsuba's.
    const auto mesh = load("v -9 0 0\nv 0 -1 1\nv 9 0 0\nv 0 1 1\nf 1 2 3 4\n");
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.triangles[0], (Imath::Vec3<std::uint32_t>(0, 1, 2)));
    EXPECT_EQ(mesh.triangles[1], (Imath::Vec3<std::uint32_t>(0, 2, 3)));

    std::string polygon, corners = "f";
    for (int i = 0; i < 255; ++i) {
        const double angle = 2.0 * pi * i / 255.0;
        polygon += "v " + std::to_string(std::cos(angle)) + " " + std::to_string(std::sin(angle)) + " 0\n";
        corners += " " + std::to_string(i + 1);
    }
    const auto round = load(polygon + corners + "\n");
    EXPECT_EQ(round.triangles.size(), 253u);
    EXPECT_NEAR(area_of(round), pi, 1e-3);
}

TEST_F(ObjMeshTest, NegativeIndicesCountBackFromTheirLine) {
    const auto mesh = load("v 9 9 9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 5 5 5\n");
    ASSERT_EQ(mesh.positions.size(), 3u);
    EXPECT_EQ(mesh.positions[0], VectorD(0, 0, 0));
    EXPECT_NEAR(area_of(mesh), 0.5, 1e-15);
}

TEST_F(ObjMeshTest, ObjectsGroupsMaterialsAndCommentsMakeOneMesh) {
    const auto mesh = load("# a comment\nmtllib none.mtl\no first\nusemtl red#1\n" + square_vertices +
                           "f 1 2 3 # the first\ng second part\ns 1\nf 1 3 4 # the second\no empty\n");
    EXPECT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.positions.size(), 4u);
}

TEST_F(ObjMeshTest, VerticesWithDifferentNormalsAreKeptApart) {
    const std::string edge =
        "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 1 0\nvn 0 -3 0\nvn -2 0 0\nf 1//1 3//1 2//1\nf 1//2 2//2 4//2\n";
    EXPECT_EQ(load(edge, true).positions.size(), 4u);
    const auto mesh = load(edge, false);
    ASSERT_EQ(mesh.positions.size(), 6u);
    for (const VectorD& normal : mesh.normals) EXPECT_DOUBLE_EQ(normal.length(), 1.0);
    EXPECT_EQ(mesh.normals[mesh.triangles[0].x], VectorD(0, -1, 0));
    EXPECT_EQ(mesh.normals[mesh.triangles[1].x], VectorD(-1, 0, 0));
}

TEST_F(ObjMeshTest, ComputedNormalsWeighFacesByTheirAngle) {
    // At the origin: one face spans 90 degrees in two triangles of 45, the other 90 degrees in one. By angle they weigh
    // the same however they are cut; by area or by count they would not.
    const auto mesh = load("v 0 0 0\nv 1 0 0\nv 5 5 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\nf 1 4 5\n", false);
    const VectorD expected = VectorD(1, 0, 1).normalized();
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(mesh.normals[mesh.triangles[0].x][axis], expected[axis], 1e-12);
}

TEST_F(ObjMeshTest, VerticesHaveTheTextureCoordinatesOfTheirCorners) {
    // A seam: position 1 has one texture coordinate in each face.
    const auto mesh =
        load(square_vertices + "vt 0 0\nvt 1 0\nvt 0.25 0.75\nvt 0.5 1\nf 1/1 2/2 3/3\nf 1/4 3/3 4/-3\n", true);
    ASSERT_EQ(mesh.positions.size(), 5u);
    ASSERT_EQ(mesh.texture_coordinates.size(), 5u);
    const std::array<Imath::V2d, 6> expected{{{0, 0}, {1, 0}, {0.25, 0.75}, {0.5, 1}, {0.25, 0.75}, {1, 0}}};
    for (std::size_t i = 0; i < 6; ++i) {
        const auto& triangle = mesh.triangles[i / 3];
        const std::uint32_t corner = i % 3 == 0 ? triangle.x : i % 3 == 1 ? triangle.y : triangle.z;
        EXPECT_LT((mesh.texture_coordinates[corner] - expected[i]).length(), 1e-15) << i;
    }
}

// obj.cpp of Mitsuba: index 0 is none, of texture coordinates and of normals.
TEST_F(ObjMeshTest, WhatIsEmptyOrZeroInACornerIsNone) {
    const std::string data = square_vertices + "vt 0.5 0.25\nvn 0 0 -1\n";
    for (const std::string corners :
         {"1 2 3", "1/ 2/ 3/", "1// 2// 3//", "1/0 2/0 3/0", "1//0 2//0 3//0", "1/0/0 2/0/0 3/0/0", "1/0/ 2//0 3"}) {
        const auto mesh = load(data + "f " + corners + "\n", false);
        EXPECT_TRUE(mesh.texture_coordinates.empty()) << corners;
        EXPECT_EQ(mesh.normals.at(0), VectorD(0, 0, 1)) << corners;
    }
    for (const std::string corners : {"1/1 2/1 3/1", "1/1/ 2/1/ 3/1/", "1/1/0 2/1/0 3/1/0"}) {
        const auto mesh = load(data + "f " + corners + "\n", false);
        EXPECT_EQ(mesh.texture_coordinates.at(0), Imath::V2d(0.5, 0.25)) << corners;
        EXPECT_EQ(mesh.normals.at(0), VectorD(0, 0, 1)) << corners;
    }
    EXPECT_EQ(load(data + "f 1/0/1 2//1 3//1\n", false).normals.at(0), VectorD(0, 0, -1));
}

TEST_F(ObjMeshTest, CornersWithoutNormalsHaveThatOfTheirTriangle) {
    const std::string roof = "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\n";
    const VectorD down(0, 0, -1), front(0, -1, 0), given(1, 0, 0);
    for (const std::string normals : {"vn 0 0 0\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1//2 3//1 4//1\n",
                                      "vn 1 0 0\nf 1 2 3\nf 1//1 3 4\n", "vn 2 0 0\nf 1//0 2 3\nf 1//1 3//0 4\n"}) {
        const auto mesh = load(roof + normals, false);
        const VectorD expected[] = {down, down, down, given, front, front};
        for (std::size_t i = 0; i < 6; ++i) {
            const auto& triangle = mesh.triangles.at(i / 3);
            const std::uint32_t corner = i % 3 == 0 ? triangle.x : i % 3 == 1 ? triangle.y : triangle.z;
            EXPECT_EQ(mesh.normals.at(corner), expected[i]) << normals << i;
        }
    }
    for (const std::string unused : {"vn 0 0 0\n", "vn 0 0 1\nvn 0 0 0\n"})
        EXPECT_EQ(load(roof + unused + "f 1 2 3\n", false).normals.at(0), down) << unused;
    EXPECT_TRUE(load(roof + "vn 0 0 0\nf 1//1 2//1 3//1\n", true).normals.empty());
}

TEST_F(ObjMeshTest, CornersWithoutTextureCoordinatesHaveZeroWhereOthersHaveSome) {
    const auto mesh = load(square_vertices + "vt 0.5 0.5\nf 1/1 2/1 3/1\nf 1 3 4\n");
    ASSERT_EQ(mesh.texture_coordinates.size(), mesh.positions.size());
    EXPECT_EQ(mesh.texture_coordinates[mesh.triangles.at(0).x], Imath::V2d(0.5, 0.5));
    EXPECT_EQ(mesh.texture_coordinates[mesh.triangles.at(1).x], Imath::V2d(0.0, 0.0));
}

TEST_F(ObjMeshTest, AFileWithoutFacesIsAnEmptyMesh) {
    for (const std::string text :
         {"", "# nothing\n", "\n", "v 0 0 0\nv 1 0 0\nl 1 2\np 1\n", "vn 0 0 1\n", "o nothing\n"})
        for (const bool face_normals : {false, true}) {
            const auto mesh = load(text, face_normals);
            EXPECT_TRUE(mesh.triangles.empty() && mesh.positions.empty()) << text;
        }
}

TEST_F(ObjMeshTest, BlanksTabsAndOtherLinesChangeNothing) {
    const auto plain = load(square_vertices + "f 1 2 3\nf 1 3 4\n");
    for (const std::string& text :
         std::vector<std::string>{"v\t0 0\t0  \n  v 1 0 0\t\nv 1 1 0\nv 0 1 0\nf\t1 2\t3 \t\n \tf 1  3 4   \n",
                                  "mtllib a.mtl b.mtl\ng\ng a b\ns off\ns 1\nusemtl\nusemtl c\n" + square_vertices +
                                      "l 1 2\np 1\nf 1 2 3\nmg 0\nf 1 3 4\n",
                                  square_vertices + "f -4 -3 -2\nf -4 3 -1",
                                  "\xef\xbb\xbf" + square_vertices + "f 1 2 3\r\n\r\nf 1 3 4\r\n"}) {
        const auto mesh = load(text);
        EXPECT_EQ(mesh.positions, plain.positions) << text;
        EXPECT_EQ(mesh.triangles, plain.triangles) << text;
    }
}

TEST_F(ObjMeshTest, FacesHaveAnyNumberOfCorners) {
    std::string circle, corners = "f";
    for (int i = 0; i < 1000; ++i) {
        circle += "v " + std::to_string(std::cos(2.0 * pi * i / 1000.0)) + " " +
                  std::to_string(std::sin(2.0 * pi * i / 1000.0)) + " 0\n";
        corners += " " + std::to_string(i + 1);
    }
    const auto mesh = load(circle + corners + "\n");
    EXPECT_EQ(mesh.triangles.size(), 998u);
    EXPECT_NEAR(area_of(mesh), pi, 1e-4);
}

/// Triangles around the first vertex, the corners of each with a normal of its own, the i-th of `normals`, or none.
std::string fan_of(int triangles, const std::function<std::string(int)>& normal) {
    std::string vertices = "v 0 0 0\nv 1 0 0\n", faces;
    for (int i = 0; i < triangles; ++i) {
        const double angle = pi * (i + 1) / triangles;
        vertices += fmt::format("v {} {} 0\nvn {} 0 1\n", std::cos(angle), std::sin(angle), i);
        faces += fmt::format("f 1{0} {1}{0} {2}{0}\n", normal(i), i + 2, i + 3);
    }
    return vertices + faces;
}

// The corner of a triangle is found without looking at those of all the others that meet there, which would take longer
// than a test may.
TEST_F(ObjMeshTest, AnyNumberOfTrianglesMeetAtAPoint) {
    const int triangles = 400000;
    const auto flat = load(fan_of(triangles, [](int i) { return fmt::format("//{}", i + 1); }), false);
    ASSERT_EQ(flat.positions.size(), 3u * triangles);
    for (std::uint32_t i = 0; i < triangles; ++i) {
        ASSERT_EQ(flat.triangles[i], Imath::Vec3<std::uint32_t>(3 * i, 3 * i + 1, 3 * i + 2));
        ASSERT_EQ(flat.normals[3 * i], VectorD(i, 0, 1).normalized());
    }
    const auto bare = load(fan_of(triangles, [](int i) { return i == 0 ? "//1" : ""; }), false);
    EXPECT_EQ(bare.positions.size(), 3u * triangles);
    EXPECT_EQ(bare.normals.at(3u * triangles - 1), VectorD(0, 0, 1));
}

// Whether it is one of the first of many vertices at its position or not, a vertex is made once.
TEST_F(ObjMeshTest, TrianglesThatMeetShareTheirVertices) {
    const int normals = 100;
    const auto mesh = load(fan_of(3 * normals, [](int i) { return fmt::format("//{}", i % normals + 1); }), false);
    ASSERT_EQ(mesh.triangles.size(), 3u * normals);
    for (std::size_t i = normals; i < 3 * normals; ++i) EXPECT_EQ(mesh.triangles[i].x, mesh.triangles[i - normals].x);
    EXPECT_EQ(mesh.positions.size(), 7u * normals);  // the centre with each normal, and two in each rim's corner
    for (int i = 0; i < 3 * normals; ++i)
        EXPECT_EQ(mesh.normals[mesh.triangles[static_cast<std::size_t>(i)].x], VectorD(i % normals, 0, 1).normalized());
    const auto folded = load(square_vertices + "vn 1 0 0\nf 1//1 2//1 3//1\nf 1 1 2\nf 1 1 2\n", false);
    EXPECT_EQ(folded.positions.size(), 7u);
    EXPECT_EQ(folded.triangles.at(1), Imath::Vec3<std::uint32_t>(3, 3, 4));
}

TEST_F(ObjMeshTest, DegenerateFacesGiveNoNormalThatIsNotANumber) {
    for (const std::string faces : {"f 1 1 1\n", "f 1 2 2\n", "f 1 2 3\nf 1 3 2\n"})
        for (const VectorD& normal : load(square_vertices + faces, false).normals)
            EXPECT_TRUE(is_finite(normal)) << faces;
}

}  // namespace
}  // namespace photonlab
