// Texture coordinates of every kind of shape, as Mitsuba has them, and which corner of an image they find. The image
// has four pixels: red and green above, blue and white below.

#include <cmath>
#include <stdexcept>

#include "image/png.h"
#include "scene/scene.h"
#include "tests/scene/scene_folder.h"

namespace photonlab {
namespace {

class TextureCoordinatesTest : public SceneFolderTest {
protected:
    void SetUp() override {
        SceneFolderTest::SetUp();
        write_png(folder_ / "four.png", 2, 2, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}});
    }

    /// A scene of one shape with the image on it; `inside` is what else its element holds.
    Scene textured(const std::string& type, const std::string& inside, const std::string& version = "3.0.0") const {
        return build_scene(
            load_as(version, "<shape type='" + type + "'>" + inside +
                                 "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string "
                                 "name='filename' value='four.png'/></texture></bsdf></shape>"));
    }

    static Hit hit_from(const Scene& scene, const VectorD& origin, const VectorD& target) {
        const Vector from((origin - scene.centre) / scene.unit_length);
        const auto hit = intersect(scene, {from, Vector((target - origin).normalized())});
        if (!hit) throw std::runtime_error("the ray meets nothing");
        return *hit;
    }

    /// What a ray from outside finds at `point`, twice as far from the origin.
    static Imath::V2f coordinates_at(const Scene& scene, const VectorD& point) {
        return hit_from(scene, point * 2.0, point).texture_coordinate;
    }
};

void expect_near(const Imath::V2f& a, double u, double v, double tolerance = 2e-6) {
    EXPECT_NEAR(a.x, u, tolerance);
    EXPECT_NEAR(a.y, v, tolerance);
}

std::string to_world(const std::string& steps) {
    return "<transform name='to_world'>" + steps + "</transform>";
}

VectorD on_sphere(double u, double v) {
    return {std::sin(pi * v) * std::cos(2 * pi * u), std::sin(pi * v) * std::sin(2 * pi * u), std::cos(pi * v)};
}

// sphere.cpp: u = phi / 2 pi, in [0, 1], and v = theta / pi, of the point in the sphere's own coordinates.
TEST_F(TextureCoordinatesTest, OfSpheresAreTheirAngles) {
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        const Scene plain = textured("sphere", "", version);
        const Scene turned =
            textured("sphere", to_world("<rotate x='1' angle='90'/><scale value='3'/><translate x='0.5'/>"), version);
        const Scene mirrored = textured("sphere", to_world("<scale y='-1'/>"), version);
        const Scene inwards = textured("sphere", "<boolean name='flip_normals' value='true'/>", version);
        for (const double u : {0.01, 0.125, 0.3, 0.5, 0.76, 0.99})
            for (const double v : {0.1, 0.5, 0.8}) {
                SCOPED_TRACE(version + " " + std::to_string(u) + " " + std::to_string(v));
                const VectorD point = on_sphere(u, v);
                expect_near(coordinates_at(plain, point), u, v);
                expect_near(coordinates_at(inwards, point), u, v);
                expect_near(coordinates_at(mirrored, {point.x, -point.y, point.z}), u, v);
                const VectorD there = VectorD(point.x, -point.z, point.y) * 3.0 + VectorD(0.5, 0, 0);
                expect_near(hit_from(turned, there * 2.0 - VectorD(0.5, 0, 0), there).texture_coordinate, u, v);
            }
        EXPECT_NEAR(coordinates_at(plain, {0, 0, 1}).y, 0.0, 1e-6);
        EXPECT_NEAR(coordinates_at(plain, {0, 0, -1}).y, 1.0, 1e-6);
    }
}

// disk.cpp: u is the radius and v = phi / 2 pi.
TEST_F(TextureCoordinatesTest, OfDisksAreRadiusAndAngle) {
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        const Scene plain = textured("disk", "", version);
        const Scene turned = textured("disk", to_world("<rotate y='1' angle='90'/><scale value='4'/>"), version);
        const Scene flipped = textured("disk", "<boolean name='flip_normals' value='true'/>", version);
        const Scene mirrored = textured("disk", to_world("<scale x='-1'/>"), version);
        for (const double u : {0.1, 0.5, 0.9})
            for (const double v : {0.05, 0.25, 0.4, 0.6, 0.95}) {
                SCOPED_TRACE(version + " " + std::to_string(u) + " " + std::to_string(v));
                const double x = u * std::cos(2 * pi * v), y = u * std::sin(2 * pi * v);
                for (const double side : {1.0, -1.0}) {
                    expect_near(hit_from(plain, {x, y, side}, {x, y, 0}).texture_coordinate, u, v);
                    expect_near(hit_from(flipped, {x, y, side}, {x, y, 0}).texture_coordinate, u, v);
                    expect_near(hit_from(mirrored, {-x, y, side}, {-x, y, 0}).texture_coordinate, u, v);
                    expect_near(hit_from(turned, {side, 4 * y, -4 * x}, {0, 4 * y, -4 * x}).texture_coordinate, u, v);
                }
            }
        EXPECT_EQ(hit_from(plain, {0, 0, 1}, {0, 0, 0}).texture_coordinate.x, 0.0f);
    }
}

