// A file is read once, line by line, and every number by std::from_chars: its values are those of the text rounded to
// double, and what is no number is refused by its line. (tinyobjloader takes it for 0, takes a corner "2junk" or "2.5"
// for 2, drops polygons whose corners do not exist, and takes three times as long.)

#include "scene/shapes/meshes/obj.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/machine/available_memory.h"
#include "core/text/number_in.h"

namespace photonlab {

namespace {

/// What an OBJ file may say that does not change its triangles: names, groups, materials, lines and points.
constexpr std::string_view ignored_keywords[] = {"o",      "g",          "s",         "mg",     "l",        "p",
                                                 "mtllib", "usemtl",     "maplib",    "usemap", "c_interp", "d_interp",
                                                 "lod",    "shadow_obj", "trace_obj", "bevel",  "vp"};

/// What reading a file takes for each of its bytes, as measured of half a million triangles: 2 where they share their
/// vertices, 4 where each has a normal of its own, 6 where its numbers are short, too.
constexpr std::uint64_t bytes_to_text_byte = 6;

using Words = std::vector<std::string_view>;

constexpr bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}
constexpr bool ends_line(char c) {
    return c == '\n' || c == '\r';
}

/// Puts the line's words before its comment into `words`, and goes to its end. A # inside a word begins no comment:
/// 1.#IND is how some programs write what is not a number.
const char* split_line(const char* at, const char* end, Words& words) {
    words.clear();
    while (true) {
        while (at != end && is_blank(*at)) ++at;
        if (at == end || ends_line(*at)) return at;
        const char* const begin = at;
        if (*begin == '#') return std::find_if(at, end, ends_line);
        while (at != end && !is_blank(*at) && !ends_line(*at)) ++at;
        words.emplace_back(begin, static_cast<std::size_t>(at - begin));
    }
}

/// Places are put into words only for messages: there are millions of numbers.
template <typename Place>
double finite_number(std::string_view word, const Place& place) {
    const std::optional<double> number = number_in<double>(word);
    return number && std::isfinite(*number) ? *number : parse_number(word, place());
}

bool is_one_of(std::string_view word, const auto& list) {
    return std::find(std::begin(list), std::end(list), word) != std::end(list);
}

constexpr std::int32_t none = -1;
constexpr std::int32_t not_there = std::numeric_limits<std::int32_t>::max();  // no file has so many vertices

/// The parts of a face's corner, in their order there; indices from 0, or none.
using Corner = std::array<std::int32_t, 3>;
constexpr std::string_view part_names[] = {"vertex", "texture coordinate", "normal"};

struct Face {
    std::uint32_t first_corner;
    std::uint32_t line;
    std::uint32_t group;  // 0, and one more after each g or usemtl that follows a face
};

using Counts = std::array<std::size_t, 3>;

/// Before the file is read: then what is not there is found in the end.
constexpr Counts any_number = {std::numeric_limits<long>::max(), std::numeric_limits<long>::max(),
                               std::numeric_limits<long>::max()};

/// What a file says.
struct ObjFile {
    std::vector<VectorD> positions;
    std::vector<Imath::V2d> texture_coordinates;
    std::vector<VectorD> normals;  // unit length, or 0
    std::vector<Corner> corners;
    std::vector<Face> faces;
    std::string material_library;

    Counts counts() const { return {positions.size(), texture_coordinates.size(), normals.size()}; }
};

/// Reads a file's lines in their order.
class LineReader {
public:
    LineReader(std::string_view text, const std::filesystem::path& file) : text_(text), rest_(text), file_(file) {}

    ObjFile read() {
        while (take_plain_line() || next_line())
            if (!words_.empty()) read_line();
        require_all_there();
        return std::move(read_);
    }

private:
    bool next_line() {
        if (rest_.empty()) return false;
        go_behind_line(split_line(rest_.data(), rest_.data() + rest_.size(), words_));
        return true;
    }

    /// Lines end at \n, \r or both.
    void go_behind_line(const char* at) {
        const char* const end = rest_.data() + rest_.size();
        if (at != end && *at++ == '\r' && at != end && *at == '\n') ++at;
        rest_.remove_prefix(static_cast<std::size_t>(at - rest_.data()));
        ++line_;
    }

