#include "scene/shapes/meshes/ply.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <optional>

#include "core/error.h"
#include "core/machine/available_memory.h"
#include "core/text/number_in.h"

namespace photonlab {

namespace {

enum class Number { Int8, Uint8, Int16, Uint16, Int32, Uint32, Float, Double };

/// Both of the names that each has in files, in the order of Number, and its bytes.
struct NumberName {
    std::string_view old_name, name;
    Number number;
    std::size_t bytes;
};
constexpr NumberName number_names[] = {
    {"char", "int8", Number::Int8, 1},      {"uchar", "uint8", Number::Uint8, 1},
    {"short", "int16", Number::Int16, 2},   {"ushort", "uint16", Number::Uint16, 2},
    {"int", "int32", Number::Int32, 4},     {"uint", "uint32", Number::Uint32, 4},
    {"float", "float32", Number::Float, 4}, {"double", "float64", Number::Double, 8}};

struct Property {
    std::string name;
    Number number;
    std::optional<Number> count;  // of a list
};

struct Element {
    std::string name;
    std::size_t count;
    std::vector<Property> properties;
};

enum class Format { Text, LittleEndian, BigEndian };

struct Header {
    Format format = Format::Text;
    std::vector<Element> elements;
    std::size_t size = 0;  // bytes
};

std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    constexpr std::string_view blanks = " \t\r";
    for (std::size_t at = line.find_first_not_of(blanks); at < line.size(); at = line.find_first_not_of(blanks, at)) {
        const std::size_t end = std::min(line.find_first_of(blanks, at), line.size());
        words.push_back(line.substr(at, end - at));
        at = end;
    }
    return words;
}

std::size_t bytes_of(Number number) {
    return number_names[static_cast<std::size_t>(number)].bytes;
}

Number number_called(std::string_view name, const std::string& place) {
    for (const NumberName& known : number_names)
        if (name == known.old_name || name == known.name) return known.number;
    throw InputError(place, fmt::format("unknown type \"{}\" of a property", name));
}

void add_to_header(Header& header, const std::vector<std::string_view>& words, const std::string& place) {
    const auto is = [&](std::string_view keyword, std::size_t count) {
        return words[0] == keyword && words.size() == count;
    };
    if (is("format", 3) && words[2] == "1.0") {
        if (words[1] == "ascii")
            header.format = Format::Text;
        else if (words[1] == "binary_little_endian")
            header.format = Format::LittleEndian;
        else if (words[1] == "binary_big_endian")
            header.format = Format::BigEndian;
        else
            throw InputError(place, fmt::format("unknown format \"{}\"", words[1]));
    } else if (is("element", 3)) {
        const auto count = number_in<std::uint64_t>(words[2]);
        if (!count) throw InputError(place, fmt::format("expected a number of elements, got \"{}\"", words[2]));
        header.elements.push_back({std::string(words[1]), static_cast<std::size_t>(*count), {}});
    } else if ((is("property", 3) || (is("property", 5) && words[1] == "list")) && !header.elements.empty()) {
        Property property{std::string(words.back()), number_called(words[words.size() - 2], place), {}};
        if (words.size() == 5) property.count = number_called(words[2], place);
        header.elements.back().properties.push_back(property);
    } else {
        throw InputError(place, fmt::format("expected format, element, property, comment or end_header, got \"{}\"",
                                            excerpt(fmt::format("{}", fmt::join(words, " ")))));
    }
}

Header read_header(std::string_view text, const std::string& file) {
    Header header;
    bool has_format = false;
    for (std::size_t line = 1, begin = 0;; ++line) {
        const std::string place = fmt::format("{}:{}", file, line);
        const std::size_t end = text.find('\n', begin);
        if (end == text.npos) throw InputError(place, "expected a PLY header that ends in end_header");
        const std::vector<std::string_view> words = words_of(text.substr(begin, end - begin));
        begin = end + 1;
        if (line == 1) {
            if (words.size() != 1 || words[0] != "ply") throw InputError(place, "expected a file that begins with ply");
            continue;
        }
        if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
        if (words[0] == "end_header") {
            if (!has_format) throw InputError(place, "expected a format before end_header");
            header.size = begin;
            return header;
        }
        has_format = has_format || words[0] == "format";
        add_to_header(header, words, place);
    }
}

/// The numbers behind the header, one after the other.
class Numbers {
public:
    Numbers(std::string_view text, const Header& header, const std::string& file)
        : text_(text), file_(file), format_(header.format), at_(header.size) {}

    double next(Number number) { return format_ == Format::Text ? next_word() : next_binary(number); }

