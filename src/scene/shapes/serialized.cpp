#include "scene/shapes/serialized.h"

#include <fmt/format.h>
#include <zlib.h>

#include <bit>
#include <cstring>

#include "core/error.h"
#include "core/machine/available_memory.h"

namespace photonlab {

namespace {

static_assert(std::endian::native == std::endian::little, "serialized meshes are read as they are: little-endian");

constexpr std::uint16_t magic = 0x041C;
constexpr std::size_t header_bytes = 4;  // magic and version

// What the flags of a mesh say.
constexpr std::uint32_t has_normals = 0x1;
constexpr std::uint32_t has_texture_coordinates = 0x2;
constexpr std::uint32_t has_colors = 0x8;
constexpr std::uint32_t has_face_normals = 0x10;
constexpr std::uint32_t is_double = 0x2000;

template <typename T>
T value_at(std::string_view bytes, std::size_t at, const std::string& file) {
    if (at > bytes.size() || bytes.size() - at < sizeof(T)) throw InputError(file, "is cut off");
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}

/// Where mesh `index` begins: at the end of the file stand the places of all, and their number.
std::size_t place_of_mesh(std::string_view bytes, std::uint16_t version, long index, const std::string& file) {
    const auto count = value_at<std::uint32_t>(bytes, bytes.size() - std::min<std::size_t>(bytes.size(), 4), file);
    if (index < 0 || index >= static_cast<long>(count))
        throw InputError(file, fmt::format("expected shape_index 0 to {}, got {}", std::int64_t{count} - 1, index));
    if (index == 0) return 0;
    const std::size_t bytes_each = version == 4 ? 8 : 4;
    const std::size_t back = bytes_each * (count - static_cast<std::size_t>(index)) + 4;
    if (back > bytes.size()) throw InputError(file, "is cut off");
    return version == 4 ? static_cast<std::size_t>(value_at<std::uint64_t>(bytes, bytes.size() - back, file))
                        : value_at<std::uint32_t>(bytes, bytes.size() - back, file);
}

/// What is compressed, from its beginning.
class Inflated {
public:
    Inflated(std::string_view bytes, const std::string& file) : file_(file), left_(bytes.size() * most_inflated) {
        stream_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));
        stream_.avail_in = static_cast<uInt>(bytes.size());  // files have at most 2 GiB
        if (inflateInit(&stream_) != Z_OK) throw std::bad_alloc();
    }
    Inflated(const Inflated&) = delete;
    Inflated& operator=(const Inflated&) = delete;
    ~Inflated() { inflateEnd(&stream_); }

    /// Few bytes can claim any number of vertices, and memory would be asked for before the first is found missing.
    template <typename T>
    std::vector<T> values(std::uint64_t count) {
        if (count > left_ / sizeof(T)) fail("claims more than its bytes can hold");
        left_ -= count * sizeof(T);
        require_memory_for(file_, count * sizeof(T));
        std::vector<T> values(count);
        read(reinterpret_cast<char*>(values.data()), count * sizeof(T));
        return values;
    }
    template <typename T>
    T value() {
        return values<T>(1).front();
    }
    void pass_over_text() {
        constexpr int longest = 1 << 16;
        for (int i = 0; i < longest; ++i)
            if (value<char>() == '\0') return;
        fail("has a name without an end");
    }
    /// Three or two numbers of `precision` each.
    std::vector<double> numbers(std::uint64_t count, bool in_double) {
        if (in_double) return values<double>(count);
        const std::vector<float> floats = values<float>(count);
        return {floats.begin(), floats.end()};
    }
    [[noreturn]] void fail(const std::string& message) const { throw InputError(file_, message); }

private:
    static constexpr std::uint64_t most_inflated = 1032;  // to each byte, by deflate

