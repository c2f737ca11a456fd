// What the integrators share: from values at hit points to the layers of an image, and direct light averaged over
// passes.

#pragma once

#include <cstdint>
#include <vector>

#include "image/image.h"
#include "integrators/integrator.h"

namespace photonlab {

/// Sums `radiance_of(index)` of each hit point, times `scale`, into pixels, each value times its point's weight, in the
/// order of the points.
template <typename RadianceOf>
std::vector<Color> to_pixels(const HitPoints& hit_points, const RadianceOf& radiance_of, double scale) {
    std::vector<Color> pixels(pixel_count(hit_points), Color(0.0f));
    ColorD sum(0.0);
    for (std::size_t i = 0; i < hit_points.points.size(); ++i) {
        const HitPoint point = hit_points.points[i];
        if (i > 0 && point.pixel != hit_points.points[i - 1].pixel) sum = ColorD(0.0);
        sum += radiance_of(i) * ColorD(point.weight) * scale;
        pixels[point.pixel] = Color(sum);
    }
    return pixels;
}

/// The image of three layers; emission comes from the hit points, as far as max_depth lets it.
Image make_layers(const HitPoints& hit_points, int max_depth, std::vector<Color> direct, std::vector<Color> gathered);

/// Smallest, mean and largest of `radius_of(index)` (unit box) over `count` hit points, in scene units; leaves the
/// report alone when there are none.
template <typename RadiusOf>
void set_radii(IntegratorReport& report, std::size_t count, const RadiusOf& radius_of, double unit_length) {
    if (count == 0) return;
    double smallest = radius_of(0);
    double largest = smallest;
    double sum = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
        const double radius = radius_of(i);
        smallest = std::min(smallest, radius);
        largest = std::max(largest, radius);
        sum += radius;
    }
    report.radius_min = smallest * unit_length;
    report.radius_mean = sum / static_cast<double>(count) * unit_length;
    report.radius_max = largest * unit_length;
}

/// Direct light at every hit point: `samples` shadow rays each in every pass, averaged over passes. With
/// DirectMode::Photons it stays black and costs nothing.
class DirectLight {
public:
    DirectLight(const IntegratorContext& context, const MethodSettings& settings);

    /// Begins the pass; the number of blocks for add_block(), each to be called once, on any thread, before the next.
    std::size_t begin_pass(std::uint64_t pass);
    void add_block(std::size_t block) { add_samples(begun_, block, sums_); }

    /// The whole pass, unless it was begun before.
    void run_pass(std::uint64_t pass);

    /// The layer: mean over the passes so far. Before the first pass, one sampling made for this call alone.
    std::vector<Color> layer() const;

    /// See Integrator::exchange().
    void exchange(StateArchive& archive) {
        archive.exchange(passes_);
        archive.exchange_as_many(sums_);
    }

    std::uint64_t bytes() const { return sums_.size() * sizeof(ColorD); }

private:
    std::size_t blocks() const;
    void add_samples(std::uint64_t pass, std::size_t block, std::vector<ColorD>& sums) const;
    void add_samples(std::uint64_t pass, std::vector<ColorD>& sums) const;

    const IntegratorContext context_;
    int samples_;  // 0: photons carry direct light
    int max_depth_;
    std::uint64_t passes_ = 0;
    std::uint64_t begun_ = 0;   // the last pass that was begun, counted from 1
    std::vector<ColorD> sums_;  // one a hit point
};

}  // namespace photonlab