    /// Takes a line as nearly all are, in half the time that it takes word by word. False for any other, which it
    /// leaves where it is.
    bool take_plain_line() {
        words_.clear();
        if (rest_.starts_with("f ")) return take_plain_face();
        for (const std::string_view keyword : {"v ", "vt ", "vn "})
            if (rest_.starts_with(keyword)) return take_plain_vertex_data(keyword.substr(0, keyword.size() - 1));
        return false;
    }

    /// Two numbers of a texture coordinate, three of others, and nothing more.
    bool take_plain_vertex_data(std::string_view keyword) {
        const char* const end = rest_.data() + rest_.size();
        const char* at = rest_.data() + keyword.size();
        VectorD numbers(0.0);
        for (int i = 0; i < (keyword == "vt" ? 2 : 3); ++i) {
            while (at != end && is_blank(*at)) ++at;
            const auto [behind, error] = std::from_chars(at, end, numbers[i]);
            if (error != std::errc() || !std::isfinite(numbers[i])) return false;
            at = behind;
            if (at != end && !is_blank(*at) && !ends_line(*at)) return false;
        }
        while (at != end && is_blank(*at)) ++at;
        if (at != end && !ends_line(*at)) return false;
        add_vertex_data(keyword, numbers);
        go_behind_line(at);
        return true;
    }

    /// Three or more corners of one to three numbers from 1.
    bool take_plain_face() {
        const std::size_t first = read_.corners.size();
        const char* const end = rest_.data() + rest_.size();
        const char* at = rest_.data() + 1;
        while (at != nullptr && at != end && !ends_line(*at)) at = take_plain_corner(at, end);
        if (at == nullptr || read_.corners.size() - first < 3) {
            read_.corners.resize(first);
            return false;
        }
        go_behind_line(at);
        read_.faces.push_back({static_cast<std::uint32_t>(first), line_, group_});
        return true;
    }

    /// Behind the corner and the blanks around it; null if it is not plain.
    const char* take_plain_corner(const char* at, const char* end) {
        constexpr std::ptrdiff_t most_digits = 9;
        if (!is_blank(*at)) return nullptr;
        while (at != end && is_blank(*at)) ++at;
        if (at == end || ends_line(*at)) return at;
        Corner corner{none, none, none};
        for (std::int32_t& index : corner) {
            const char* const begin = at;
            std::int32_t number = 0;
            for (; at != end && *at >= '0' && *at <= '9' && at - begin < most_digits; ++at)
                number = 10 * number + (*at - '0');
            if (number == 0 && (at != begin || begin[-1] != '/')) return nullptr;
            index = number - 1;
            if (at == end || *at != '/') break;
            ++at;
        }
        if (at != end && !is_blank(*at) && !ends_line(*at)) return nullptr;
        read_.corners.push_back(corner);
        return at;
    }

    std::string place() const { return fmt::format("{}:{}", file_.string(), line_); }

    void read_line() {
        const std::string_view keyword = words_[0];
        const bool is_vertex_data = keyword == "v" || keyword == "vt" || keyword == "vn";
        if ((is_vertex_data || keyword == "f") && words_.back() == "\\")
            throw InputError(place(),
                             "expected a line of its own for each vertex and face, got one that goes on in the next");
        if (is_vertex_data) {
            read_vertex_data(keyword);
        } else if (keyword == "f") {
            read_face();
        } else if (keyword == "mtllib") {
            read_.material_library = fmt::format("{}", fmt::join(words_.begin() + 1, words_.end(), " "));
        } else if (keyword == "g" || keyword == "usemtl") {
            group_ = read_.faces.empty() ? 0 : read_.faces.back().group + 1;
        } else if (!is_one_of(keyword, ignored_keywords)) {
            throw InputError(place(),
                             fmt::format("unknown keyword \"{}\"; known here: v, vn, vt, f, and without effect: {}",
                                         keyword.substr(0, 60), fmt::join(ignored_keywords, ", ")));
        }
    }

