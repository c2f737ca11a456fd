// tinyobjloader reads the vertex data, in double. It takes what is not a number for 0, so every line is checked first,
// which is also how a message knows its line. Faces are read here: it takes a corner "2junk" or "2.5" for 2, refuses a
// normal of index 0, and drops polygons whose corners do not exist.

#include "scene/shapes/obj.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#define TINYOBJLOADER_USE_DOUBLE
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>

#include "core/error.h"
#include "core/machine/available_memory.h"
#include "core/text/number_in.h"

namespace photonlab {

namespace {

/// What an OBJ file may say that does not change its triangles: names, groups, materials, lines and points.
constexpr std::string_view ignored_keywords[] = {"o",      "g",          "s",         "mg",     "l",        "p",
                                                 "mtllib", "usemtl",     "maplib",    "usemap", "c_interp", "d_interp",
                                                 "lod",    "shadow_obj", "trace_obj", "bevel",  "vp"};

/// Of those, what 0.6 makes of them.
constexpr std::string_view grouping_keywords[] = {"g", "usemtl", "mtllib"};

/// What reading a file takes for each of its bytes, as measured of a million triangles.
constexpr std::uint64_t bytes_to_text_byte = 4;

constexpr std::string_view blanks = " \t\v\f";

void split_words(std::string_view line, std::vector<std::string_view>& words) {
    words.clear();
    for (std::size_t i = line.find_first_not_of(blanks); i < line.size(); i = line.find_first_not_of(blanks, i)) {
        const std::size_t end = std::min(line.find_first_of(blanks, i), line.size());
        words.push_back(line.substr(i, end - i));
        i = end;
    }
}

/// Where the line's comment begins, or its end. A # inside a word begins none: 1.#IND is how some programs write what
/// is not a number.
std::size_t comment_of(std::string_view line) {
    std::size_t at = line.find('#');
    while (at != line.npos && at > 0 && blanks.find(line[at - 1]) == blanks.npos) at = line.find('#', at + 1);
    return std::min(at, line.size());
}

using Words = std::vector<std::string_view>;

/// Calls `keeps(place, words)` for each line that says something, without its comment, and blanks all of the line, or
/// its comment alone when it is to be kept. Lines end as they do for tinyobjloader: at \n, \r or both.
template <typename Keeps>
void for_each_line(std::string& text, const std::filesystem::path& file, const Keeps& keeps) {
    Words words;
    std::size_t number = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        ++number;
        const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
        const std::string_view line = std::string_view(text).substr(begin, end - begin);
        std::size_t kept = comment_of(line);
        split_words(line.substr(0, kept), words);
        if (!words.empty() && !keeps([&] { return fmt::format("{}:{}", file.string(), number); }, words)) kept = 0;
        std::fill(text.begin() + static_cast<std::ptrdiff_t>(begin + kept),
                  text.begin() + static_cast<std::ptrdiff_t>(end), ' ');
        begin = text.compare(end, 2, "\r\n") == 0 ? end + 2 : end + 1;
    }
}

/// Places are put into words only for messages: there are millions of numbers.
template <typename Place>
void require_number(std::string_view word, const Place& place) {
    const std::optional<double> number = number_in<double>(word);
    if (!number || !std::isfinite(*number)) parse_number(word, place());
}

bool is_one_of(std::string_view word, const auto& list) {
    return std::find(std::begin(list), std::end(list), word) != std::end(list);
}

constexpr std::int32_t none = -1;

/// The parts of a face's corner, in their order there; indices from 0, or none.
using Corner = std::array<std::int32_t, 3>;
using Counts = std::array<std::size_t, 3>;
constexpr std::string_view part_keywords[] = {"v", "vt", "vn"};
constexpr std::string_view part_names[] = {"vertex", "texture coordinate", "normal"};

std::size_t part_of(std::string_view keyword) {
    return static_cast<std::size_t>(std::find(std::begin(part_keywords), std::end(part_keywords), keyword) -
                                    std::begin(part_keywords));
}

/// Refuses what is unknown and vertex data that is not finite numbers, counts it, and leaves that and faces in `text`.
/// tinyobjloader's own reading of all else is not needed, and a tag of the wrong size makes it ask for any amount of
/// memory.
Counts check_lines(std::string& text, const std::filesystem::path& file) {
    Counts counts{};
    for_each_line(text, file, [&](const auto& place, const Words& words) {
        const bool is_vertex_data = is_one_of(words[0], part_keywords);
        if (!is_vertex_data && words[0] != "f") {
            if (!is_one_of(words[0], ignored_keywords))
                throw InputError(place(),
                                 fmt::format("unknown keyword \"{}\"; known here: v, vn, vt, f, and without effect: {}",
                                             words[0].substr(0, 60), fmt::join(ignored_keywords, ", ")));
            return is_one_of(words[0], grouping_keywords);
        }
        if (words.back() == "\\")
            throw InputError(place(),
                             "expected a line of its own for each vertex and face, got one that goes on in the next");
        if (!is_vertex_data) return true;
        const std::size_t needed = words[0] == "vt" ? 1 : 3;
        if (words.size() - 1 < needed)
            throw InputError(place(),
                             fmt::format("{}: expected {} numbers, got {}", words[0], needed, words.size() - 1));
        for (std::size_t i = 1; i < words.size(); ++i) require_number(words[i], place);
        ++counts[part_of(words[0])];
        return true;
    });
    return counts;
}

struct Face {
    std::size_t first_corner;
    std::uint32_t group;  // 0, and one more after each g or usemtl that follows a face
};

struct Faces {
    std::vector<Corner> corners;
    std::vector<Face> faces;
    std::string material_library;
};

/// A corner: 1, 1/2, 1//3 or 1/2/3, counted from 1 in the whole file (`total`), or backwards by negative numbers from
/// this line (`before`). What is empty or 0 is none, but a vertex must be there.
template <typename Place>
Corner read_corner(std::string_view word, const Counts& before, const Counts& total, const Place& place) {
    Corner corner{none, none, none};
    std::string_view rest = word;
    for (std::size_t part = 0;; ++part) {
        const std::size_t slash = rest.find('/');
        const std::string_view field = rest.substr(0, slash);
        if (field.empty() ? part == 0 || part > 3 : part > 2)
            throw InputError(place(), fmt::format("f: expected a corner as 1, 1/2, 1//3 or 1/2/3, got \"{}\"", word));
        if (!field.empty()) {
            const std::optional<long> read = number_in<long>(field);
            const long index = read ? *read : parse_integer(field, place());
            const auto count = static_cast<long>(index < 0 ? before[part] : total[part]);
            if (index > count || index < -count || (index == 0 && part == 0))
                throw InputError(place(), fmt::format("a face names {} {}, but there are {}{}", part_names[part], index,
                                                      count, index < 0 ? " before it" : ""));
            if (index != 0) corner[part] = static_cast<std::int32_t>(index < 0 ? count + index : index - 1);
        }
        if (slash == rest.npos) return corner;
        rest.remove_prefix(slash + 1);
    }
}

/// Takes the faces out of `text`, in which check_lines() has left little else.
Faces read_faces(std::string& text, const std::filesystem::path& file, const Counts& total) {
    Faces result;
    Counts before{};
    std::uint32_t group = 0;
    for_each_line(text, file, [&](const auto& place, const Words& words) {
        if (is_one_of(words[0], part_keywords)) {
            ++before[part_of(words[0])];
            return true;
        }
        if (words[0] == "mtllib") {
            result.material_library = fmt::format("{}", fmt::join(words.begin() + 1, words.end(), " "));
        } else if (words[0] != "f") {
            group = result.faces.empty() ? 0 : result.faces.back().group + 1;
        } else {
            if (words.size() < 4)
                throw InputError(place(), fmt::format("f: expected at least 3 corners, got {}", words.size() - 1));
            result.faces.push_back({result.corners.size(), group});
            for (std::size_t i = 1; i < words.size(); ++i)
                result.corners.push_back(read_corner(words[i], before, total, place));
        }
        return false;
    });
    return result;
}

/// Vertex data as the file has it.
struct VertexData {
    std::vector<VectorD> positions;
    std::vector<Imath::V2d> texture_coordinates;
    std::vector<VectorD> normals;  // unit length, or 0
};

VertexData parse_vertex_data(const std::string& text, const std::filesystem::path& file) {
    tinyobj::ObjReaderConfig config;
    config.triangulate = false;
    config.vertex_color = false;
    tinyobj::ObjReader reader;
    if (!reader.ParseFromString(text, "", config))
        throw InputError(file.string(), fmt::format("not an OBJ mesh: {}", reader.Error()));
    const tinyobj::attrib_t& attributes = reader.GetAttrib();
    VertexData data;
    const auto vector_at = [](const std::vector<tinyobj::real_t>& values, std::size_t i) {
        return VectorD(values[i], values[i + 1], values[i + 2]);
    };
    for (std::size_t i = 0; i < attributes.vertices.size(); i += 3)
        data.positions.push_back(vector_at(attributes.vertices, i));
    for (std::size_t i = 0; i < attributes.texcoords.size(); i += 2)
        data.texture_coordinates.emplace_back(attributes.texcoords[i], attributes.texcoords[i + 1]);
    for (std::size_t i = 0; i < attributes.normals.size(); i += 3)
        data.normals.push_back(vector_at(attributes.normals, i).normalized());
    return data;
}

/// For each of `values`, the first that is equal to it. Two that are equal make one vertex in 0.6, which tells only in
/// normals that are computed.
template <typename Value>
std::vector<std::int32_t> first_equal(const std::vector<Value>& values) {
    constexpr auto dimensions = static_cast<int>(Value::dimensions());
    const auto is_before = [](const Value& a, const Value& b) {
        for (int i = 0; i < dimensions; ++i)
            if (a[i] != b[i]) return a[i] < b[i];
        return false;
    };
    std::map<Value, std::int32_t, decltype(is_before)> first(is_before);
    std::vector<std::int32_t> result;
    for (const Value& value : values)
        result.push_back(first.emplace(value, static_cast<std::int32_t>(result.size())).first->second);
    return result;
}

void merge_equal(std::vector<Corner>& corners, const VertexData& data) {
    const std::array<std::vector<std::int32_t>, 3> merged{
        first_equal(data.positions), first_equal(data.texture_coordinates), first_equal(data.normals)};
    for (Corner& corner : corners)
        for (std::size_t part = 0; part < 3; ++part)
            if (corner[part] != none) corner[part] = merged[part][static_cast<std::size_t>(corner[part])];
}

/// Makes the mesh's vertices: combinations of the file's position, texture coordinate and normal, as Mitsuba keeps
/// them.
class MeshBuilder {
public:
    MeshBuilder(const VertexData& data, const Faces& faces) : data_(data), faces_(faces) {
        for (std::size_t face = 0; face < faces.faces.size(); ++face) {
            const std::uint32_t group = faces.faces[face].group;
            has_texture_.resize(group + 1);
            has_normals_.resize(group + 1);
            for (std::size_t i = faces.faces[face].first_corner; i < end_of(face); ++i) {
                if (faces.corners[i][1] != none) any_texture_ = has_texture_[group] = true;
                if (faces.corners[i][2] != none) any_normal_ = has_normals_[group] = true;
            }
        }
    }