    /// The number of entries of the list that follows, or 1 of what is no list.
    std::uint64_t next_count(const Property& property) {
        if (!property.count) return 1;
        const double count = next(*property.count);
        constexpr double most = 4294967295.0;
        if (!(count >= 0.0 && count <= most && count == std::floor(count)))
            fail(fmt::format("expected a whole number of entries in a list, got {}", count));
        return static_cast<std::uint64_t>(count);
    }

    void require_memory(std::uint64_t bytes) const { require_memory_for(file_, bytes); }

    /// Few bytes can claim any number of elements: refuses more than can be left, by the least bytes that each takes.
    void require_bytes_for(const Element& element) const {
        std::size_t least = 0;
        for (const Property& property : element.properties)
            least += format_ == Format::Text ? 2 : bytes_of(property.count.value_or(property.number));
        const std::size_t left = text_.size() - at_;
        // Behind the last word of a text there need not be a blank.
        const std::size_t most = least == 0 ? 0 : (left + (format_ == Format::Text ? 1 : 0)) / least;
        if (element.count > most)
            throw InputError(file_, fmt::format("element {}: {} of them are more than its bytes can hold", element.name,
                                                element.count));
    }

    [[noreturn]] void fail(const std::string& message) const {
        throw InputError(file_, fmt::format("{} (byte {})", message, at_));
    }

private:
    double next_word() {
        constexpr std::string_view blanks = " \t\r\n";
        const std::size_t begin = text_.find_first_not_of(blanks, at_);
        if (begin == text_.npos) fail("ends before its last element");
        const std::size_t end = std::min(text_.find_first_of(blanks, begin), text_.size());
        at_ = end;
        const std::string_view word = text_.substr(begin, end - begin);
        const auto value = number_in<double>(word);
        return value ? *value : parse_number(word, fmt::format("{}: byte {}", file_, begin));
    }

    template <typename T>
    double as() {
        std::array<char, sizeof(T)> bytes;
        if (text_.size() - at_ < bytes.size()) fail("ends before its last element");
        std::memcpy(bytes.data(), text_.data() + at_, bytes.size());
        at_ += bytes.size();
        if ((format_ == Format::BigEndian) == (std::endian::native == std::endian::little))
            std::reverse(bytes.begin(), bytes.end());
        return static_cast<double>(std::bit_cast<T>(bytes));
    }

    double next_binary(Number number) {
        switch (number) {
            case Number::Int8:
                return as<std::int8_t>();
            case Number::Uint8:
                return as<std::uint8_t>();
            case Number::Int16:
                return as<std::int16_t>();
            case Number::Uint16:
                return as<std::uint16_t>();
            case Number::Int32:
                return as<std::int32_t>();
            case Number::Uint32:
                return as<std::uint32_t>();
            case Number::Float:
                return as<float>();
            default:
                return as<double>();
        }
    }

    std::string_view text_;
    const std::string& file_;
    Format format_;
    std::size_t at_;
};

/// Which of an element's properties have these names; empty unless all are there.
template <std::size_t Count>
std::optional<std::array<std::size_t, Count>> places_of(const Element& element,
                                                        const std::array<std::string_view, Count>& names) {
    std::array<std::size_t, Count> places{};
    for (std::size_t i = 0; i < Count; ++i) {
        const auto found = std::find_if(element.properties.begin(), element.properties.end(),
                                        [&](const Property& p) { return p.name == names[i] && !p.count; });
        if (found == element.properties.end()) return std::nullopt;
        places[i] = static_cast<std::size_t>(found - element.properties.begin());
    }
    return places;
}

void pass_over(const Property& property, Numbers& numbers) {
    for (std::uint64_t left = numbers.next_count(property); left > 0; --left) numbers.next(property.number);
}

void read_vertices(MeshDescription& mesh, const Element& element, Numbers& numbers) {
    const auto position = places_of<3>(element, {"x", "y", "z"});
    const auto normal = places_of<3>(element, {"nx", "ny", "nz"});
    auto texture = places_of<2>(element, {"u", "v"});
    if (!texture) texture = places_of<2>(element, {"s", "t"});
    if (!texture) texture = places_of<2>(element, {"texture_u", "texture_v"});
    if (!position) numbers.fail("expected vertices with x, y and z");
    const auto reserve = [&](auto& values) {
        numbers.require_memory(element.count * sizeof(values[0]));
        values.reserve(element.count);
    };
    reserve(mesh.positions);
    if (normal) reserve(mesh.normals);
    if (texture) reserve(mesh.texture_coordinates);
    std::vector<double> values(element.properties.size());
    const auto vector = [&](const std::array<std::size_t, 3>& at) {
        return VectorD(values[at[0]], values[at[1]], values[at[2]]);
    };
    for (std::size_t i = 0; i < element.count; ++i) {
        for (std::size_t p = 0; p < values.size(); ++p) {
            if (element.properties[p].count)
                pass_over(element.properties[p], numbers);
            else
                values[p] = numbers.next(element.properties[p].number);
        }
        mesh.positions.push_back(vector(*position));
        if (!is_finite(mesh.positions.back())) numbers.fail(fmt::format("vertex {} is not finite", i + 1));
        if (normal) mesh.normals.push_back(vector(*normal).normalized());
        if (texture) mesh.texture_coordinates.emplace_back(values[(*texture)[0]], values[(*texture)[1]]);
    }
}

/// The faces of a file whose vertices are known in number.
class FaceReader {
public:
    FaceReader(MeshDescription& mesh, std::size_t vertices, Numbers& numbers, MitsubaFamily family)
        : triangles_(mesh.triangles), vertices_(vertices), numbers_(numbers), family_(family) {}

