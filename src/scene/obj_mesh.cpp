// Wavefront OBJ through tinyobjloader's callbacks, in double. Its parser accepts what is not a number as 0 and passes indices
// on unchecked, so numbers are checked here line by line first, and indices where they are used.

#include <fmt/format.h>

#define TINYOBJLOADER_USE_DOUBLE
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

#include <map>
#include <sstream>
#include <tuple>

#include "core/error.h"
#include "scene/loader.h"
#include "scene/xml_reader.h"

namespace photonlab {

namespace {

/// Refuses vertex data that is not a finite number and faces with fewer than three corners, each with its line.
void require_well_formed(const std::string& text, const std::filesystem::path& file) {
    std::istringstream stream(text);
    std::string line;
    for (std::size_t number = 1; std::getline(stream, line); ++number) {
        std::istringstream words(line.substr(0, line.find('#')));
        std::string keyword;
        words >> keyword;
        const std::string place = fmt::format("{}:{}", file.string(), number);
        const std::size_t needed = keyword == "v" || keyword == "vn" ? 3 : keyword == "vt" ? 1 : 0;
        std::size_t count = 0;
        for (std::string word; words >> word; ++count)
            if (needed > 0) parse_number(word, place);
        if (count < needed) throw InputError(place, fmt::format("{}: expected {} numbers, got {}", keyword, needed, count));
        if (keyword == "f" && count < 3) throw InputError(place, fmt::format("f: expected at least 3 corners, got {}", count));
    }
}

/// Vertex normals as Mitsuba computes them where a file has none: face normals weighted by the angle at the vertex.
/// [Thuermer & Wuethrich 1998, "Computing Vertex Normals from Polygonal Facets"]
std::vector<VectorD> angle_weighted_normals(const MeshDescription& mesh) {
    std::vector<VectorD> normals(mesh.positions.size(), VectorD(0.0));
    for (const auto& triangle : mesh.triangles) {
        const std::uint32_t corners[] = {triangle.x, triangle.y, triangle.z};
        for (unsigned i = 0; i < 3; ++i) {
            const VectorD& corner = mesh.positions[corners[i]];
            const VectorD to_next = (mesh.positions[corners[(i + 1) % 3]] - corner).normalized();
            const VectorD to_last = (mesh.positions[corners[(i + 2) % 3]] - corner).normalized();
            const VectorD cross = to_next.cross(to_last);
            normals[corners[i]] += cross.normalized() * std::atan2(cross.length(), to_next.dot(to_last));
        }
    }
    for (VectorD& normal : normals) normal.normalize();
    return normals;
}

}  // namespace

MeshDescription load_obj_mesh(const std::filesystem::path& file, bool face_normals) {
    const std::string text = read_whole_file(file, file.string());
    require_well_formed(text, file);
    tinyobj::ObjReaderConfig config;
    config.triangulate = true;
    config.vertex_color = false;
    tinyobj::ObjReader reader;
    if (!reader.ParseFromString(text, "", config))
        throw InputError(file.string(), fmt::format("not an OBJ mesh: {}", reader.Error()));
    const tinyobj::attrib_t& data = reader.GetAttrib();

    // A vertex here is a combination of the file's position, normal and texture coordinate, as Mitsuba keeps them.
    MeshDescription mesh;
    std::map<std::tuple<int, int, int>, std::uint32_t> vertices;
    bool all_have_normals = !face_normals && !data.normals.empty();
    bool all_have_texture = !data.texcoords.empty();
    for (const tinyobj::shape_t& shape : reader.GetShapes())
        for (const tinyobj::index_t& index : shape.mesh.indices) {
            all_have_normals = all_have_normals && index.normal_index >= 0;
            all_have_texture = all_have_texture && index.texcoord_index >= 0;
        }
    const auto vertex_of = [&](const tinyobj::index_t& index) {
        const auto require_below = [&](int i, std::size_t count, std::string_view what) {
            if (i < 0 || static_cast<std::size_t>(i) >= count)
                throw InputError(file.string(), fmt::format("a face names {} {}, but there are {}", what, i + 1, count));
        };
        require_below(index.vertex_index, data.vertices.size() / 3, "vertex");
        if (all_have_normals) require_below(index.normal_index, data.normals.size() / 3, "normal");
        if (all_have_texture) require_below(index.texcoord_index, data.texcoords.size() / 2, "texture coordinate");
        const auto key = std::make_tuple(index.vertex_index, all_have_normals ? index.normal_index : -1,
                                         all_have_texture ? index.texcoord_index : -1);
        const auto [entry, is_new] = vertices.emplace(key, static_cast<std::uint32_t>(mesh.positions.size()));
        if (is_new) {
            const auto vector_at = [](const std::vector<tinyobj::real_t>& values, int i) {
                const auto first = static_cast<std::size_t>(i) * 3;
                return VectorD(values[first], values[first + 1], values[first + 2]);
            };
            mesh.positions.push_back(vector_at(data.vertices, index.vertex_index));
            if (all_have_normals) mesh.normals.push_back(vector_at(data.normals, index.normal_index).normalized());
            if (all_have_texture) {
                const auto first = static_cast<std::size_t>(index.texcoord_index) * 2;
                mesh.texture_coordinates.emplace_back(data.texcoords[first], data.texcoords[first + 1]);
            }
        }
        return entry->second;
    };
    for (const tinyobj::shape_t& shape : reader.GetShapes())
        for (std::size_t i = 0; i + 2 < shape.mesh.indices.size(); i += 3)
            mesh.triangles.push_back({vertex_of(shape.mesh.indices[i]), vertex_of(shape.mesh.indices[i + 1]),
                                      vertex_of(shape.mesh.indices[i + 2])});
    if (mesh.triangles.empty()) throw InputError(file.string(), "expected at least one face");
    if (!face_normals && !all_have_normals) mesh.normals = angle_weighted_normals(mesh);
    return mesh;
}

}  // namespace photonlab
