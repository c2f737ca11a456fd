// PLY and serialized meshes against what was written into them, in every form that they come in; and what of them is
// refused.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <fstream>

#include "scene/scene.h"
#include "scene/shapes/meshes/ply.h"
#include "scene/shapes/meshes/serialized.h"
#include "tests/scene/described.h"
#include "tests/scene/geometry.h"
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

constexpr double square_corners[4][8] = {
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
    for (const auto& corner : square_corners) {
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
        const auto& corner = square_corners[i];
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
        try {
            if (name.ends_with(".ply"))
                parse_ply_mesh(bytes, name, MitsubaFamily::Version3);
            else
                parse_serialized_mesh(bytes, {name, 0, "scene.xml:1"});
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
                expect_square(
                    parse_ply_mesh(square_as_ply(format, number, texture), "square.ply", MitsubaFamily::Version3));
            }
    std::string dos = square_as_ply("ascii");
    for (std::size_t at = 0; (at = dos.find('\n', at)) != dos.npos; at += 2) dos.insert(at, "\r");
    expect_square(parse_ply_mesh(dos, "square.ply", MitsubaFamily::Version3));
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

constexpr std::uint32_t with_normals = 1, with_texture = 2, with_face_normals = 0x10;

/// A mesh of the square, moved up by `height`.
std::string square_as_serialized(int version, bool in_double, double height,
                                 std::uint32_t parts = with_normals | with_texture) {
    std::string body = bytes_of<std::uint32_t>((in_double ? 0x2000u : 0x1000u) | parts);
    if (version == 4) body += std::string("square") + '\0';
    body += bytes_of<std::uint64_t>(4) + bytes_of<std::uint64_t>(2);
    const auto add = [&](double value) { body += in_double ? bytes_of(value) : bytes_of(static_cast<float>(value)); };
    for (const auto& corner : square_corners)
        for (int i = 0; i < 3; ++i) add(corner[i] + (i == 2 ? height : 0.0));
    if ((parts & with_normals) != 0)
        for (const auto& corner : square_corners)
            for (int i = 3; i < 6; ++i) add(corner[i]);
    if ((parts & with_texture) != 0)
        for (const auto& corner : square_corners)
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
            const std::string two = file_of_two(version, in_double);
            const auto mesh = [&](long index) {
                return parse_serialized_mesh(two, {"two.serialized", index, "scene.xml:1"});
            };
            expect_square(mesh(0));
            EXPECT_EQ(mesh(1).positions.at(2), VectorD(1, 1, 1.5));
            EXPECT_THROW(mesh(2), InputError);
            EXPECT_THROW(mesh(-1), InputError);
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

/// The mesh of one shape of a scene, whose material looks up textures.
class MeshesInScenes : public MeshFiles {
protected:
    MeshDescription mesh_of(const std::string& version, const std::string& file, const std::string& properties) const {
        const std::string type = file.substr(file.find('.') + 1);
        const auto scene =
            load_as(version, "<shape type='" + type + "'><string name='filename' value='" + file + "'/>" + properties +
                                 "<bsdf type='diffuse'><texture type='checkerboard' "
                                 "name='reflectance'/></bsdf></shape>");
        return std::get<MeshDescription>(scene.shapes.at(0).geometry);
    }

    std::string message_of_shape(const std::string& file, const std::string& properties) const {
        const std::string type = file.substr(file.find('.') + 1);
        return message_of("<scene version='3.0.0'><sensor type='perspective'/><shape type='" + type +
                          "'>\n<string name='filename' value='" + file + "'/>\n" + properties + "</shape></scene>");
    }
};

/// Texture coordinates of the triangle's corner at (x, y).
Imath::V2d texture_at(const MeshDescription& mesh, std::size_t triangle, double x, double y) {
    const auto& vertices = mesh.triangles.at(triangle);
    for (const std::uint32_t vertex : {vertices.x, vertices.y, vertices.z})
        if (mesh.positions[vertex].x == x && mesh.positions[vertex].y == y) return mesh.texture_coordinates.at(vertex);
    return Imath::V2d(-1.0);
}

// serialized.cpp of 0.6 and 3: the property alone, whatever the file's flag says.
TEST_F(MeshesInScenes, SerializedHaveFaceNormalsWhereTheSceneAsksForThem) {
    write("a.serialized", square_as_serialized(4, false, 0.0, with_normals | with_face_normals));
    for (const std::string version : {"0.6.0", "3.0.0"}) {
        EXPECT_EQ(mesh_of(version, "a.serialized", "").normals.at(0), VectorD(0, 0, 1)) << version;
        EXPECT_TRUE(mesh_of(version, "a.serialized", "<boolean name='face_normals' value='true'/>").normals.empty());
    }
}

// serialized.cpp of 0.6 exchanges the first two corners where to_world mirrors; its ply.cpp does not.
TEST_F(MeshesInScenes, SerializedThatAreMirroredKeepTheirOutsideInBothFamilies) {
    const std::string mirrored = "<transform name='to_world'><scale x='-1'/></transform>";
    const std::string flipped = mirrored + "<boolean name='flip_normals' value='true'/>";
    const std::string flat = "<boolean name='face_normals' value='true'/>";
    write("a.serialized", square_as_serialized(4, true, 0.0, 0));
    for (const std::string version : {"0.6.0", "3.0.0"})
        for (const std::string& normals : {std::string(), flat}) {
            EXPECT_EQ(normal_of(mesh_of(version, "a.serialized", mirrored + normals), 0), VectorD(0, 0, 1)) << version;
            EXPECT_EQ(normal_of(mesh_of(version, "a.serialized", flipped + normals), 0), VectorD(0, 0, -1)) << version;
        }
    // The mirrored corners of the first triangle are (1, -1), (-1, -1) and (-1, 1). In 0.6 the first two are exchanged,
    // and where face normals are flipped once more.
    const auto expect_first_corners = [&](const std::string& properties, double first_x) {
        const MeshDescription mesh = mesh_of("0.6.0", "a.serialized", properties);
        EXPECT_EQ(texture_at(mesh, 0, first_x, -1), Imath::V2d(0, 0)) << properties;
        EXPECT_EQ(texture_at(mesh, 0, -first_x, -1), Imath::V2d(1, 0)) << properties;
        EXPECT_EQ(texture_at(mesh, 0, -1, 1), Imath::V2d(0, 1)) << properties;
    };
    expect_first_corners(mirrored, -1);
    expect_first_corners(mirrored + flat, -1);
    expect_first_corners(flipped, -1);
    expect_first_corners(flipped + flat, 1);

    std::string bare = square_as_ply("ascii");
    for (const std::string name : {"nx", "ny", "nz", "u", "v"})
        bare.replace(bare.find(" " + name + "\n"), name.size() + 2, " unknown_" + name + "\n");
    write("a.ply", bare);
    EXPECT_EQ(normal_of(mesh_of("0.6.0", "a.ply", mirrored + flat), 0), VectorD(0, 0, -1));
    EXPECT_EQ(normal_of(mesh_of("3.0.0", "a.ply", mirrored + flat), 0), VectorD(0, 0, 1));
}

// ply.cpp of 0.6: the second triangle begins with the fourth corner. Texture coordinates that are made up tell.
TEST_F(MeshesInScenes, PlyIsCutIntoTrianglesAsItsVersionDoes) {
    std::string bare = square_as_ply("ascii");
    for (const std::string name : {"u", "v"})
        bare.replace(bare.find(" " + name + "\n"), name.size() + 2, " unknown_" + name + "\n");
    write("a.ply", bare);
    const MeshDescription old = mesh_of("0.6.0", "a.ply", "");
    EXPECT_EQ(texture_at(old, 0, -1, -1), Imath::V2d(0, 0));
    EXPECT_EQ(texture_at(old, 1, -1, 1), Imath::V2d(0, 0));
    EXPECT_EQ(texture_at(old, 1, -1, -1), Imath::V2d(1, 0));
    EXPECT_EQ(texture_at(old, 1, 1, 1), Imath::V2d(0, 1));
    EXPECT_EQ(texture_at(mesh_of("3.0.0", "a.ply", ""), 1, -1, -1), Imath::V2d(0, 0));
}

TEST_F(MeshesInScenes, VerticesOfNoTriangleAreNoPartOfTheScene) {
    std::string ply = square_as_ply("ascii");
    ply.replace(ply.find("vertex 4"), 8, "vertex 5");
    ply.insert(ply.find("4 0 1 2 3"), "1e9 0 0 0 0 1 0 0 255\n");
    write("a.ply", ply);
    const auto scene = load_as("3.0.0", "<shape type='ply'><string name='filename' value='a.ply'/></shape>");
    EXPECT_EQ(build_scene(scene).unit_length, 2.0);
    for (const std::string& note : scene.notes) EXPECT_EQ(note.find("far_clip"), note.npos) << note;
}

TEST_F(MeshesInScenes, PlyMayHaveNumbersAsProgramsWriteThem) {
    std::string ply = square_as_ply("ascii");
    ply.replace(ply.find("\n1 -1 "), 6, "\n+1.0 -1 1e-400 ");
    ply.replace(ply.find("1e-400 ") + 7, 4, "");
    write("a.ply", ply);
    const MeshDescription mesh = mesh_of("3.0.0", "a.ply", "");
    EXPECT_EQ(mesh.positions.at(1), VectorD(1, -1, 0));
    ply.replace(ply.find("1e-400"), 6, "1e+400");
    EXPECT_TRUE(refusal_of("a.ply", ply).ends_with(": expected a finite number, got \"1e+400\""));
}

TEST_F(MeshesInScenes, PlyListsHaveAWholeNumberOfEntries) {
    std::string ply = square_as_ply("ascii");
    ply.replace(ply.find("list uchar"), 10, "list float");
    for (const std::string count : {"3.5", "-1", "nan"}) {
        std::string face = ply;
        face.replace(face.find("4 0 1 2 3"), 1, count);
        const std::string message = "a.ply: expected a whole number of entries in a list, got " + count;
        EXPECT_TRUE(refusal_of("a.ply", face).starts_with(message)) << refusal_of("a.ply", face);
        std::string edge = ply;
        edge.replace(edge.find("property int one"), 16, "property list float int one");
        edge.replace(edge.find("\n7\n"), 3, "\n" + count + " 1 1 1\n");
        EXPECT_TRUE(refusal_of("a.ply", edge).starts_with(message)) << refusal_of("a.ply", edge);
    }
}

// Both families begin with shape 0 without a look at the dictionary.
TEST_F(MeshesInScenes, SerializedOfOneShapeNeedNoDictionary) {
    write("a.serialized", square_as_serialized(4, false, 0.0));
    EXPECT_EQ(mesh_of("3.0.0", "a.serialized", "").triangles.size(), 2u);
    write("a.serialized", file_of_two(4, false));
    for (const std::string index : {"2", "-1"})
        EXPECT_EQ(message_of_shape("a.serialized", "<integer name='shape_index' value='" + index + "'/>"),
                  "scene.xml:3: shape_index: expected 0 to 1, got " + index);
}

TEST_F(MeshesInScenes, SerializedThatBeginBeyondTheirFileAreRefused) {
    const std::string first = square_as_serialized(4, false, 0.0);
    for (const std::uint64_t back : {1, 2, 3, 4}) {
        write("a.serialized",
              first + bytes_of<std::uint64_t>(0) + bytes_of<std::uint64_t>(0 - back) + bytes_of<std::uint32_t>(2));
        EXPECT_EQ(message_of_shape("a.serialized", "<integer name='shape_index' value='1'/>"),
                  "a.serialized: is cut off")
            << back;
    }
}

// Memory is asked for before it is taken, so that what does not fit is refused and not killed: of files whose vertices
// take many times their bytes.
TEST_F(MeshesInScenes, ThatNeedMoreMemoryThanThereIsAreRefused) {
    constexpr std::uint64_t vertices = 8'000'000;  // 183 MiB of positions
    {
        std::string body = bytes_of<std::uint32_t>(0x1000u) + '\0' + bytes_of(vertices) + bytes_of<std::uint64_t>(0);
        body.resize(body.size() + 12 * vertices, '\0');
        write("a.serialized", bytes_of<std::uint16_t>(0x041C) + bytes_of<std::uint16_t>(4) + deflated(body));
        write("a.ply",
              "ply\nformat binary_little_endian 1.0\nelement vertex 8000000\nproperty uchar x\nproperty uchar "
              "y\nproperty uchar z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n" +
                  std::string(3 * vertices, '\1'));
    }
    const auto read_with = [&](std::uint64_t mebibytes, const std::string& file) {
        std::ifstream pages("/proc/self/statm");
        std::uint64_t size = 0;
        pages >> size;
        const rlim_t bytes = size * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + (mebibytes << 20);
        const rlimit limit{bytes, bytes};
        ::setrlimit(RLIMIT_AS, &limit);
        std::fputs(message_of_shape(file, "").c_str(), stderr);
        std::_Exit(0);
    };
    for (const std::string file : {"a.serialized", "a.ply"})
        EXPECT_EXIT(read_with(150, file), ::testing::ExitedWithCode(0), "^" + file + ": needs 183 MiB of memory");
    EXPECT_EXIT(read_with(400, "a.serialized"), ::testing::ExitedWithCode(0), "^scene.xml:1: needs 366 MiB of memory")
        << "for the normals that it does not have";
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

// In 0.6 the normal is that of the two tangents, which a mirroring turns inwards; 3 flips it back.
TEST_F(Cylinders, ThatAreMirroredAreTurnedInsideOutIn06Alone) {
    const std::string mirrored = "<transform name='to_world'><scale x='-1'/></transform>";
    const std::string flipped = "<boolean name='flip_normals' value='true'/>";
    const auto outwards = [&](const std::string& version, const std::string& properties) {
        const Scene scene = with(version, properties);
        const auto hit = intersect(scene, {to_box(scene, {-5, 0, 0.5}), {1, 0, 0}});
        return hit ? -hit->geometric_normal.x : 0.0f;
    };
    EXPECT_NEAR(outwards("3.0.0", mirrored), 1.0f, 1e-6f);
    EXPECT_NEAR(outwards("3.0.0", mirrored + flipped), -1.0f, 1e-6f);
    EXPECT_NEAR(outwards("0.6.0", mirrored), -1.0f, 1e-6f);
    EXPECT_NEAR(outwards("0.6.0", mirrored + flipped), 1.0f, 1e-6f);
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
