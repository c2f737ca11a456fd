// PLY and serialized meshes against what was written into them, in every form that they come in; and what of them is
// refused.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "scene/scene.h"
#include "scene/shapes/ply.h"
#include "scene/shapes/serialized.h"
#include "tests/scene/described.h"
#include "tests/scene/scene_folder.h"

namespace photonlab {
namespace {

template <typename T>
std::string bytes_of(T value, bool is_big_endian = false) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &value, sizeof(T));
    if (is_big_endian) std::reverse(bytes.begin(), bytes.end());
    return bytes;
}

constexpr double corners[4][8] = {
    {-1, -1, 0.5, 0, 0, 1, 0, 0}, {1, -1, 0.5, 0, 0, 1, 1, 0}, {1, 1, 0.5, 0, 0, 1, 1, 1}, {-1, 1, 0.5, 0, 0, 1, 0, 1}};

/// A square as one polygon, with normals and texture coordinates.
std::string square_as_ply(const std::string& format, const std::string& number = "float",
                          const std::string& texture = "u v") {
    const std::string u = texture.substr(0, texture.find(' '));
    const std::string v = texture.substr(texture.find(' ') + 1);
    std::string text = "ply\nformat " + format + " 1.0\ncomment by hand\nelement vertex 4\n";
    for (const std::string name : {"x", "y", "z", "nx", "ny", "nz"}) text += "property " + number + " " + name + "\n";
    text += "property " + number + " " + u + "\nproperty " + number + " " + v + "\nproperty uchar red\n";
    text += "element face 1\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int one\nend_header\n";
    const bool is_text = format == "ascii";
    const bool is_big = format == "binary_big_endian";
    for (const auto& corner : corners) {
        for (const double value : corner)
            text += is_text              ? fmt::format("{} ", value)
                    : number == "double" ? bytes_of(value, is_big)
                                         : bytes_of(static_cast<float>(value), is_big);
        text += is_text ? "255\n" : std::string(1, '\xff');
    }
    if (is_text) return text + "4 0 1 2 3\n7\n";
    text += '\x04';
    for (int i = 0; i < 4; ++i) text += bytes_of(i, is_big);
    return text + bytes_of(7, is_big);
}

void expect_square(const MeshDescription& mesh) {
    ASSERT_EQ(mesh.positions.size(), 4u);
    ASSERT_EQ(mesh.normals.size(), 4u);
    ASSERT_EQ(mesh.texture_coordinates.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
        const auto& corner = corners[i];
        EXPECT_EQ(mesh.positions[i], VectorD(corner[0], corner[1], corner[2]));
        EXPECT_EQ(mesh.normals[i], VectorD(0, 0, 1));
        EXPECT_EQ(mesh.texture_coordinates[i], Imath::V2d(corner[6], corner[7]));
    }
    ASSERT_EQ(mesh.triangles.size(), 2u);
    EXPECT_EQ(mesh.triangles[0], (Imath::Vec3<std::uint32_t>(0, 1, 2)));
    EXPECT_EQ(mesh.triangles[1], (Imath::Vec3<std::uint32_t>(0, 2, 3)));
}

class MeshFiles : public SceneFolderTest {
protected:
    std::string refusal_of(const std::string& name, const std::string& bytes) const {
        write(name, bytes);
        try {
            if (name.ends_with(".ply"))
                read_ply_mesh(folder_ / name);
            else
                read_serialized_mesh(folder_ / name, 0);
        } catch (const InputError& error) {
            std::string message = error.what();
            return message.substr(message.find(name));
        }
        return "no error";
    }
};

TEST_F(MeshFiles, PlyIsReadAsTextAndInBothByteOrders) {
    for (const std::string format : {"ascii", "binary_little_endian", "binary_big_endian"})
        for (const std::string number : {"float", "double"})
            for (const std::string texture : {"u v", "s t", "texture_u texture_v"}) {
                SCOPED_TRACE(format + " " + number + " " + texture);
                write("square.ply", square_as_ply(format, number, texture));
                expect_square(read_ply_mesh(folder_ / "square.ply"));
            }
    std::string dos = square_as_ply("ascii");
    for (std::size_t at = 0; (at = dos.find('\n', at)) != dos.npos; at += 2) dos.insert(at, "\r");
    write("square.ply", dos);
    expect_square(read_ply_mesh(folder_ / "square.ply"));
}