    void read(const Element& element) {
        const auto is_corners = [](const Property& property) {
            return property.count && (property.name == "vertex_indices" || property.name == "vertex_index");
        };
        if (element.count > 0 && std::none_of(element.properties.begin(), element.properties.end(), is_corners))
            numbers_.fail("expected faces with a list vertex_indices");
        reserve(element.count);
        for (face_ = 1; face_ <= element.count; ++face_)
            for (const Property& property : element.properties) {
                if (is_corners(property))
                    read_polygon(property);
                else
                    pass_over(property, numbers_);
            }
    }

private:
    void reserve(std::size_t count) {
        numbers_.require_memory(count * sizeof(triangles_[0]));
        triangles_.reserve(count);
    }

    std::uint32_t next_corner(const Property& property) {
        const double value = numbers_.next(property.number);
        if (!(value >= 0.0 && value < static_cast<double>(vertices_) && value == std::floor(value)))
            numbers_.fail(fmt::format("face {}: expected vertices below {}, got {}", face_, vertices_, value));
        return static_cast<std::uint32_t>(value);
    }

    void read_polygon(const Property& property) {
        const std::uint64_t count = numbers_.next_count(property);
        const bool begins_with_last = count == 4 && family_ == MitsubaFamily::Version06;
        std::uint32_t first = 0, last = 0;
        for (std::uint64_t corner = 0; corner < count; ++corner) {
            const std::uint32_t vertex = next_corner(property);
            if (corner == 0) first = vertex;
            if (corner >= 2) {
                if (triangles_.size() == triangles_.capacity()) reserve(2 * triangles_.size() + 1);
                if (corner == 3 && begins_with_last)
                    triangles_.emplace_back(vertex, first, last);
                else
                    triangles_.emplace_back(first, last, vertex);
            }
            last = vertex;
        }
    }

    std::vector<Imath::Vec3<std::uint32_t>>& triangles_;
    const std::size_t vertices_;
    Numbers& numbers_;
    const MitsubaFamily family_;
    std::size_t face_ = 0;  // counted from 1
};

}  // namespace

MeshDescription parse_ply_mesh(std::string_view bytes, const std::string& file, MitsubaFamily family) {
    const Header header = read_header(bytes, file);
    Numbers numbers(bytes, header, file);
    MeshDescription mesh;
    std::size_t vertices = 0;
    for (const Element& element : header.elements)
        if (element.name == "vertex") vertices = element.count;
    for (const Element& element : header.elements) {
        if (element.properties.empty() && element.count > 0)
            throw InputError(file, fmt::format("element {} has no properties", element.name));
        numbers.require_bytes_for(element);
        if (element.name == "vertex")
            read_vertices(mesh, element, numbers);
        else if (element.name == "face")
            FaceReader(mesh, vertices, numbers, family).read(element);
        else
            for (std::size_t i = 0; i < element.count; ++i)
                for (const Property& property : element.properties) pass_over(property, numbers);
    }
    if (mesh.positions.size() != vertices) throw InputError(file, "expected one element called vertex");
    return mesh;
}

MeshDescription Ply::read(ShapeReader& reader) {
    Properties& properties = reader.properties;
    const std::filesystem::path file = reader.require_file();
    const bool face_normals = properties.boolean("face_normals").value_or(false);
    const bool flips = !reader.is_version_06() && properties.boolean("flip_tex_coords").value_or(false);
    MeshDescription mesh = parse_ply_mesh(read_part(file, properties.place_of("filename"), reader.source.bytes_read),
                                          file.string(), reader.element.family());
    if (face_normals) mesh.normals.clear();
    if (flips)
        for (Imath::V2d& uv : mesh.texture_coordinates) uv.y = 1.0 - uv.y;
    if (mesh.triangles.empty()) reader.source.note(fmt::format("{}: has no faces", file.string()));
    return place_mesh(std::move(mesh), reader,
                      {.face_normals = face_normals, .max_smooth_angle = read_max_smooth_angle(reader, face_normals)});
}

}  // namespace photonlab
