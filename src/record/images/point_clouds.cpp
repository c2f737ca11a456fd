#include "record/images/point_clouds.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>

namespace photonlab {

namespace {

static_assert(std::endian::native == std::endian::little);  // as the header says

template <typename Value>
void append(std::string& bytes, Value value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void append(std::string& bytes, const Vector& vector) {
    for (int i = 0; i < 3; ++i) append(bytes, vector[i]);
}

Vector in_scene(const Scene& scene, const Vector& position) {
    return Vector(VectorD(position) * scene.unit_length + scene.centre);
}

std::string header(const std::string& comment, std::size_t count, const std::string& properties) {
    return fmt::format("ply\nformat binary_little_endian 1.0\ncomment photonlab: {}\nelement vertex {}\n{}end_header\n",
                       comment, count, properties);
}

constexpr const char* position_properties = "property float x\nproperty float y\nproperty float z\n";

/// Calls `add(index)` for at most `most` of `count`, evenly spread; returns how many.
template <typename Add>
void for_sample(std::size_t count, std::size_t kept, const Add& add) {
    for (std::size_t i = 0; i < kept; ++i) add(i * count / kept);
}

}  // namespace

std::string photons_as_ply(const Scene& scene, const PhotonPass& pass, std::size_t most) {
    const std::size_t kept = std::min(most, pass.photons.size());
    std::string bytes = header(
        fmt::format("{} of {} photons of one pass, of {} light paths", kept, pass.photons.size(), pass.paths_emitted),
        kept,
        std::string(position_properties) +
            "property float dx\nproperty float dy\nproperty float dz\nproperty float power_r\nproperty float power_g\n"
            "property float power_b\nproperty uchar caustic\nproperty ushort edges\n");
    const double scale = scene.total_power * scene.unit_length * scene.unit_length /
                         static_cast<double>(std::max<std::uint64_t>(1, pass.paths_emitted));
    for_sample(pass.photons.size(), kept, [&](std::size_t i) {
        const Photon& photon = pass.photons[i];
        append(bytes, in_scene(scene, photon.position));
        append(bytes, -photon.incoming.unit());
        append(bytes, Color(ColorD(photon.power) * scale));
        append(bytes, static_cast<std::uint8_t>(photon.caustic));
        append(bytes, static_cast<std::uint16_t>(photon.edges));
    });
    return bytes;
}

std::string hit_points_as_ply(const Scene& scene, const HitPoints& hit_points, std::size_t most) {
    const std::size_t kept = std::min(most, hit_points.points.size());
    std::string bytes = header(
        fmt::format("{} of {} hit points of {} x {} pixels", kept, hit_points.points.size(), hit_points.width,
                    hit_points.height),
        kept,
        std::string(position_properties) +
            "property float nx\nproperty float ny\nproperty float nz\nproperty ushort column\nproperty ushort row\n"
            "property float weight\nproperty ushort edges\n");
    const auto width = static_cast<std::uint32_t>(hit_points.width);
    for_sample(hit_points.points.size(), kept, [&](std::size_t i) {
        const HitPoint point = hit_points.points[i];
        append(bytes, in_scene(scene, point.position));
        append(bytes, point.normal);
        append(bytes, static_cast<std::uint16_t>(point.pixel % width));
        append(bytes, static_cast<std::uint16_t>(point.pixel / width));
        append(bytes, static_cast<float>(mean_channel(ColorD(point.weight))));
        append(bytes, point.camera_edges);
    });
    return bytes;
}

}  // namespace photonlab
