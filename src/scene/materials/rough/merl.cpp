#include "scene/materials/rough/merl.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <numeric>

#include "core/error.h"
#include "core/files/files.h"
#include "core/sampling.h"
#include "scene/materials/material_reader.h"

namespace photonlab {

namespace {

constexpr double half_pi = pi / 2.0;
static_assert(std::endian::native == std::endian::little,
              "MERL files are read as they are, and they are little-endian");

/// Lower edge of a theta_h bin, radians; `bin` may lie between two edges.
double half_edge(double bin) {
    const double share = bin / MerlTable::half_bins;
    return share * share * half_pi;
}

int half_bin(double theta) {
    const int bin = static_cast<int>(MerlTable::half_bins * std::sqrt(theta / half_pi));
    return std::min(bin, MerlTable::half_bins - 1);
}

int difference_bin(double theta) {
    const int bin = static_cast<int>(MerlTable::difference_bins * (theta / half_pi));
    return std::min(bin, MerlTable::difference_bins - 1);
}

int azimuth_bin(double phi) {
    const int bin = static_cast<int>(MerlTable::azimuth_bins * (phi / pi));
    return std::min(bin, MerlTable::azimuth_bins - 1);
}

/// Angle of the half vector from the normal.
double half_angle(const VectorD& half) {
    return std::atan2(std::hypot(half.x, half.y), half.z);
}

/// Where the table holds f(outgoing, incoming). The directions enter only by their sum, which swapping leaves as it is,
/// and by their difference, which swapping turns over in every component and the azimuth's modulus pi turns back: so
/// reciprocity is exact in floating point, too. The angle between them from both sums needs no arc cosine, which would
/// lose the small ones.
std::size_t table_index(const VectorD& outgoing, const VectorD& incoming) {
    const VectorD sum = incoming + outgoing;
    const VectorD difference = incoming - outgoing;
    // The half vector's frame: along growing theta_h, and along growing phi_h.
    const double across = std::hypot(sum.x, sum.y);
    const double cos_phi = across > 0.0 ? sum.x / across : 1.0;
    const double sin_phi = across > 0.0 ? sum.y / across : 0.0;
    const double length = sum.length();
    const double cos_theta = sum.z / length;
    const double sin_theta = across / length;
    const double radial = difference.x * cos_phi + difference.y * sin_phi;
    const double x = radial * cos_theta - difference.z * sin_theta;
    const double y = difference.y * cos_phi - difference.x * sin_phi;
    const double phi = y > 0.0 ? std::atan2(y, x) : y < 0.0 ? std::atan2(-y, -x) : 0.0;
    return MerlTable::index(half_bin(std::atan2(across, sum.z)),
                            difference_bin(std::atan2(difference.length(), length)), azimuth_bin(phi));
}

// ---------------------------------------------------------------------------------------------------------------------
// The distribution of half vectors

using Rings = std::array<double, MerlTable::half_bins>;

/// What rings of theta_h reflect when the surface is lit evenly from all sides.
struct RingLight {
    Rings even;  // of constant f = 1
    Rings mean;  // of f, in this weighting
};

RingLight light_of_rings(const MerlTable& table) {
    RingLight light;
    std::array<double, MerlTable::azimuth_bins> cos_azimuth;
    for (int azimuth = 0; azimuth < MerlTable::azimuth_bins; ++azimuth)
        cos_azimuth[azimuth] = std::cos((azimuth + 0.5) * pi / MerlTable::azimuth_bins);
    for (int half = 0; half < MerlTable::half_bins; ++half) {
        const double theta_h = half_edge(half + 0.5);
        double weight_sum = 0.0;
        double value_sum = 0.0;
        for (int difference = 0; difference < MerlTable::difference_bins; ++difference) {
            const double theta_d = (difference + 0.5) * half_pi / MerlTable::difference_bins;
            const double along = std::cos(theta_h) * std::cos(theta_d);
            const double across = std::sin(theta_h) * std::sin(theta_d);
            for (int azimuth = 0; azimuth < MerlTable::azimuth_bins; ++azimuth) {
                const double cosines =
                    (along - across * cos_azimuth[azimuth]) * (along + across * cos_azimuth[azimuth]);
                if (!(cosines > 0.0)) continue;
                const double weight = cosines * std::sin(theta_d) * std::cos(theta_d);
                weight_sum += weight;
                value_sum += weight * mean_channel(ColorD(table.values[MerlTable::index(half, difference, azimuth)]));
            }
        }
        light.even[half] = weight_sum * (table.half_edges[half + 1] - table.half_edges[half]);
        light.mean[half] = weight_sum > 0.0 ? value_sum / weight_sum : 0.0;
    }
    return light;
}

/// The median of f over rings, weighted by how much they would reflect if f were constant.
double median_of(const RingLight& light) {
    std::array<int, MerlTable::half_bins> by_mean;
    std::iota(by_mean.begin(), by_mean.end(), 0);
    std::sort(by_mean.begin(), by_mean.end(), [&](int a, int b) { return light.mean[a] < light.mean[b]; });
    const double all_even = std::accumulate(light.even.begin(), light.even.end(), 0.0);
    double below = 0.0;
    for (const int half : by_mean) {
        below += light.even[half];
        if (below >= 0.5 * all_even) return light.mean[half];
    }
    return light.mean[by_mean.back()];
}

/// Chooses rings of theta_h by what they add to the light that the surface reflects when it is lit evenly from all
/// sides: the integral over outgoing and incoming directions of f cos cos, where d(outgoing) d(incoming) = 4
/// cos(theta_d) d(half) d(difference). [Rusinkiewicz 1998; Walter et al. 2007, "Microfacet Models for Refraction",
/// section 4.2, for the 4 cos(theta_d)]
///
/// What is the same on all rings is left to the cosine. This base is the median over rings, weighted by how much light
/// they would reflect if f were constant: a highlight on a diffuse body covers less than half of it. What stands above
/// the base is drawn by half vectors, with its share of the energy as its share of the samples; never below 0.1, where
/// the base hides a highlight that is there all the same, nor above 0.9, so that the cosine's part of the density
/// bounds every weight by 10 pi f.
void set_half_distribution(MerlTable& table) {
    for (int half = 0; half <= MerlTable::half_bins; ++half) {
        const double sine = std::sin(0.5 * half_edge(half));
        table.half_edges[half] = 2.0 * sine * sine;
    }
    const auto& [even, mean] = light_of_rings(table);
    const double base = median_of({even, mean});
    double energy = 0.0;
    double highlight_energy = 0.0;
    Rings highlight;
    for (int half = 0; half < MerlTable::half_bins; ++half) {
        highlight[half] = std::max(0.0, mean[half] - base) * even[half];
        highlight_energy += highlight[half];
        energy += mean[half] * even[half];
    }
    if (!(highlight_energy > 0.0)) {  // constant f
        highlight = even;
        highlight_energy = std::accumulate(even.begin(), even.end(), 0.0);
        table.half_share = 0.1;
    } else {
        table.half_share = std::clamp(highlight_energy / energy, 0.1, 0.9);
    }
    double running = 0.0;
    for (int half = 0; half < MerlTable::half_bins; ++half) {
        running += highlight[half];
        table.half_cdf[half] = running / highlight_energy;
        const double solid_angle = 2.0 * pi * (table.half_edges[half + 1] - table.half_edges[half]);
        table.half_density[half] = highlight[half] / highlight_energy / solid_angle;
    }
}

/// Ring of the half vectors whose 1 - cos(theta_h) is drawn by u in [0, 1), and that value itself.
double draw_half(const MerlTable& table, double u) {
    const auto found = std::upper_bound(table.half_cdf.begin(), table.half_cdf.end(), u);
    auto half = static_cast<std::size_t>(found - table.half_cdf.begin());
    half = std::min<std::size_t>(half, MerlTable::half_bins - 1);
    const double before = half > 0 ? table.half_cdf[half - 1] : 0.0;
    const double width = table.half_cdf[half] - before;
    const double inside = width > 0.0 ? std::clamp((u - before) / width, 0.0, 1.0) : 0.5;
    return table.half_edges[half] + (table.half_edges[half + 1] - table.half_edges[half]) * inside;
}

// ---------------------------------------------------------------------------------------------------------------------

/// The integral of f cos over incoming directions, by the midpoint rule over half vectors: rings of theta_h in three
/// parts, each by its exact solid angle, so that no highlight is missed however narrow it is.
ColorD albedo_at(const Merl& material, double degrees) {
    constexpr int parts = 3;
    constexpr int azimuths = 180;  // over half the circle: the other half is its mirror image
    const double angle = degrees * pi / 180.0;
    const VectorD outgoing(std::sin(angle), 0.0, std::cos(angle));
    ColorD sum(0.0);
    for (int ring = 0; ring < MerlTable::half_bins * parts; ++ring) {
        const double theta = half_edge((ring + 0.5) / parts);
        const double solid_angle =
            2.0 * pi * (std::cos(half_edge(ring / double(parts))) - std::cos(half_edge((ring + 1.0) / parts))) /
            azimuths;
        for (int i = 0; i < azimuths; ++i) {
            const double phi = (i + 0.5) * pi / azimuths;
            const VectorD half(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta));
            const double cos_difference = outgoing.dot(half);
            const VectorD incoming = half * (2.0 * cos_difference) - outgoing;
            if (!(cos_difference > 0.0) || !(incoming.z > 0.0)) continue;
            sum += ColorD(material.table->values[table_index(outgoing, incoming)]) *
                   (incoming.z * 4.0 * cos_difference * solid_angle);
        }
    }
    return sum;
}

std::string channel_name(std::size_t channel) {
    const char* names[] = {"red", "green", "blue"};
    return names[channel];
}

}  // namespace