TEST_F(MeshFiles, PlyThatIsWrongIsRefused) {
    const std::string good = square_as_ply("ascii");
    EXPECT_EQ(refusal_of("a.ply", good), "no error");
    const auto changed = [&](const std::string& from, const std::string& to) {
        std::string text = good;
        text.replace(text.find(from), from.size(), to);
        return refusal_of("a.ply", text);
    };
    EXPECT_EQ(changed("ply", "plx"), "a.ply:1: expected a file that begins with ply");
    EXPECT_EQ(changed("format ascii", "format utf8"), "a.ply:2: unknown format \"utf8\"");
    EXPECT_EQ(changed("property float x", "property half x"), "a.ply:5: unknown type \"half\" of a property");
    EXPECT_EQ(changed("property float x", "property float q").substr(0, 45),
              "a.ply: expected vertices with x, y and z (byt");
    EXPECT_EQ(changed("4 0 1 2 3", "4 0 1 2 4").substr(0, 55),
              "a.ply: face 1: expected vertices below 4, got 4 (byte 4");
    EXPECT_EQ(changed("4 0 1 2 3\n7", "4 0 1 2").substr(0, 36), "a.ply: ends before its last element ");
    EXPECT_EQ(changed("vertex 4", "vertex 4000000000000").substr(0, 8), "a.ply: e");
    EXPECT_EQ(changed("end_header", "no_header").substr(0, 40), "a.ply:18: expected format, element, prop");
    EXPECT_EQ(refusal_of("a.ply", "ply\n"), "a.ply:2: expected a PLY header that ends in end_header");
    const std::string binary = square_as_ply("binary_little_endian");
    for (std::size_t length = 0; length + 1 < binary.size(); length += 7)
        EXPECT_NE(refusal_of("a.ply", binary.substr(0, length)), "no error") << length;
}

// ---------------------------------------------------------------------------------------------------------------------