// rectangle.cpp: u and v are (x + 1) / 2 and (y + 1) / 2.
TEST_F(TextureCoordinatesTest, OfRectanglesAreTheirSides) {
    for (const std::string version : {"0.6.0", "3.0.0"})
        for (const std::string flip : {"false", "true"}) {
            const Scene scene = textured("rectangle", "<boolean name='flip_normals' value='" + flip + "'/>", version);
            expect_near(hit_from(scene, {-0.8, 0.4, 1}, {-0.8, 0.4, 0}).texture_coordinate, 0.1, 0.7);
            expect_near(hit_from(scene, {0.8, -0.4, -1}, {0.8, -0.4, 0}).texture_coordinate, 0.9, 0.3);
        }
}

// cube.cpp: vertices and their texture coordinates, four for each of six faces, of 0.6; those of 3 are the same.
TEST_F(TextureCoordinatesTest, OfCubesAreThoseOfMitsubasTable) {
    const double positions[24][3] = {{1, -1, -1}, {1, -1, 1},   {-1, -1, 1}, {-1, -1, -1}, {1, 1, -1},   {-1, 1, -1},
                                     {-1, 1, 1},  {1, 1, 1},    {1, -1, -1}, {1, 1, -1},   {1, 1, 1},    {1, -1, 1},
                                     {1, -1, 1},  {1, 1, 1},    {-1, 1, 1},  {-1, -1, 1},  {-1, -1, 1},  {-1, 1, 1},
                                     {-1, 1, -1}, {-1, -1, -1}, {1, 1, -1},  {1, -1, -1},  {-1, -1, -1}, {-1, 1, -1}};
    const double uv[4][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        const Scene scene = textured("cube", "", version);
        for (int face = 0; face < 6; ++face) {
            VectorD middle(0.0);
            for (int corner = 0; corner < 4; ++corner) {
                const double* p = positions[4 * face + corner];
                middle += VectorD(p[0], p[1], p[2]) * 0.25;
            }
            for (int corner = 0; corner < 4; ++corner) {
                SCOPED_TRACE(std::to_string(face) + " " + std::to_string(corner));
                const double* p = positions[4 * face + corner];
                const VectorD inside = middle + (VectorD(p[0], p[1], p[2]) - middle) * 0.8;
                expect_near(hit_from(scene, inside + middle, inside).texture_coordinate,
                            0.5 + (uv[corner][0] - 0.5) * 0.8, 0.5 + (uv[corner][1] - 0.5) * 0.8);
            }
        }
    }
}

// mesh.cpp and skdtree.h: without texture coordinates they are the shares of the second and third corner; and which
// corner is which where a mesh is turned inside out.
TEST_F(TextureCoordinatesTest, OfMeshesWithoutAnyAreBarycentric) {
    write("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const std::string file = "<string name='filename' value='bare.obj'/>";
    const std::string flip = "<boolean name='flip_normals' value='true'/>";
    const std::string flat = "<boolean name='face_normals' value='true'/>";
    const auto at = [&](const std::string& version, const std::string& inside, double mirror = 1.0) {
        const Scene scene = textured("obj", file + inside, version);
        const VectorD point(mirror * 0.2, 0.7, 0.0);  // shares of 0.1, 0.2 and 0.7
        return hit_from(scene, point + VectorD(0, 0, 1), point).texture_coordinate;
    };
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        expect_near(at(version, ""), 0.2, 0.7);
        expect_near(at(version, flat), 0.2, 0.7);
    }
    expect_near(at("3.0.0", flip), 0.2, 0.1);
    expect_near(at("3.0.0", to_world("<scale x='-1'/>"), -1.0), 0.2, 0.1);
    expect_near(at("3.0.0", flip + to_world("<scale x='-1'/>"), -1.0), 0.2, 0.7);
    expect_near(at("0.6.0", flip), 0.2, 0.7);
    expect_near(at("0.6.0", flip + flat), 0.1, 0.7);
    expect_near(at("0.6.0", to_world("<scale x='-1'/>"), -1.0), 0.2, 0.7);

    // Shading is as smooth as it was.
    write("roof.obj", "v 0 0 0\nv 0 1 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n");
    const auto scene = load_as("3.0.0", "<shape type='obj'><string name='filename' value='roof.obj'/>" + flip +
                                            "<bsdf type='diffuse'><texture type='bitmap' name='reflectance'><string "
                                            "name='filename' value='four.png'/></texture></bsdf></shape>");
    const auto& mesh = std::get<MeshDescription>(scene.shapes.at(0).geometry);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        if (mesh.positions[i] == VectorD(0.0)) {
            EXPECT_NEAR(mesh.normals[i].y, std::sqrt(0.5), 1e-12);
        }
}