std::shared_ptr<const MerlTable> make_merl_table(const std::vector<double>& numbers, const std::string& name) {
    constexpr std::size_t bins = MerlTable::bins;
    if (numbers.size() != 3 * bins)
        throw InputError(fmt::format("{}: expected {} numbers, got {}", name, 3 * bins, numbers.size()));
    auto table = std::make_shared<MerlTable>();
    table->values.assign(bins, Color(0.0f));
    std::size_t unusable = 0;
    std::size_t first_unusable = 0;
    for (std::size_t channel = 0; channel < 3; ++channel)
        for (std::size_t bin = 0; bin < bins; ++bin) {
            const auto value = static_cast<float>(numbers[channel * bins + bin] * MerlTable::scale[channel]);
            table->values[bin][static_cast<int>(channel)] = value;
            if (!std::isfinite(value) && unusable++ == 0) first_unusable = channel * bins + bin;
        }
    if (unusable > 0) {
        const std::size_t bin = first_unusable % bins;
        throw InputError(
            fmt::format("{}: expected finite numbers, got {} of {} that are not; the first is number {}, {} of theta_h "
                        "{}, theta_d {}, "
                        "phi_d {}, counted from 0",
                        name, unusable, 3 * bins, first_unusable, channel_name(first_unusable / bins),
                        bin / (MerlTable::azimuth_bins * MerlTable::difference_bins),
                        bin / MerlTable::azimuth_bins % MerlTable::difference_bins, bin % MerlTable::azimuth_bins));
    }
    for (Color& value : table->values)
        if (std::min({value.x, value.y, value.z}) < 0.0f) value = Color(0.0f);
    set_half_distribution(*table);
    for (const double degrees : {0.0, 15.0, 30.0, 45.0, 60.0, 75.0, 85.0})
        table->albedos.push_back({degrees, albedo_at(Merl{table.get()}, degrees)});
    return table;
}