std::string deflated(const std::string& bytes) {
    uLongf size = compressBound(static_cast<uLong>(bytes.size()));
    std::string result(size, '\0');
    compress(reinterpret_cast<Bytef*>(result.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
             static_cast<uLong>(bytes.size()));
    result.resize(size);
    return result;
}

/// A mesh of the square, moved up by `height`.
std::string square_as_serialized(int version, bool in_double, double height) {
    std::string body = bytes_of<std::uint32_t>((in_double ? 0x2000u : 0x1000u) | 1u | 2u);
    if (version == 4) body += std::string("square") + '\0';
    body += bytes_of<std::uint64_t>(4) + bytes_of<std::uint64_t>(2);
    const auto add = [&](double value) { body += in_double ? bytes_of(value) : bytes_of(static_cast<float>(value)); };
    for (const auto& corner : corners)
        for (int i = 0; i < 3; ++i) add(corner[i] + (i == 2 ? height : 0.0));
    for (const auto& corner : corners)
        for (int i = 3; i < 6; ++i) add(corner[i]);
    for (const auto& corner : corners)
        for (int i = 6; i < 8; ++i) add(corner[i]);
    for (const std::uint32_t index : {0u, 1u, 2u, 0u, 2u, 3u}) body += bytes_of(index);
    return bytes_of<std::uint16_t>(0x041C) + bytes_of(static_cast<std::uint16_t>(version)) + deflated(body);
}

std::string file_of_two(int version, bool in_double) {
    const std::string first = square_as_serialized(version, in_double, 0.0);
    std::string file = first + square_as_serialized(version, in_double, 1.0);
    for (const std::size_t place : {std::size_t{0}, first.size()})
        file += version == 4 ? bytes_of<std::uint64_t>(place) : bytes_of(static_cast<std::uint32_t>(place));
    return file + bytes_of<std::uint32_t>(2);
}

TEST_F(MeshFiles, SerializedIsReadInBothVersionsWithAllItsShapes) {
    for (const int version : {3, 4})
        for (const bool in_double : {false, true}) {
            SCOPED_TRACE(fmt::format("version {}, {}", version, in_double));
            write("two.serialized", file_of_two(version, in_double));
            expect_square(read_serialized_mesh(folder_ / "two.serialized", 0).mesh);
            const MeshDescription second = read_serialized_mesh(folder_ / "two.serialized", 1).mesh;
            EXPECT_EQ(second.positions.at(2), VectorD(1, 1, 1.5));
            EXPECT_THROW(read_serialized_mesh(folder_ / "two.serialized", 2), InputError);
            EXPECT_THROW(read_serialized_mesh(folder_ / "two.serialized", -1), InputError);
        }
}

TEST_F(MeshFiles, SerializedThatIsWrongIsRefused) {
    const std::string good = file_of_two(4, false);
    EXPECT_EQ(refusal_of("a.serialized", good), "no error");
    EXPECT_EQ(refusal_of("a.serialized", "xx" + good.substr(2)),
              "a.serialized: expected a serialized mesh, which begins with 1C 04");
    EXPECT_EQ(refusal_of("a.serialized", good.substr(0, 2) + bytes_of<std::uint16_t>(5) + good.substr(4)),
              "a.serialized: expected version 3 or 4 of serialized meshes, got 5");
    // Of what is cut off behind a whole mesh and its checksum, that mesh is still read.
    const std::size_t whole = square_as_serialized(4, false, 0.0).size();
    for (std::size_t length = 0; length + 12 < whole; ++length)
        EXPECT_NE(refusal_of("a.serialized", good.substr(0, length)), "no error") << length;
    // Few bytes that claim many vertices.
    std::string body = bytes_of<std::uint32_t>(0x1000u) + '\0' + bytes_of<std::uint64_t>(std::uint64_t{1} << 31) +
                       bytes_of<std::uint64_t>(0);
    const std::string claims =
        good.substr(0, 4) + deflated(body) + bytes_of<std::uint64_t>(0) + bytes_of<std::uint32_t>(1);
    EXPECT_EQ(refusal_of("a.serialized", claims), "a.serialized: claims more than its bytes can hold");
}

// Where neither file nor property says otherwise normals are the file's; shapeIndex is the older name.
TEST_F(MeshFiles, AreReadFromScenes) {
    write("square.ply", square_as_ply("binary_big_endian"));
    write("two.serialized", file_of_two(4, true));
    const auto scene = load_as("0.6.0",
                               "<shape type='serialized'><string name='filename' value='two.serialized'/><integer "
                               "name='shapeIndex' value='1'/><transform name='toWorld'><translate x='2'/></transform>"
                               "</shape><shape type='ply'><string name='filename' value='square.ply'/></shape>"
                               "<shape type='ply'><string name='filename' value='square.ply'/><boolean "
                               "name='faceNormals' value='true'/></shape>");
    const auto mesh = [&](std::size_t i) { return std::get<MeshDescription>(scene.shapes.at(i).geometry); };
    EXPECT_EQ(mesh(0).positions.at(2), VectorD(3, 1, 1.5));
    EXPECT_EQ(mesh(1).normals.size(), 4u);
    EXPECT_TRUE(mesh(2).normals.empty());
}

// ---------------------------------------------------------------------------------------------------------------------

class Cylinders : public SceneFolderTest {
protected:
    Scene with(const std::string& version, const std::string& properties) const {
        return build_scene(load_as(version, "<shape type='cylinder'>" + properties + "</shape>"));
    }
};

TEST_F(Cylinders, AreMetFromOutsideAndFromWithin) {
    const Scene scene = with("3.0.0",
                             "<point name='p0' x='0' y='0' z='1'/><point name='p1' x='0' y='0' z='4'/>"
                             "<float name='radius' value='2'/>");
    EXPECT_NEAR(scene.shapes[0].area * scene.unit_length * scene.unit_length, 2.0 * pi * 2.0 * 3.0, 1e-4);
    const Vector middle = to_box(scene, {0, 0, 2.5});
    const auto from_within = intersect(scene, {middle, {1, 0, 0}});
    ASSERT_TRUE(from_within);
    EXPECT_NEAR(from_within->distance * scene.unit_length, 2.0, 1e-5);
    EXPECT_NEAR(from_within->geometric_normal.x, 1.0, 1e-6);
    const auto from_outside = intersect(scene, {to_box(scene, {-5, 0.5, 3.25}), {1, 0, 0}});
    ASSERT_TRUE(from_outside);
    EXPECT_NEAR(from_outside->distance * scene.unit_length, 5.0 - std::sqrt(4.0 - 0.25), 1e-5);
    EXPECT_LT(from_outside->geometric_normal.x, -0.9f);
    EXPECT_FALSE(intersect(scene, {to_box(scene, {-5, 0, 4.1}), {1, 0, 0}})) << "above its end";
    EXPECT_FALSE(intersect(scene, {middle, {0, 0, 1}})) << "along its axis";
    // A ray that enters above the open end meets the far side.
    const auto across = intersect(scene, {to_box(scene, {-3, 0, 5}), Vector(VectorD(5, 0, -2).normalized())});
    ASSERT_TRUE(across);
    EXPECT_GT(across->geometric_normal.x, 0.9f);
}

TEST_F(Cylinders, HaveMitsubasTextureCoordinates) {
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        SceneDescription description = load_as(version, "<shape type='cylinder'><bsdf type='diffuse'/></shape>");
        const Scene scene = build_scene(description);
        const Vector middle = to_box(scene, {0, 0, 0.75});
        for (const double turn : {0.1, 0.3, 0.6, 0.9}) {
            const Vector direction(VectorD(std::cos(2.0 * pi * turn), std::sin(2.0 * pi * turn), 0.0));
            const auto hit = intersect(scene, {middle, direction});
            ASSERT_TRUE(hit);
            EXPECT_NEAR(hit->texture_coordinate.x, turn, 1e-5) << version;
            EXPECT_NEAR(hit->texture_coordinate.y, 0.75, 1e-5);
        }
    }
}

TEST_F(Cylinders, ThatAreNotRoundAreRefused) {
    EXPECT_EQ(message_of("<scene version='3.0.0'>\n<shape type='cylinder'>\n<transform name='to_world'><scale x='2'/>"
                         "</transform></shape></scene>"),
              "scene.xml:3: cylinder: expected a transform that keeps it round and its ends across its axis");
    EXPECT_NO_THROW(with("3.0.0", "<transform name='to_world'><scale z='3'/></transform>"));
}

}  // namespace
}  // namespace photonlab