    /// Behind the numbers that are needed there may be a weight or a colour, which must be numbers too.
    void read_vertex_data(std::string_view keyword) {
        const std::size_t needed = keyword == "vt" ? 1 : 3;
        if (words_.size() - 1 < needed)
            throw InputError(place(),
                             fmt::format("{}: expected {} numbers, got {}", keyword, needed, words_.size() - 1));
        std::array<double, 3> numbers{};
        for (std::size_t i = 1; i < words_.size(); ++i) {
            const double number = finite_number(words_[i], [&] { return place(); });
            if (i <= numbers.size()) numbers[i - 1] = number;
        }
        add_vertex_data(keyword, {numbers[0], numbers[1], numbers[2]});
    }

    void add_vertex_data(std::string_view keyword, const VectorD& vector) {
        if (keyword == "v")
            read_.positions.push_back(vector);
        else if (keyword == "vn")
            read_.normals.push_back(vector.normalized());
        else
            read_.texture_coordinates.emplace_back(vector.x, vector.y);
    }

    void read_face() {
        if (words_.size() < 4)
            throw InputError(place(), fmt::format("f: expected at least 3 corners, got {}", words_.size() - 1));
        read_.faces.push_back({static_cast<std::uint32_t>(read_.corners.size()), line_, group_});
        const Counts before = read_.counts();
        for (std::size_t i = 1; i < words_.size(); ++i)
            read_.corners.push_back(read_corner(words_[i], before, any_number));
    }

    /// 1, 1/2, 1//3 or 1/2/3, counted from 1 in the whole file (`total`), or backwards by negative numbers from this
    /// line (`before`). What is empty or 0 is none, but a vertex must be there.
    Corner read_corner(std::string_view word, const Counts& before, const Counts& total) const {
        Corner corner{none, none, none};
        std::string_view rest = word;
        for (std::size_t part = 0;; ++part) {
            const std::size_t slash = rest.find('/');
            const std::string_view field = rest.substr(0, slash);
            if (field.empty() ? part == 0 || part > 3 : part > 2)
                throw InputError(place(),
                                 fmt::format("f: expected a corner as 1, 1/2, 1//3 or 1/2/3, got \"{}\"", word));
            if (!field.empty()) {
                const std::optional<long> read = number_in<long>(field);
                const long index = read ? *read : parse_integer(field, place());
                const auto count = static_cast<long>(index < 0 ? before[part] : total[part]);
                const bool is_zero = index == 0 && part == 0;
                if (index > count || index < -count || (is_zero && total != any_number))
                    throw InputError(place(), fmt::format("a face names {} {}, but there are {}{}", part_names[part],
                                                          index, count, index < 0 ? " before it" : ""));
                if (index != 0) corner[part] = narrow(index < 0 ? count + index : index - 1);
                if (is_zero) corner[part] = not_there;
            }
            if (slash == rest.npos) return corner;
            rest.remove_prefix(slash + 1);
        }
    }

    static std::int32_t narrow(long index) { return static_cast<std::int32_t>(std::min(index, long{not_there})); }

    /// Faces may name what follows them, so what they name can be looked for only when all is read.
    void require_all_there() {
        const Counts total = read_.counts();
        const auto is_missing = [&](const Corner& corner) {
            for (std::size_t part = 0; part < 3; ++part)
                if (corner[part] != none && static_cast<std::size_t>(corner[part]) >= total[part]) return true;
            return false;
        };
        const auto missing = std::find_if(read_.corners.begin(), read_.corners.end(), is_missing);
        if (missing == read_.corners.end()) return;
        const auto its_face = std::prev(std::upper_bound(
            read_.faces.begin(), read_.faces.end(), missing - read_.corners.begin(),
            [](std::ptrdiff_t corner, const Face& face) { return corner < std::ptrdiff_t{face.first_corner}; }));
        rest_ = text_;
        for (line_ = 0; line_ < its_face->line;) next_line();
        for (std::size_t i = 1; i < words_.size(); ++i) read_corner(words_[i], total, total);
    }