// A mesh described by a program.
TEST_F(TextureCoordinatesTest, OfDescribedMeshesWithoutAnyAreBarycentric) {
    SceneDescription description;
    description.materials.push_back({.id = "grey", .bsdf = Diffuse{}});
    MeshDescription mesh;
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh.triangles.emplace_back(0, 1, 2);
    description.shapes.push_back({.geometry = mesh, .radiance = {}, .place = "test"});
    expect_near(hit_from(build_scene(description), {0.2, 0.7, 1}, {0.2, 0.7, 0}).texture_coordinate, 0.2, 0.7);
}

// obj.cpp: a corner without has (0, 0) where others have some: in 0.6 those of its group, of which one without any is
// barycentric.
TEST_F(TextureCoordinatesTest, OfCornersWithoutAnyAreZeroWhereOthersHaveSome) {
    write("some.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0.5 0.25\ng a\nf 1/1 2/1 3/1\ng b\nf 2 4 3\n");
    const std::string file = "<string name='filename' value='some.obj'/>";
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        const Scene scene = textured("obj", file, version);
        expect_near(hit_from(scene, {0.2, 0.2, 1}, {0.2, 0.2, 0}).texture_coordinate, 0.5, 0.75);
        const Imath::V2f other = hit_from(scene, {0.8, 0.9, 1}, {0.8, 0.9, 0}).texture_coordinate;
        if (version == "3.0.0")
            expect_near(other, 0.0, 0.0);
        else
            expect_near(other, 0.7, 0.2);  // shares of 0.1 for (1, 0), 0.7 for (1, 1) and 0.2 for (0, 1)
    }
    const Scene collapsed = textured("obj", file + "<boolean name='collapse' value='true'/>", "0.6.0");
    expect_near(hit_from(collapsed, {0.8, 0.9, 1}, {0.8, 0.9, 0}).texture_coordinate, 0.0, 0.0);
}

// bitmap.cpp: v = 0 is the first row, above; OBJ files have it below, which flip_tex_coords mends.
TEST_F(TextureCoordinatesTest, FindTheCornerOfTheImage) {
    const auto colour_at = [](const Scene& scene, const Hit& hit) {
        return color_at(*scene.materials[scene.shapes[hit.shape].material].textures.at(0).texture,
                        hit.texture_coordinate);
    };
    // To what OpenImageIO's curves round to, which differs between makers of processors.
    const auto expect_colour = [](const Color& found, const Color& expected) {
        EXPECT_LT((found - expected).length(), 1e-6f) << found;
    };
    const Color red(1, 0, 0), green(0, 1, 0), blue(0, 0, 1), all(1, 1, 1);
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        const Scene rectangle = textured("rectangle", "", version);
        const auto on_rectangle = [&](double x, double y) {
            return colour_at(rectangle, hit_from(rectangle, {x, y, 1}, {x, y, 0}));
        };
        expect_colour(on_rectangle(-0.5, -0.5), red);
        expect_colour(on_rectangle(0.5, -0.5), green);
        expect_colour(on_rectangle(-0.5, 0.5), blue);
        expect_colour(on_rectangle(0.5, 0.5), all);

        write("quad.obj",
              "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n");
        const std::string file = "<string name='filename' value='quad.obj'/>";
        const Scene mesh = textured("obj", file, version);
        expect_colour(colour_at(mesh, hit_from(mesh, {-0.5, 0.5, 1}, {-0.5, 0.5, 0})), red);
        expect_colour(colour_at(mesh, hit_from(mesh, {0.5, -0.5, 1}, {0.5, -0.5, 0})), all);
        const Scene kept = textured("obj", file + "<boolean name='flip_tex_coords' value='false'/>", version);
        expect_colour(colour_at(kept, hit_from(kept, {-0.5, -0.5, 1}, {-0.5, -0.5, 0})), red);

        const Scene sphere = textured("sphere", "", version);
        const auto on_sphere_at = [&](double u, double v) {
            return colour_at(sphere, hit_from(sphere, on_sphere(u, v) * 2.0, on_sphere(u, v)));
        };
        const auto near = [](const Color& a, const Color& b) { return (a - b).length() < 1e-4f; };
        EXPECT_TRUE(near(on_sphere_at(0.25, 0.25), red));
        EXPECT_TRUE(near(on_sphere_at(0.75, 0.25), green));
        EXPECT_TRUE(near(on_sphere_at(0.25, 0.75), blue));
        EXPECT_TRUE(near(on_sphere_at(0.75, 0.75), all));
    }
}

}  // namespace
}  // namespace photonlab