    MeshDescription build(bool flip_v) {
        flip_v_ = flip_v;
        for (std::size_t face = 0; face < faces_.faces.size(); ++face) {
            const std::size_t first = faces_.faces[face].first_corner;
            for (std::size_t corner = first + 2; corner < end_of(face); ++corner)
                add_triangle(faces_.faces[face].group,
                             {faces_.corners[first], faces_.corners[corner - 1], faces_.corners[corner]});
        }
        return std::move(mesh_);
    }

private:
    std::size_t end_of(std::size_t face) const {
        return face + 1 < faces_.faces.size() ? faces_.faces[face + 1].first_corner : faces_.corners.size();
    }

    const VectorD& position(const Corner& corner) const { return data_.positions[static_cast<std::size_t>(corner[0])]; }

    void add_triangle(std::uint32_t group, const std::array<Corner, 3>& corners) {
        std::array<std::uint32_t, 3> vertices{};
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t index = corners[i][2];
            const bool lacks_normal = has_normals_[group] &&
                                      (index == none || data_.normals[static_cast<std::size_t>(index)] == VectorD(0.0));
            // Its triangle's normal is its own: it is shared with no other triangle.
            const std::size_t owner = lacks_normal ? mesh_.triangles.size() + 1 : 0;
            const auto key = std::make_tuple(corners[i][0], corners[i][2], corners[i][1], group, owner);
            const auto [entry, is_new] = vertices_.emplace(key, static_cast<std::uint32_t>(mesh_.positions.size()));
            vertices[i] = entry->second;
            if (!is_new) continue;
            mesh_.positions.push_back(position(corners[i]));
            if (any_texture_) mesh_.texture_coordinates.push_back(texture_coordinate(corners[i][1], group));
            if (!any_normal_) continue;
            const VectorD edge = position(corners[1]) - position(corners[0]);
            const VectorD other = position(corners[2]) - position(corners[0]);
            mesh_.normals.push_back(lacks_normal          ? edge.cross(other).normalized()
                                    : has_normals_[group] ? data_.normals[static_cast<std::size_t>(index)]
                                                          : VectorD(0.0));
        }
        mesh_.triangles.emplace_back(vertices[0], vertices[1], vertices[2]);
    }