/// Refuses a table that is not there; of the scene that comes with the program, which has a script in its place, with
/// what writes one, also where the scene's folder is the system's.
void require_table(const std::filesystem::path& file, const std::string& place) {
    if (is_there(file)) return;
    const std::filesystem::path script = file.parent_path() / "make_table.py";
    throw InputError(
        place,
        fmt::format("{}: is not there; {}", file.string(),
                    is_there(script) ? fmt::format("`/usr/bin/python3 {} {}` writes it, 35 MB, or another FILE, which "
                                                   "-D table=FILE names where this folder cannot be written",
                                                   script.string(), file.string())
                                     : "expected a table of the MERL database"));
}

std::shared_ptr<const MerlTable> load_merl_table(const std::filesystem::path& file, const std::string& place,
                                                 BytesRead& bytes_read) {
    require_table(file, place);
    const std::string bytes = read_part(file, place, bytes_read);
    std::int32_t dimensions[3];
    const bool has_dimensions = bytes.size() >= sizeof(dimensions);
    if (has_dimensions) std::memcpy(dimensions, bytes.data(), sizeof(dimensions));
    if (bytes.size() != MerlTable::file_size || dimensions[0] != MerlTable::half_bins ||
        dimensions[1] != MerlTable::difference_bins || dimensions[2] != MerlTable::azimuth_bins)
        throw InputError(
            place, fmt::format("{}: expected a MERL BRDF, {} bytes with the dimensions {} {} {}, got {} bytes{}",
                               file.string(), MerlTable::file_size, MerlTable::half_bins, MerlTable::difference_bins,
                               MerlTable::azimuth_bins, bytes.size(),
                               has_dimensions ? fmt::format(" with the dimensions {} {} {}", dimensions[0],
                                                            dimensions[1], dimensions[2])
                                              : ""));
    std::vector<double> numbers(3 * static_cast<std::size_t>(MerlTable::bins));
    std::memcpy(numbers.data(), bytes.data() + sizeof(dimensions), numbers.size() * sizeof(double));
    return make_merl_table(numbers, place + ": " + file.string());
}