    void read(char* to, std::size_t size) {
        while (size > 0) {
            const auto part = static_cast<uInt>(std::min<std::size_t>(size, 1u << 30));
            stream_.next_out = reinterpret_cast<Bytef*>(to);
            stream_.avail_out = part;
            const int result = inflate(&stream_, Z_SYNC_FLUSH);
            const std::size_t done = part - stream_.avail_out;
            if (done == 0 || (result != Z_OK && result != Z_STREAM_END))
                fail("is cut off, or not compressed as it should be");
            to += done;
            size -= done;
        }
    }

    const std::string& file_;
    std::uint64_t left_;
    z_stream stream_{};
};

std::vector<VectorD> vectors_of(const std::vector<double>& numbers) {
    std::vector<VectorD> vectors;
    vectors.reserve(numbers.size() / 3);
    for (std::size_t i = 0; i + 2 < numbers.size(); i += 3)
        vectors.emplace_back(numbers[i], numbers[i + 1], numbers[i + 2]);
    return vectors;
}

}  // namespace

SerializedMesh read_serialized_mesh(const std::filesystem::path& file, long index) {
    const std::string name = file.string();
    const std::string bytes = read_whole_file(file, name);
    if (bytes.size() < header_bytes || value_at<std::uint16_t>(bytes, 0, name) != magic)
        throw InputError(name, "expected a serialized mesh, which begins with 1C 04");
    const auto version = value_at<std::uint16_t>(bytes, 2, name);
    if (version != 3 && version != 4)
        throw InputError(name, fmt::format("expected version 3 or 4 of serialized meshes, got {}", version));
    const std::size_t begin = place_of_mesh(bytes, version, index, name);
    if (begin + header_bytes > bytes.size()) throw InputError(name, "is cut off");
    Inflated stream(std::string_view(bytes).substr(begin + header_bytes), name);

    const auto flags = stream.value<std::uint32_t>();
    if (version == 4) stream.pass_over_text();
    const auto vertices = stream.value<std::uint64_t>();
    const auto triangles = stream.value<std::uint64_t>();
    if (std::max(vertices, triangles) >= std::uint64_t{1} << 32)
        stream.fail("expected fewer than 2^32 vertices and triangles");
    const bool in_double = (flags & is_double) != 0;
    SerializedMesh result{.face_normals = (flags & has_face_normals) != 0};
    MeshDescription& mesh = result.mesh;
    mesh.positions = vectors_of(stream.numbers(3 * vertices, in_double));
    if ((flags & has_normals) != 0) {
        mesh.normals = vectors_of(stream.numbers(3 * vertices, in_double));
        for (VectorD& normal : mesh.normals) normal.normalize();
    }
    if ((flags & has_texture_coordinates) != 0) {
        const std::vector<double> numbers = stream.numbers(2 * vertices, in_double);
        for (std::size_t i = 0; i + 1 < numbers.size(); i += 2)
            mesh.texture_coordinates.emplace_back(numbers[i], numbers[i + 1]);
    }
    if ((flags & has_colors) != 0) stream.numbers(3 * vertices, in_double);
    const std::vector<std::uint32_t> corners = stream.values<std::uint32_t>(3 * triangles);
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
        if (std::max({corners[i], corners[i + 1], corners[i + 2]}) >= vertices)
            stream.fail(fmt::format("triangle {}: expected vertices below {}", i / 3 + 1, vertices));
        mesh.triangles.emplace_back(corners[i], corners[i + 1], corners[i + 2]);
    }
    return result;
}

MeshDescription Serialized::read(ShapeReader& reader) {
    Properties& properties = reader.properties;
    const std::filesystem::path file = reader.require_file();
    const long index = properties.integer("shape_index").value_or(0);
    const auto asked = properties.boolean("face_normals");
    read_part(file, properties.place_of("filename"), reader.source.bytes_read);
    SerializedMesh read = read_serialized_mesh(file, index);
    const bool face_normals = asked.value_or(read.face_normals);
    if (face_normals) read.mesh.normals.clear();
    if (read.mesh.triangles.empty()) reader.source.note(fmt::format("{}: has no faces", file.string()));
    return place_mesh(std::move(read.mesh), reader, face_normals);
}

}  // namespace photonlab
