// What integrators share on the way from values at hit points to an image and to what they say of themselves.

#pragma once

#include <algorithm>
#include <vector>

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

/// What set_radii() set, one value at a time: between an optional's value and its end lie bytes that mean nothing.
inline void exchange_radii(StateArchive& archive, IntegratorReport& report) {
    for (std::optional<double>* radius : {&report.radius_min, &report.radius_mean, &report.radius_max})
        archive.exchange(*radius);
}

}  // namespace photonlab
