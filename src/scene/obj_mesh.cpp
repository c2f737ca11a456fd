// Wavefront OBJ through tinyobjloader, in double. Its parser takes what is not a number for 0, a face's corner "2junk"
// or "2.5" for 2, and drops polygons whose corners do not exist. So every line that matters is checked here first,
// which is also how a message knows its line.

#include <fmt/format.h>
#include <fmt/ranges.h>

#define TINYOBJLOADER_USE_DOUBLE
#define TINYOBJLOADER_IMPLEMENTATION
#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <string_view>
#include <tuple>

#include "core/error.h"
#include "scene/loader.h"
#include "scene/xml_reader.h"

namespace photonlab {

namespace {

constexpr std::size_t corner_limit = 255;  // of one face: tinyobjloader 2.0.0rc10 counts them in a byte

/// What an OBJ file may say that does not change its triangles: names, groups, materials, lines and points.
constexpr std::string_view ignored_keywords[] = {"o",      "g",          "s",         "mg",     "l",        "p",
                                                 "mtllib", "usemtl",     "maplib",    "usemap", "c_interp", "d_interp",
                                                 "lod",    "shadow_obj", "trace_obj", "bevel",  "vp"};

/// Calls `use(line number, words)` for each line of vertex data or faces. Blanks the comments in them, which the parser
/// would take for more corners, and all other lines: its own reading of them is not needed, and a tag of the wrong
/// size makes it ask for any amount of memory. Lines end as they do for the parser: at \n, \r or both.
template <typename Use>
void for_each_data_line(std::string& text, const std::filesystem::path& file, const Use& use) {
    constexpr std::string_view blanks = " \t\v\f";
    std::vector<std::string_view> words;
    std::size_t number = 0;
    for (std::size_t begin = 0; begin < text.size();) {
        ++number;
        const std::size_t end = std::min(text.find_first_of("\r\n", begin), text.size());
        const std::size_t next = text.compare(end, 2, "\r\n") == 0 ? end + 2 : end + 1;
        const auto split = [&](std::size_t stop) {
            words.clear();
            const std::string_view line = std::string_view(text).substr(begin, stop - begin);
            for (std::size_t i = line.find_first_not_of(blanks); i < line.size();
                 i = line.find_first_not_of(blanks, i)) {
                const std::size_t word_end = std::min(line.find_first_of(blanks, i), line.size());
                words.push_back(line.substr(i, word_end - i));
                i = word_end;
            }
        };
        split(end);
        if (!words.empty() && (words[0] == "v" || words[0] == "vn" || words[0] == "vt" || words[0] == "f")) {
            // A # inside a word begins none: 1.#IND is how some programs write what is not a number.
            const std::string_view up_to_end = std::string_view(text).substr(0, end);
            std::size_t comment = std::min(up_to_end.find('#', begin), end);
            while (comment < end && blanks.find(text[comment - 1]) == blanks.npos)
                comment = std::min(up_to_end.find('#', comment + 1), end);
            std::fill(text.begin() + static_cast<std::ptrdiff_t>(comment),
                      text.begin() + static_cast<std::ptrdiff_t>(end), ' ');
            split(comment);
            if (words.back() == "\\")
                throw InputError(
                    fmt::format("{}:{}", file.string(), number),
                    "expected a line of its own for each vertex and face, got one that goes on in the next");
            use(number, words);
        } else if (!words.empty()) {
            const bool is_known =
                words[0][0] == '#' || std::find(std::begin(ignored_keywords), std::end(ignored_keywords), words[0]) !=
                                          std::end(ignored_keywords);
            if (!is_known)
                throw InputError(fmt::format("{}:{}", file.string(), number),
                                 fmt::format("unknown keyword \"{}\"; known here: v, vn, vt, f, and without effect: {}",
                                             words[0].substr(0, 60), fmt::join(ignored_keywords, ", ")));
            std::fill(text.begin() + static_cast<std::ptrdiff_t>(begin),
                      text.begin() + static_cast<std::ptrdiff_t>(end), ' ');
        }
        begin = next;
    }
}

/// How many vertices, texture coordinates and normals: in the order in which a face's corner names them.
using Counts = std::array<std::size_t, 3>;

/// Refuses vertex data that is not finite numbers.
void require_numbers(const std::vector<std::string_view>& words, const std::string& place) {
    const std::size_t needed = words[0] == "vt" ? 1 : 3;
    if (words.size() - 1 < needed)
        throw InputError(place, fmt::format("{}: expected {} numbers, got {}", words[0], needed, words.size() - 1));
    bool all_zero = true;
    for (std::size_t i = 1; i < words.size(); ++i) all_zero = parse_number(words[i], place) == 0.0 && all_zero;
    if (words[0] == "vn" && all_zero) throw InputError(place, "vn: expected a direction, got 0 0 0");
}

/// Refuses a face whose corners are not vertex, vertex/texture, vertex//normal or vertex/texture/normal, or do not
/// exist: counted from 1 in the whole file (`total`), or backwards by negative numbers from this line (`before`).
void require_face(const std::vector<std::string_view>& words, const Counts& before, const Counts& total,
                  const std::string& place) {
    static constexpr std::string_view names[] = {"vertex", "texture coordinate", "normal"};
    const std::size_t corners = words.size() - 1;
    if (corners < 3 || corners > corner_limit)
        throw InputError(place, fmt::format("f: expected 3 to {} corners, got {}", corner_limit, corners));
    for (std::size_t i = 1; i < words.size(); ++i) {
        std::string_view rest = words[i];
        for (std::size_t kind = 0;; ++kind) {
            const std::size_t slash = rest.find('/');
            const std::string_view field = rest.substr(0, slash);
            const bool may_be_empty = kind == 1 && slash != rest.npos;
            if (kind > 2 || (field.empty() && !may_be_empty))
                throw InputError(place,
                                 fmt::format("f: expected a corner as 1, 1/2, 1//3 or 1/2/3, got \"{}\"", words[i]));
            if (!field.empty()) {
                const long index = parse_integer(field, place);
                const std::size_t count = index < 0 ? before[kind] : total[kind];
                if (index == 0 || static_cast<std::size_t>(std::abs(index)) > count)
                    throw InputError(place, fmt::format("a face names {} {}, but there are {}{}", names[kind], index,
                                                        count, index < 0 ? " before it" : ""));
            }
            if (slash == rest.npos) break;
            rest.remove_prefix(slash + 1);
        }
    }
}

void require_well_formed(std::string& text, const std::filesystem::path& file) {
    const auto place = [&](std::size_t number) { return fmt::format("{}:{}", file.string(), number); };
    const auto kind_of = [](std::string_view keyword) { return keyword == "v" ? 0u : keyword == "vt" ? 1u : 2u; };
    Counts total{};
    for_each_data_line(text, file, [&](std::size_t number, const std::vector<std::string_view>& words) {
        if (words[0] == "f") return;
        require_numbers(words, place(number));
        ++total[kind_of(words[0])];
    });
    Counts before{};
    for_each_data_line(text, file, [&](std::size_t number, const std::vector<std::string_view>& words) {
        if (words[0] == "f")
            require_face(words, before, total, place(number));
        else
            ++before[kind_of(words[0])];
    });
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
    std::string text = read_whole_file(file, file.string());
    if (text.starts_with("\xef\xbb\xbf")) text.replace(0, 3, "   ");  // a byte order mark
    require_well_formed(text, file);
    tinyobj::ObjReaderConfig config;
    config.triangulate = false;  // its cuts differ between versions and from Mitsuba's
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
                throw InputError(file.string(),
                                 fmt::format("a face names {} {}, but there are {}", what, i + 1, count));
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
    for (const tinyobj::shape_t& shape : reader.GetShapes()) {
        std::size_t first = 0;
        for (const std::size_t corners : shape.mesh.num_face_vertices) {
            const std::uint32_t centre = vertex_of(shape.mesh.indices[first]);
            std::uint32_t last = vertex_of(shape.mesh.indices[first + 1]);
            for (std::size_t corner = 2; corner < corners; ++corner) {
                const std::uint32_t next = vertex_of(shape.mesh.indices[first + corner]);
                mesh.triangles.push_back({centre, last, next});
                last = next;
            }
            first += corners;
        }
    }
    if (mesh.triangles.empty()) throw InputError(file.string(), "expected at least one face");
    if (!face_normals && !all_have_normals) mesh.normals = angle_weighted_normals(mesh);
    return mesh;
}

}  // namespace photonlab
