// maxSmoothAngle of Mitsuba 0.6: which faces share their normals. The tries are strips of squares along y, which are
// folded along lines of y.

#include <fmt/format.h>

#include <cmath>
#include <set>

#include "core/error.h"
#include "scene/shapes/meshes/creases.h"
#include "tests/scene/scene_folder.h"

namespace photonlab {
namespace {

/// The i-th square leans by so many degrees.
MeshDescription folded(const std::vector<double>& degrees) {
    MeshDescription mesh;
    VectorD end(0.0);
    for (const double lean : degrees) {
        const VectorD step(std::cos(lean * pi / 180.0), 0.0, -std::sin(lean * pi / 180.0));
        const auto first = static_cast<std::uint32_t>(mesh.positions.size());
        for (const VectorD& corner : {end, end + step, end + step + VectorD(0, 1, 0), end + VectorD(0, 1, 0)})
            mesh.positions.push_back(VectorD(corner));
        mesh.triangles.emplace_back(first, first + 1, first + 2);
        mesh.triangles.emplace_back(first, first + 2, first + 3);
        end += step;
    }
    return mesh;
}

std::string as_obj(const MeshDescription& mesh, const std::string& between) {
    std::string text = "vn 0.6 0 0.8\n";
    for (const VectorD& position : mesh.positions)
        text += fmt::format("v {} {} {}\n", position.x, position.y, position.z);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& corners = mesh.triangles[i];
        text +=
            (i == 2 ? between : "") + fmt::format("f {}//1 {}//1 {}//1\n", corners.x + 1, corners.y + 1, corners.z + 1);
    }
    return text;
}

class Creases : public SceneFolderTest {
protected:
    MeshDescription mesh_of(const std::string& type, const std::string& file, const std::string& properties,
                            const std::string& version = "0.6.0") const {
        const auto scene = load_as(version, "<shape type='" + type + "'><string name='filename' value='" + file +
                                                "'/>" + properties + "</shape>");
        return std::get<MeshDescription>(scene.shapes.at(0).geometry);
    }
};

std::string angle(double degrees) {
    return fmt::format("<float name='maxSmoothAngle' value='{}'/>", degrees);
}

/// The normal of a triangle's first corner at x > 0, where the first two squares meet.
VectorD normal_at_ridge(const MeshDescription& mesh, std::size_t triangle, double x) {
    const auto& corners = mesh.triangles.at(triangle);
    for (const std::uint32_t vertex : {corners.x, corners.y, corners.z})
        if (std::abs(mesh.positions[vertex].x - x) < 1e-6) return mesh.normals.at(vertex);
    return VectorD(0.0);
}

std::size_t vertices_after(MeshDescription mesh, double largest_angle) {
    split_at_creases(mesh, largest_angle, {}, "test");
    return mesh.positions.size();
}

TEST_F(Creases, PartNormalsWhereFacesMeetAtMoreThanTheAngle) {
    write("roof.obj", as_obj(folded({-30.0, 30.0}), ""));
    const double x = std::cos(pi / 6.0);
    const MeshDescription sharp = mesh_of("obj", "roof.obj", angle(59.0));
    EXPECT_EQ(sharp.positions.size(), 8u);
    EXPECT_NEAR((normal_at_ridge(sharp, 0, x) - VectorD(-0.5, 0.0, x)).length(), 0.0, 1e-6);
    EXPECT_NEAR((normal_at_ridge(sharp, 2, x) - VectorD(0.5, 0.0, x)).length(), 0.0, 1e-6);
    const MeshDescription smooth = mesh_of("obj", "roof.obj", angle(61.0));
    EXPECT_EQ(smooth.positions.size(), 6u) << "vertices that the file has twice are one";
    EXPECT_NEAR(normal_at_ridge(smooth, 1, x).z, 1.0, 0.1);
    EXPECT_NEAR((normal_at_ridge(smooth, 1, x) - normal_at_ridge(smooth, 3, x)).length(), 0.0, 1e-6);
    const MeshDescription flipped =
        mesh_of("obj", "roof.obj", angle(59.0) + "<boolean name='flipNormals' value='true'/>");
    EXPECT_NEAR((normal_at_ridge(flipped, 0, x) - VectorD(0.5, 0.0, -x)).length(), 0.0, 1e-6);
}

TEST_F(Creases, AreBetweenGroupsAndTextureCoordinatesAnyway) {
    const MeshDescription roof = folded({-30.0, 30.0});
    write("groups.obj", as_obj(roof, "g other\n"));
    EXPECT_EQ(mesh_of("obj", "groups.obj", angle(61.0)).positions.size(), 8u);
    const std::string collapse = "<boolean name='collapse' value='true'/>";
    EXPECT_EQ(mesh_of("obj", "groups.obj", angle(61.0) + collapse).positions.size(), 6u);
    MeshDescription textured = roof;
    textured.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}, {1, 0}, {1, 1}, {0, 1}};
    split_at_creases(textured, 61.0, {}, "test");
    EXPECT_EQ(textured.positions.size(), 8u);
    EXPECT_EQ(textured.texture_coordinates.size(), 8u);
}