    Imath::V2d texture_coordinate(std::int32_t index, std::uint32_t group) const {
        if (index == none)
            return has_texture_[group] ? Imath::V2d(0.0) : Imath::V2d(std::numeric_limits<double>::quiet_NaN());
        const Imath::V2d& uv = data_.texture_coordinates[static_cast<std::size_t>(index)];
        return flip_v_ ? Imath::V2d(uv.x, 1.0 - uv.y) : uv;
    }

    const VertexData& data_;
    const Faces& faces_;
    bool flip_v_ = false;
    std::vector<bool> has_texture_, has_normals_;  // by group
    bool any_texture_ = false, any_normal_ = false;
    std::map<std::tuple<std::int32_t, std::int32_t, std::int32_t, std::uint32_t, std::size_t>, std::uint32_t> vertices_;
    MeshDescription mesh_;
};

}  // namespace

ObjMesh parse_obj_mesh(std::string text, const std::filesystem::path& file, const ObjOptions& options) {
    if (text.starts_with("\xef\xbb\xbf")) text.replace(0, 3, "   ");  // a byte order mark
    require_memory_for(file.string(), bytes_to_text_byte * text.size());
    const Counts counts = check_lines(text, file);
    Faces faces = read_faces(text, file, counts);
    const VertexData data = parse_vertex_data(text, file);
    const bool is_version_06 = options.family == MitsubaFamily::Version06;
    if (is_version_06) merge_equal(faces.corners, data);
    if (!is_version_06 || !options.separate_groups)
        for (Face& face : faces.faces) face.group = 0;
    if (options.face_normals)
        for (Corner& corner : faces.corners) corner[2] = none;
    return {MeshBuilder(data, faces).build(options.flip_v), faces.material_library};
}

