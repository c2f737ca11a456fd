// Measured reflection: a table of an isotropic BRDF in the format of the MERL database, looked up by the half-way
// direction and the difference from it, so that highlights lie along an axis of the table.
//
// [Matusik et al. 2003, "A Data-Driven Reflectance Model": the data; Rusinkiewicz 1998, "A New Change of Variables for
// Efficient BRDF Representation": the angles]

#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "scene/materials/bsdf.h"

namespace photonlab {

struct BytesRead;

/// One BRDF, immutable once made and shared by all who look things up in it.
struct MerlTable {
    // theta_h is the half vector's angle from the normal, in bins of its square root: finest where highlights are.
    // theta_d is the angle from the half vector to either direction and phi_d, modulo pi, its azimuth around the half
    // vector: both in even bins.
    static constexpr int half_bins = 90;
    static constexpr int difference_bins = 90;
    static constexpr int azimuth_bins = 180;
    static constexpr int bins = half_bins * difference_bins * azimuth_bins;
    static constexpr std::size_t file_size = 3 * 4 + 3 * sizeof(double) * bins;  ///< bytes

    /// A file's number times this is the channel's BRDF, 1/sr.
    static constexpr double scale[3] = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};

    static constexpr std::size_t index(int half, int difference, int azimuth) {
        return static_cast<std::size_t>(azimuth + azimuth_bins * (difference + difference_bins * half));
    }

    std::vector<Color> values;  ///< 1/sr, without the cosine, by index(); black below the horizon

    // How half vectors are drawn: a ring, one bin of theta_h, is chosen by its probability, and a direction in it
    // evenly.
    std::array<double, half_bins + 1> half_edges;  ///< 1 - cos(theta_h) at the rings' edges, 0 to 1
    std::array<double, half_bins> half_cdf;        ///< probability of this ring or one before it
    std::array<double, half_bins> half_density;    ///< of half vectors, per steradian
    double half_share = 0.0;                       ///< of samples that are drawn by a half vector, in [0.1, 0.9]

    /// Share of the light from one direction that is reflected.
    struct Albedo {
        double degrees;  ///< of the direction from the normal
        ColorD albedo;
    };
    std::vector<Albedo> albedos;  ///< at a few angles
};

/// A table of a file's numbers: the planes red, green and blue, each by MerlTable::index(). Where any channel is
/// negative the directions are below the horizon, and the value is black. Throws InputError, with `name` in it, unless
/// there are 3 * MerlTable::bins finite numbers.
std::shared_ptr<const MerlTable> make_merl_table(const std::vector<double>& numbers, const std::string& name);

/// Reads a file: three little-endian int32 (90, 90, 180), then make_merl_table()'s numbers as float64. Throws
/// InputError at `place` that names the file and what was expected of it. The bytes are added to `bytes_read`.
std::shared_ptr<const MerlTable> load_merl_table(const std::filesystem::path& file, const std::string& place,
                                                 BytesRead& bytes_read);

/// f = the table's nearest bin above the surface, without interpolation, as MERL's own reader does; nothing below.
/// Swapping the two directions finds the same bin, bit for bit.
///
/// Directions are drawn from a mixture: by the cosine, which suits the base under the highlight and keeps every weight
/// bounded, and by reflection about a half vector from the table's own distribution over theta_h, which suits the
/// highlight.
struct Merl {
    static constexpr const char* name = "merl";
    static constexpr bool is_transmissive = false;

    const MerlTable* table;  ///< not null; the material keeps it

    Color evaluate(const Vector& outgoing, const Vector& incoming) const;
    std::optional<BsdfSample> sample(const Vector& outgoing, Carried, const Imath::V2f& u) const;
    float density(const Vector& outgoing, const Vector& incoming) const;
    bool is_black() const { return false; }

    static Merl read(MaterialReader& reader);
    void check(const MaterialCheck& check) const;
};

}  // namespace photonlab
