// An image of everything around the scene, which lights it: by latitude and longitude, its bright parts drawn most
// often.

#pragma once

#include <memory>

#include "image/read_image.h"
#include "scene/emitters/infinity/from_infinity.h"

namespace photonlab {

/// The image as a function of directions, and a density by its brightness. As in Mitsuba the image's left edge is
/// towards -z, u = atan2(x, -z) / (2 pi) runs from there to the right, and v = acos(y) / pi down from y. Columns are
/// pixels with their centres inside, and linear in between around the whole circle.
class EnvironmentImage {
public:
    /// Where rows stand: with half a row beyond the first and the last, which go on to the poles unchanged, as in 0.6;
    /// or the first and the last at the poles, as in Mitsuba 3.
    enum class Rows { Centred, FromPoleToPole };

    EnvironmentImage(ColorImage image, Rows rows);

    static constexpr std::size_t bytes_to_pixel = sizeof(double);  ///< beside the image, that is kept of each

    ColorD radiance(const VectorD& local) const;   ///< of a unit direction
    double density(const VectorD& local) const;    ///< per steradian, with which sample() draws it
    VectorD sample(const Imath::V2f& u) const;     ///< unit
    ColorD integral() const { return integral_; }  ///< over all directions, by cells

private:
    struct Cell {
        std::size_t row, column;  // of the cell
        double down, right;       // place in it, 0 to 1
    };
    Cell cell_at(const VectorD& local) const;
    ColorD pixel(std::size_t row, std::size_t column) const;
    ColorD mean_of(std::size_t row, std::size_t column) const;
    double solid_angle(std::size_t row) const;

    ColorImage image_;
    std::vector<double> edges_;                              // of rows of cells, polar angle over pi, from 0 to 1
    std::vector<std::pair<std::size_t, std::size_t>> rows_;  // of pixels above and below each row of cells
    std::vector<double> row_cdf_;                            // running share of brightness, last is 1
    std::vector<double> column_cdf_;                         // in each row of cells
    ColorD integral_ = ColorD(0.0);
};

struct EnvironmentMap;

struct EnvironmentMapDescription {
    std::shared_ptr<const EnvironmentImage> image;
    double scale = 1.0;             ///< at least 0
    TextureAxes axes = scene_axes;  ///< the world's directions of the local axes
    std::string place;
    double sampling_weight = 1.0;

    void check() const;
    Bounds bounds() const { return {}; }
    EnvironmentMap placed(const SceneExtent& extent) const;
};

struct EnvironmentMap {
    static constexpr const char* name = "envmap";
    static constexpr bool is_met_by_rays = true;
    using Description = EnvironmentMapDescription;

    std::shared_ptr<const EnvironmentImage> image;
    double scale;
    TextureAxes axes;
    EntryDiscs discs;

    static EnvironmentMapDescription read(LightReader& reader);

    ColorD power(const std::vector<Shape>&) const { return image->integral() * (scale * discs.area()); }
    Emission emit(const std::vector<Shape>& shapes, const EmissionDraw& draw) const;
    std::optional<DirectSample> sample_direct(const std::vector<Shape>&, const Vector& receiver, const Imath::V2f& u,
                                              double) const;
    ColorD radiance_from(const Vector& direction) const { return image->radiance(to_local(direction)) * scale; }
    double density_of(const Vector& direction) const { return image->density(to_local(direction)); }

private:
    VectorD to_local(const Vector& world) const;
    Vector to_world(const VectorD& local) const;
};

}  // namespace photonlab
