#include "scene/emitters/bright_parts.h"

#include <algorithm>
#include <cmath>

#include "scene/textures/texture_mean.h"

namespace photonlab {

namespace {

constexpr std::size_t most_per_side = 64;       // parts
constexpr std::size_t enough_parts = 1u << 14;  // of a mesh, unless it has more triangles
constexpr std::size_t points_per_side = 16;     // of a part that is not measured exactly
constexpr float below_one = 0x1.fffffep-1f;     // where rounding would reach 1

/// Place in a square of which (row, column) is one of n x n parts.
Imath::V2f within(std::size_t part, std::size_t per_side, const Imath::V2f& u) {
    const auto n = static_cast<float>(per_side);
    const auto at = [&](std::size_t index, float offset) {
        return std::min((static_cast<float>(index) + offset) / n, below_one);
    };
    return {at(part % per_side, u.x), at(part / per_side, u.y)};
}

/// The part of a triangle that sample_triangle() makes of a part of the square: its corners as the shares of the second
/// and third of the triangle's.
std::array<TexturedCorner, 4> corners_of(std::size_t part, std::size_t per_side,
                                         const std::array<Imath::V2f, 3>& triangle) {
    const Imath::V2d a(triangle[0]), b(triangle[1]), c(triangle[2]);
    const auto n = static_cast<double>(per_side);
    const auto corner = [&](std::size_t x, std::size_t y) {
        const double root = std::sqrt(static_cast<double>(part % per_side + x) / n);
        const double turn = static_cast<double>(part / per_side + y) / n;
        const Imath::V2d place(root * (1.0 - turn), root * turn);
        return TexturedCorner{place, a * (1.0 - place.x - place.y) + b * place.x + c * place.y};
    };
    return {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
}

/// With which measuring the texture over the mesh takes a second or two at most: 1 where it is an image of 2048 x 2048
/// pixels over a rectangle. Cells are those of the boxes around triangles.
double affordable_coarseness(const TriangleMesh& mesh, const Texture& texture) {
    constexpr double most_cells = 1e7;
    constexpr double coarsest = 1e300;
    const auto cells = [&](double coarseness) {
        double sum = 0.0;
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            sum += cells_inside(texture, mesh.texture_coordinates_of(i), coarseness);
        return sum;
    };
    double coarseness = 1.0;
    while (!(cells(coarseness) <= most_cells) && coarseness < coarsest) coarseness *= 1.5;
    return coarseness;
}

}  // namespace

BrightParts::BrightParts(const Shape& shape, const Texture& texture) {
    std::visit([&](const auto& kind) { measure(kind, texture); }, shape.geometry);
    set_density(largest_color(texture));
}

/// Until set_density(), cdf_ has a part's area times its brightness, and weight_ its area.
void BrightParts::add(double area, const ColorD& mean) {
    mean_ += mean * area;
    weight_.push_back(area);
    cdf_.push_back(area * mean_channel(mean));
}

void BrightParts::measure(const TriangleMesh& mesh, const Texture& texture) {
    const std::size_t triangles = mesh.triangles.size();
    while (per_side_ < most_per_side && 4 * per_side_ * per_side_ * triangles <= enough_parts) per_side_ *= 2;
    const double coarseness = affordable_coarseness(mesh, texture);
    is_exact_ = coarseness == 1.0;
    const TextureMean mean_of(texture, coarseness);
    const std::size_t parts = per_side_ * per_side_;
    for (std::size_t i = 0; i < triangles; ++i) {
        const double area = mesh.triangle_cdf[i] - (i > 0 ? mesh.triangle_cdf[i - 1] : 0.0);
        const std::array<Imath::V2f, 3> corners = mesh.texture_coordinates_of(i);
        for (std::size_t part = 0; part < parts; ++part)
            add(area / static_cast<double>(parts),
                area > 0.0 ? mean_of.over(corners_of(part, per_side_, corners)) : ColorD(0.0));
    }
}

template <AnalyticKind Kind>
void BrightParts::measure(const Kind& shape, const Texture& texture) {
    per_side_ = most_per_side;
    is_exact_ = false;
    constexpr std::size_t points = points_per_side * points_per_side;
    for (std::size_t part = 0; part < per_side_ * per_side_; ++part) {
        ColorD sum(0.0);
        for (std::size_t i = 0; i < points; ++i) {
            const Imath::V2f u = within(part, per_side_, within(i, points_per_side, Imath::V2f(0.5f)));
            sum += ColorD(color_at(texture, shape.texture_coordinate_at(shape.sample_area(u, 0.0).position)));
        }
        add(1.0 / static_cast<double>(per_side_ * per_side_), sum / static_cast<double>(points));
    }
}

void BrightParts::set_density(const Color& largest) {
    constexpr double least_mean = 1e-6;  // of the largest value
    constexpr double least_part = 1e-3;  // likewise, of a part
    if (!is_exact_) {
        for (int channel = 0; channel < 3; ++channel)
            mean_[channel] = std::max(mean_[channel], least_mean * static_cast<double>(largest[channel]));
        for (std::size_t i = 0; i < cdf_.size(); ++i)
            cdf_[i] = std::max(cdf_[i], weight_[i] * least_part * mean_channel(mean_));
    }
    double all = 0.0;
    for (const double brightness : cdf_) all += brightness;
    double running = 0.0;
    for (std::size_t i = 0; i < cdf_.size() && all > 0.0; ++i) {
        weight_[i] = cdf_[i] > 0.0 ? weight_[i] / (cdf_[i] / all) : 0.0;
        running += cdf_[i];
        cdf_[i] = running / all;  // the sum in the same order: 1 from the last that is drawn on
    }
}

BrightParts::Draw BrightParts::draw(const Shape& shape, const Imath::V2f& u, double u_part) const {
    const auto found = std::upper_bound(cdf_.begin(), cdf_.end() - 1, u_part);
    const auto index = static_cast<std::size_t>(found - cdf_.begin());
    const std::size_t parts = per_side_ * per_side_;
    const Imath::V2f there = within(index % parts, per_side_, u);
    return std::visit(
        [&]<typename Kind>(const Kind& kind) -> Draw {
            if constexpr (std::is_same_v<Kind, TriangleMesh>) {
                const std::size_t triangle = index / parts;
                return {kind.point_on(triangle, there), kind.texture_coordinate_on(triangle, there), weight_[index]};
            } else {
                const SurfacePoint point = kind.sample_area(there, 0.0);
                return {point, kind.texture_coordinate_at(point.position), weight_[index]};
            }
        },
        shape.geometry);
}

}  // namespace photonlab