// trimesh.cpp of 0.6: what is within the angle of the first face that is left, and not of its neighbour.
TEST_F(Creases, AreFoundFromTheFirstFaceOn) {
    // Four faces that meet at the origin, their normals 30 degrees from each other.
    MeshDescription fan;
    for (int i = 0; i < 4; ++i) {
        const double lean = i * pi / 6.0;
        const VectorD along(std::cos(lean), 0.0, -std::sin(lean));
        const auto first = static_cast<std::uint32_t>(fan.positions.size());
        for (const VectorD& corner : {VectorD(0.0), along, VectorD(0, 1, 0)}) fan.positions.push_back(VectorD(corner));
        fan.triangles.emplace_back(first, first + 1, first + 2);
    }
    const auto bundles = [&](double largest_angle) {
        MeshDescription split = fan;
        split_at_creases(split, largest_angle, {}, "test");
        std::vector<std::uint32_t> at_origin;
        for (const auto& triangle : split.triangles) at_origin.push_back(triangle.x);
        return at_origin;
    };
    const std::vector<std::uint32_t> by_two = bundles(40.0);
    EXPECT_EQ(by_two[0], by_two[1]);
    EXPECT_NE(by_two[1], by_two[2]);
    EXPECT_EQ(by_two[2], by_two[3]);
    const std::vector<std::uint32_t> by_one = bundles(29.0);
    EXPECT_EQ(std::set<std::uint32_t>(by_one.begin(), by_one.end()).size(), 4u);
    const std::vector<std::uint32_t> by_three = bundles(61.0);
    EXPECT_EQ(by_three[0], by_three[2]);
    EXPECT_NE(by_three[2], by_three[3]);
}

TEST_F(Creases, OfARightAngleAreNoneAtNinetyDegrees) {
    EXPECT_EQ(vertices_after(folded({0.0, 90.0}), 89.9), 8u);
    EXPECT_EQ(vertices_after(folded({0.0, 90.0}), 90.0), 6u) << "in floats the cosine of 90 degrees is below 0";
}

TEST_F(Creases, AreThoseOf06) {
    write("roof.obj", as_obj(folded({-30.0, 30.0}), ""));
    EXPECT_THROW(mesh_of("obj", "roof.obj", angle(30.0), "3.0.0"), InputError);
    EXPECT_THROW(mesh_of("obj", "roof.obj", angle(30.0) + "<boolean name='faceNormals' value='true'/>"), InputError);
    write("roof.ply",
          "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\nelement face "
          "2\n"
          "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 1\n1 1 1\n0 1 0\n2 0 0\n2 1 0\n"
          "4 0 1 2 3\n4 1 4 5 2\n");
    EXPECT_EQ(mesh_of("ply", "roof.ply", "").positions.size(), 6u);
    EXPECT_EQ(mesh_of("ply", "roof.ply", angle(89.0)).positions.size(), 8u);
}

}  // namespace
}  // namespace photonlab