Color Merl::evaluate(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return Color(0.0f);
    return table->values[table_index(VectorD(outgoing), VectorD(incoming))];
}

/// u.x chooses the mixture's part, and where it fell inside that part is used again: of its 24 bits, those that the
/// choice took are missing then, four at most.
std::optional<BsdfSample> Merl::sample(const Vector& outgoing, Carried, const Imath::V2f& u) const {
    if (outgoing.z <= 0.0f) return std::nullopt;
    Vector incoming;
    if (u.x < table->half_share) {
        const double one_minus_cos = draw_half(*table, u.x / table->half_share);
        const double sine = std::sqrt(one_minus_cos * (2.0 - one_minus_cos));
        const double phi = 2.0 * pi * u.y;
        const VectorD half(sine * std::cos(phi), sine * std::sin(phi), 1.0 - one_minus_cos);
        const VectorD from(outgoing);
        incoming = Vector((half * (2.0 * from.dot(half)) - from).normalized());
    } else {
        const double rest = (u.x - table->half_share) / (1.0 - table->half_share);
        incoming = sample_cosine_hemisphere({static_cast<float>(rest), u.y});
    }
    // Half vectors seen from behind reflect to below the surface, too.
    if (incoming.z <= 0.0f) return std::nullopt;
    const Color value = evaluate(outgoing, incoming);
    if (photonlab::is_black(value)) return std::nullopt;
    const float drawn_with = density(outgoing, incoming);
    return BsdfSample{incoming, value * (incoming.z / drawn_with), drawn_with};
}

float Merl::density(const Vector& outgoing, const Vector& incoming) const {
    if (outgoing.z <= 0.0f || incoming.z <= 0.0f) return 0.0f;
    const VectorD half = (VectorD(outgoing) + VectorD(incoming)).normalized();
    const double of_half = table->half_density[half_bin(half_angle(half))];
    // Reflection about the half vector stretches solid angle by 4 cos(theta_d). [Walter et al. 2007, equation 14]
    const double by_half = of_half / (4.0 * VectorD(outgoing).dot(half));
    const double by_cosine = incoming.z / pi;
    return static_cast<float>(by_cosine + (by_half - by_cosine) * table->half_share);
}

// ---------------------------------------------------------------------------------------------------------------------

namespace {

/// Measured data often reflects more than it gets at grazing angles. It is rendered as it is, and that is said.
void note_energy_above_one(const MerlTable& table, const std::string& file, const SceneSource& source) {
    constexpr double quadrature_error = 0.005;
    const MerlTable::Albedo* brightest = nullptr;
    double most = 1.0 + quadrature_error;
    for (const MerlTable::Albedo& at : table.albedos) {
        const double strongest = std::max({at.albedo.x, at.albedo.y, at.albedo.z});
        if (!(strongest > most)) continue;
        brightest = &at;
        most = strongest;
    }
    if (brightest)
        source.note(
            fmt::format("merl \"{}\": reflects more light than it gets: {:.3f} times as much at {:g} degrees from "
                        "the normal",
                        file, most, brightest->degrees));
}

}  // namespace

Merl Merl::read(MaterialReader& reader) {
    const std::filesystem::path file = reader.require_file();
    const auto table = load_merl_table(file, reader.properties.place_of("filename"), reader.source.bytes_read);
    note_energy_above_one(*table, *reader.properties.text("filename"), reader.source);
    reader.material.data = table;
    return {table.get()};
}

void Merl::check(const MaterialCheck& check) const {
    check.require(check.keeps(table), "its own table");
}

}  // namespace photonlab
