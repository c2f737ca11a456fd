#include "scene/shapes/meshes/serialized.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

#include "core/error.h"
#include "core/machine/available_memory.h"

namespace photonlab {

namespace {

static_assert(std::endian::native == std::endian::little, "serialized meshes are read as they are: little-endian");

constexpr std::uint16_t magic = 0x041C;
constexpr std::size_t header_bytes = 4;  // magic and version

// What the flags of a mesh say, as far as it is read here.
constexpr std::uint32_t has_normals = 0x1;
constexpr std::uint32_t has_texture_coordinates = 0x2;
constexpr std::uint32_t has_colors = 0x8;
constexpr std::uint32_t is_double = 0x2000;

template <typename T>
T value_at(std::string_view bytes, std::size_t at, const std::string& file) {
    if (at > bytes.size() || bytes.size() - at < sizeof(T)) throw InputError(file, "is cut off");
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}

/// Where mesh `index` begins. At the end of the file stand the places of all, and their number; the first is at the
/// file's beginning, whether there is such a list or not.
std::size_t begin_of_mesh(std::string_view bytes, std::uint16_t version, const MeshInFile& mesh) {
    if (mesh.index == 0) return 0;
    constexpr std::size_t count_bytes = sizeof(std::uint32_t);
    const auto count = value_at<std::uint32_t>(bytes, bytes.size() - std::min(bytes.size(), count_bytes), mesh.file);
    if (mesh.index < 0 || mesh.index >= static_cast<long>(count))
        throw InputError(mesh.place, fmt::format("shape_index: expected 0 to {}, got {}",
                                                 std::max(std::int64_t{count} - 1, std::int64_t{0}), mesh.index));
    const std::size_t bytes_each = version == 4 ? 8 : 4;
    const std::size_t back = bytes_each * (count - static_cast<std::size_t>(mesh.index)) + count_bytes;
    if (back > bytes.size()) throw InputError(mesh.file, "is cut off");
    const std::size_t begin = version == 4 ? value_at<std::uint64_t>(bytes, bytes.size() - back, mesh.file)
                                           : value_at<std::uint32_t>(bytes, bytes.size() - back, mesh.file);
    if (begin > bytes.size() - header_bytes) throw InputError(mesh.file, "is cut off");
    return begin;
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

    template <typename T>
    T value() {
        T value{};
        require_claim(1, sizeof(T));
        read(reinterpret_cast<char*>(&value), sizeof(T));
        return value;
    }

    /// `count` vectors whose components are stored as `Stored`. Few bytes can claim any number of them, and memory
    /// would be taken for all before the first is found missing.
    template <typename Stored, typename Vector>
    std::vector<Vector> vectors(std::uint64_t count) {
        constexpr std::size_t dimensions = Vector::dimensions();
        require_claim(count, dimensions * sizeof(Stored));
        require_memory_for(file_, count * sizeof(Vector));
        std::vector<Vector> vectors;
        vectors.reserve(count);
        std::array<Stored, 1024 * dimensions> block;
        while (vectors.size() < count) {
            const std::size_t size = std::min<std::uint64_t>(1024, count - vectors.size());
            read(reinterpret_cast<char*>(block.data()), size * dimensions * sizeof(Stored));
            for (std::size_t i = 0; i < size; ++i) {
                Vector& vector = vectors.emplace_back();
                for (std::size_t axis = 0; axis < dimensions; ++axis)
                    vector[static_cast<int>(axis)] = block[i * dimensions + axis];
            }
        }
        return vectors;
    }
    template <typename Vector>
    std::vector<Vector> vectors(std::uint64_t count, bool in_double) {
        return in_double ? vectors<double, Vector>(count) : vectors<float, Vector>(count);
    }

    void pass_over(std::uint64_t bytes) {
        require_claim(bytes, 1);
        std::array<char, 4096> block;
        for (std::uint64_t left = bytes; left > 0;) {
            const std::size_t part = std::min<std::uint64_t>(left, block.size());
            read(block.data(), part);
            left -= part;
        }
    }
    void pass_over_text() {
        constexpr int longest = 1 << 16;
        for (int i = 0; i < longest; ++i)
            if (value<char>() == '\0') return;
        fail("has a name without an end");
    }
    [[noreturn]] void fail(const std::string& message) const { throw InputError(file_, message); }

private:
    static constexpr std::uint64_t most_inflated = 1032;  // to each byte, by deflate

    void require_claim(std::uint64_t count, std::size_t bytes_each) {
        if (count > left_ / bytes_each) fail("claims more than its bytes can hold");
        left_ -= count * bytes_each;
    }

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

/// Of version 3 or 4, which the file says that it is.
std::uint16_t version_of(std::string_view bytes, const std::string& file) {
    if (bytes.size() < header_bytes || value_at<std::uint16_t>(bytes, 0, file) != magic)
        throw InputError(file, "expected a serialized mesh, which begins with 1C 04");
    const auto version = value_at<std::uint16_t>(bytes, 2, file);
    if (version != 3 && version != 4)
        throw InputError(file, fmt::format("expected version 3 or 4 of serialized meshes, got {}", version));
    return version;
}

}  // namespace

MeshDescription parse_serialized_mesh(std::string_view bytes, const MeshInFile& which) {
    const std::uint16_t version = version_of(bytes, which.file);
    const std::size_t begin = begin_of_mesh(bytes, version, which);
    Inflated stream(bytes.substr(begin + header_bytes), which.file);

    const auto flags = stream.value<std::uint32_t>();
    if (version == 4) stream.pass_over_text();
    const auto vertices = stream.value<std::uint64_t>();
    const auto triangles = stream.value<std::uint64_t>();
    if (std::max(vertices, triangles) >= std::uint64_t{1} << 32)
        stream.fail("expected fewer than 2^32 vertices and triangles");
    const bool in_double = (flags & is_double) != 0;
    MeshDescription mesh;
    mesh.positions = stream.vectors<VectorD>(vertices, in_double);
    if ((flags & has_normals) != 0) {
        mesh.normals = stream.vectors<VectorD>(vertices, in_double);
        for (VectorD& normal : mesh.normals) normal.normalize();
    }
    if ((flags & has_texture_coordinates) != 0)
        mesh.texture_coordinates = stream.vectors<Imath::V2d>(vertices, in_double);
    if ((flags & has_colors) != 0) stream.pass_over(3 * vertices * (in_double ? sizeof(double) : sizeof(float)));
    mesh.triangles = stream.vectors<std::uint32_t, Imath::Vec3<std::uint32_t>>(triangles);
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& corners = mesh.triangles[i];
        if (std::max({corners.x, corners.y, corners.z}) >= vertices)
            stream.fail(fmt::format("triangle {}: expected vertices below {}", i + 1, vertices));
    }
    return mesh;
}

/// Whether normals are those of faces the property alone says, in both families: the file's own flag is read by
/// neither.
MeshDescription Serialized::read(ShapeReader& reader) {
    Properties& properties = reader.properties;
    const std::filesystem::path file = reader.require_file();
    const long index = properties.integer("shape_index").value_or(0);
    const bool face_normals = properties.boolean("face_normals").value_or(false);
    const std::string bytes = read_part(file, properties.place_of("filename"), reader.source.bytes_read);
    MeshDescription mesh = parse_serialized_mesh(bytes, {file.string(), index, properties.place_of("shape_index")});
    if (face_normals) mesh.normals.clear();
    if (mesh.triangles.empty()) reader.source.note(fmt::format("{}: has no faces", file.string()));
    return place_mesh(std::move(mesh), reader,
                      {.face_normals = face_normals,
                       .keeps_outside = true,
                       .max_smooth_angle = read_max_smooth_angle(reader, face_normals)});
}

}  // namespace photonlab