MeshDescription load_obj_mesh(const std::filesystem::path& file, bool face_normals) {
    MeshDescription mesh =
        parse_obj_mesh(read_whole_file(file, file.string()), file, {.face_normals = face_normals}).mesh;
    if (!face_normals) fill_in_normals(mesh);
    return mesh;
}

// ---------------------------------------------------------------------------------------------------------------------
// In a scene

namespace {

/// 0.6 gives an OBJ file's parts the materials of its library, unless the shape has one.
void require_no_library(ShapeReader& reader, const ObjMesh& obj) {
    const bool is_loaded = reader.properties.boolean("load_materials").value_or(true);
    if (reader.has_bsdf || !is_loaded || obj.material_library.empty()) return;
    std::error_code ignored;
    if (std::filesystem::exists(reader.element.file_called(obj.material_library), ignored))
        throw InputError(reader.element.place,
                         fmt::format("obj: its materials are in \"{}\", which is not read here: expected a bsdf, or "
                                     "<boolean name=\"loadMaterials\" value=\"false\"/>",
                                     obj.material_library));
}

}  // namespace

MeshDescription Obj::read(ShapeReader& reader) {
    Properties& properties = reader.properties;
    const std::filesystem::path file = reader.require_file();
    ObjOptions options{.family = reader.element.family()};
    options.face_normals = properties.boolean("face_normals").value_or(false);
    options.flip_v = properties.boolean("flip_tex_coords").value_or(true);
    if (reader.is_version_06()) options.separate_groups = !properties.boolean("collapse").value_or(false);
    ObjMesh obj =
        parse_obj_mesh(read_part(file, properties.place_of("filename"), reader.source.bytes_read), file, options);
    if (reader.is_version_06()) require_no_library(reader, obj);
    if (obj.mesh.triangles.empty()) reader.source.note(fmt::format("{}: has no faces", file.string()));
    return place_mesh(std::move(obj.mesh), reader, {.face_normals = options.face_normals});
}

}  // namespace photonlab