    const std::string_view text_;
    std::string_view rest_;  // behind the line
    const std::filesystem::path& file_;
    Words words_;              // of the line
    std::uint32_t line_ = 0;   // counted from 1
    std::uint32_t group_ = 0;  // of faces that follow
    ObjFile read_;
};

/// For each of `values`, the first that is equal to it. Two that are equal make one vertex in 0.6, which tells only in
/// normals that are computed.
template <typename Value>
std::vector<std::int32_t> first_equal(const std::vector<Value>& values) {
    constexpr auto dimensions = static_cast<int>(Value::dimensions());
    const auto at = [&](std::int32_t index) -> const Value& { return values[static_cast<std::size_t>(index)]; };
    std::vector<std::int32_t> order(values.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](std::int32_t a, std::int32_t b) {
        for (int i = 0; i < dimensions; ++i)
            if (at(a)[i] != at(b)[i]) return at(a)[i] < at(b)[i];
        return a < b;
    });
    std::vector<std::int32_t> result(values.size());
    std::int32_t first = none;
    for (const std::int32_t index : order) {
        if (first == none || at(index) != at(first)) first = index;
        result[static_cast<std::size_t>(index)] = first;
    }
    return result;
}

void merge_equal(ObjFile& file) {
    const std::array<std::vector<std::int32_t>, 3> merged{
        first_equal(file.positions), first_equal(file.texture_coordinates), first_equal(file.normals)};
    for (Corner& corner : file.corners)
        for (std::size_t part = 0; part < 3; ++part)
            if (corner[part] != none) corner[part] = merged[part][static_cast<std::size_t>(corner[part])];
}

/// Makes the mesh's vertices: combinations of the file's position, texture coordinate and normal, as Mitsuba keeps
/// them.
class MeshBuilder {
public:
    explicit MeshBuilder(const ObjFile& file) : file_(file), newest_of_position_(file.positions.size(), none) {
        for (std::size_t face = 0; face < file.faces.size(); ++face) {
            const std::uint32_t group = file.faces[face].group;
            has_texture_.resize(group + 1);
            has_normals_.resize(group + 1);
            for (std::size_t i = file.faces[face].first_corner; i < end_of(face); ++i) {
                if (file.corners[i][1] != none) any_texture_ = has_texture_[group] = true;
                if (file.corners[i][2] != none) any_normal_ = has_normals_[group] = true;
            }
        }
    }

    MeshDescription build(bool flip_v) {
        flip_v_ = flip_v;
        mesh_.triangles.reserve(file_.corners.size() - 2 * file_.faces.size());
        for (std::size_t face = 0; face < file_.faces.size(); ++face) {
            const std::size_t first = file_.faces[face].first_corner;
            for (std::size_t corner = first + 2; corner < end_of(face); ++corner)
                add_triangle(file_.faces[face].group,
                             {file_.corners[first], file_.corners[corner - 1], file_.corners[corner]});
        }
        return std::move(mesh_);
    }

private:
    /// What tells vertices at one position apart, and the one before it in the list of that position, or none.
    struct Vertex {
        std::int32_t texture_coordinate, normal;
        std::uint32_t group;
        std::int32_t before;
    };

    /// Searching longer lists takes longer than a tree, and where a million triangles meet, for ever.
    static constexpr int longest_list = 32;

    std::size_t end_of(std::size_t face) const {
        return face + 1 < file_.faces.size() ? file_.faces[face + 1].first_corner : file_.corners.size();
    }

    const VectorD& position(const Corner& corner) const { return file_.positions[static_cast<std::size_t>(corner[0])]; }

    std::uint32_t next_vertex() const { return static_cast<std::uint32_t>(mesh_.positions.size()); }

    /// The vertex that the group's triangles share at such a corner: one that is there, or the next, which is entered.
    std::uint32_t shared_vertex(const Corner& corner, std::uint32_t group) {
        const auto next = static_cast<std::int32_t>(next_vertex());
        std::int32_t& newest = newest_of_position_[static_cast<std::size_t>(corner[0])];
        int length = 0;
        for (std::int32_t at = newest; at != none; ++length) {
            const Vertex& known = vertices_[static_cast<std::size_t>(at)];
            if (known.normal == corner[2] && known.texture_coordinate == corner[1] && known.group == group)
                return static_cast<std::uint32_t>(at);
            at = known.before;
        }
        if (length == longest_list)
            return static_cast<std::uint32_t>(beyond_lists_.try_emplace({corner, group}, next).first->second);
        vertices_.resize(static_cast<std::size_t>(next) + 1);
        vertices_.back() = {corner[1], corner[2], group, std::exchange(newest, next)};
        return static_cast<std::uint32_t>(next);
    }

    void add_triangle(std::uint32_t group, const std::array<Corner, 3>& corners) {
        std::array<std::uint32_t, 3> vertices{};
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t index = corners[i][2];
            const bool lacks_normal = has_normals_[group] &&
                                      (index == none || file_.normals[static_cast<std::size_t>(index)] == VectorD(0.0));
            const std::uint32_t next = next_vertex();
            // Its triangle's normal is its own: it is shared with no other triangle.
            const auto same =
                static_cast<std::size_t>(std::find(corners.begin(), corners.begin() + i, corners[i]) - corners.begin());
            vertices[i] = !lacks_normal ? shared_vertex(corners[i], group) : same < i ? vertices[same] : next;
            if (vertices[i] != next) continue;
            mesh_.positions.push_back(position(corners[i]));
            if (any_texture_) mesh_.texture_coordinates.push_back(texture_coordinate(corners[i][1], group));
            if (!any_normal_) continue;
            const VectorD edge = position(corners[1]) - position(corners[0]);
            const VectorD other = position(corners[2]) - position(corners[0]);
            mesh_.normals.push_back(lacks_normal          ? edge.cross(other).normalized()
                                    : has_normals_[group] ? file_.normals[static_cast<std::size_t>(index)]
                                                          : VectorD(0.0));
        }
        mesh_.triangles.emplace_back(vertices[0], vertices[1], vertices[2]);
    }

    Imath::V2d texture_coordinate(std::int32_t index, std::uint32_t group) const {
        if (index == none)
            return has_texture_[group] ? Imath::V2d(0.0) : Imath::V2d(std::numeric_limits<double>::quiet_NaN());
        const Imath::V2d& uv = file_.texture_coordinates[static_cast<std::size_t>(index)];
        return flip_v_ ? Imath::V2d(uv.x, 1.0 - uv.y) : uv;
    }

    const ObjFile& file_;
    bool flip_v_ = false;
    std::vector<bool> has_texture_, has_normals_;  // by group
    bool any_texture_ = false, any_normal_ = false;
    std::vector<std::int32_t> newest_of_position_;  // index of a vertex, or none
    std::vector<Vertex> vertices_;                  // by their index in mesh_; of those in lists
    std::map<std::pair<Corner, std::uint32_t>, std::int32_t> beyond_lists_;  // the others that are shared; with groups
    MeshDescription mesh_;
};

}  // namespace

namespace {

/// A polygon of n corners is n - 2 triangles.
std::vector<std::uint32_t> groups_of_triangles(const ObjFile& file) {
    std::vector<std::uint32_t> groups;
    for (std::size_t face = 0; face < file.faces.size(); ++face) {
        const std::size_t end = face + 1 < file.faces.size() ? file.faces[face + 1].first_corner : file.corners.size();
        groups.insert(groups.end(), end - file.faces[face].first_corner - 2, file.faces[face].group);
    }
    return groups;
}

}  // namespace

ObjMesh parse_obj_mesh(std::string_view text, const std::filesystem::path& file, const ObjOptions& options) {
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // a byte order mark
    require_memory_for(file.string(), bytes_to_text_byte * text.size());
    ObjFile read = LineReader(text, file).read();
    const bool is_version_06 = options.family == MitsubaFamily::Version06;
    if (is_version_06) merge_equal(read);
    if (!is_version_06 || !options.separate_groups)
        for (Face& face : read.faces) face.group = 0;
    if (options.face_normals)
        for (Corner& corner : read.corners) corner[2] = none;
    return {MeshBuilder(read).build(options.flip_v),
            options.keeps_groups ? groups_of_triangles(read) : std::vector<std::uint32_t>(), read.material_library};
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
    const std::optional<double> max_smooth_angle = read_max_smooth_angle(reader, options.face_normals);
    options.keeps_groups = max_smooth_angle.has_value();
    ObjMesh obj =
        parse_obj_mesh(read_part(file, properties.place_of("filename"), reader.source.bytes_read), file, options);
    if (reader.is_version_06()) require_no_library(reader, obj);
    if (obj.mesh.triangles.empty()) reader.source.note(fmt::format("{}: has no faces", file.string()));
    return place_mesh(
        std::move(obj.mesh), reader,
        {.face_normals = options.face_normals, .max_smooth_angle = max_smooth_angle, .groups = std::move(obj.groups)});
}

}  // namespace photonlab
