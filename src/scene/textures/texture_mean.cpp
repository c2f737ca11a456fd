#include "scene/textures/texture_mean.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "scene/mitsuba/transform.h"

namespace photonlab {

namespace {

struct Corner {
    Imath::V2d place;
    Imath::V2d uv;
    Imath::V2d cell;  // in the lattice
};

Corner between(const Corner& a, const Corner& b, double t) {
    return {a.place + (b.place - a.place) * t, a.uv + (b.uv - a.uv) * t, a.cell + (b.cell - a.cell) * t};
}

/// Convex; each of the four lines that cut it adds one corner at most.
struct Polygon {
    std::array<Corner, 8> corners;
    std::size_t size = 0;

    void add(const Corner& corner) {
        if (size < corners.size()) corners[size++] = corner;  // rounding makes more of what has no area
    }
    double area(std::size_t i) const {  // of the i-th triangle around the first corner
        return 0.5 * std::abs((corners[i + 1].place - corners[0].place).cross(corners[i + 2].place - corners[0].place));
    }
    bool is_whole_cell() const {
        if (size != 4) return false;
        const double cells = 0.5 * (corners[2].cell - corners[0].cell).cross(corners[3].cell - corners[1].cell);
        return std::abs(std::abs(cells) - 1.0) < 1e-9;
    }
    std::pair<double, double> range(int axis) const {
        const auto [least, most] =
            std::minmax_element(corners.begin(), corners.begin() + static_cast<std::ptrdiff_t>(size),
                                [&](const Corner& a, const Corner& b) { return a.cell[axis] < b.cell[axis]; });
        return {least->cell[axis], most->cell[axis]};
    }
};

/// What of it lies where sign * (cell[axis] - bound) >= 0. [Sutherland & Hodgman 1974]
Polygon cut(const Polygon& polygon, int axis, double bound, double sign) {
    Polygon result;
    for (std::size_t i = 0; i < polygon.size; ++i) {
        const Corner& a = polygon.corners[i];
        const Corner& b = polygon.corners[(i + 1) % polygon.size];
        const double from = sign * (a.cell[axis] - bound);
        const double to = sign * (b.cell[axis] - bound);
        if (from >= 0.0) result.add(a);
        if ((from >= 0.0) != (to >= 0.0)) result.add(between(a, b, from / (from - to)));
    }
    return result;
}

/// Calls each(part) for the parts of it in the strips of width 1 along an axis.
template <typename Each>
void for_each_strip(const Polygon& polygon, int axis, const Each& each) {
    const auto [least, most] = polygon.range(axis);
    const double first = std::floor(least);
    const std::size_t strips = most > first ? static_cast<std::size_t>(std::floor(most) - first) + 1 : 1;
    for (std::size_t i = 0; i < strips; ++i) {
        const double lower = first + static_cast<double>(i);
        const Polygon part = strips == 1 ? polygon : cut(cut(polygon, axis, lower, 1.0), axis, lower + 1.0, -1.0);
        if (part.size >= 3) each(part);
    }
}

struct Integral {
    ColorD sum = ColorD(0.0);
    double area = 0.0;
};

/// Pieces of next to no area are what rounding left beyond an edge that lies on a line of the lattice.
void add(Integral& integral, const Texture& texture, const Polygon& piece, double least_area) {
    const auto at = [&](const Corner& a, const Corner& b, const Corner& c) {
        return ColorD(color_at(texture, Imath::V2f(a.uv * (2.0 / 3.0) + (b.uv + c.uv) * (1.0 / 6.0))));
    };
    if (piece.is_whole_cell()) {
        // Most are: the mean of a bilinear function over its square is its value in the middle.
        const double area = piece.area(0) + piece.area(1);
        const Imath::V2d middle = (piece.corners[0].uv + piece.corners[2].uv) * 0.5;
        integral.sum += ColorD(color_at(texture, Imath::V2f(middle))) * area;
        integral.area += area;
        return;
    }
    for (std::size_t i = 0; i + 2 < piece.size; ++i) {
        const double area = piece.area(i);
        if (!(area > least_area)) continue;
        const Corner& a = piece.corners[0];
        const Corner& b = piece.corners[i + 1];
        const Corner& c = piece.corners[i + 2];
        integral.sum += (at(a, b, c) + at(b, c, a) + at(c, a, b)) * (area / 3.0);
        integral.area += area;
    }
}

}  // namespace

double cells_inside(const Texture& texture, const std::array<Imath::V2f, 3>& corners, double coarseness) {
    const Matrix to = to_cells(texture);
    std::array<VectorD, 3> cell;
    for (std::size_t i = 0; i < 3; ++i) cell[i] = transform_point(to, VectorD(corners[i].x, corners[i].y, 0.0));
    double cells = 1.0;
    for (const int axis : {0, 1}) {
        const auto [least, most] = std::minmax({cell[0][axis], cell[1][axis], cell[2][axis]});
        cells *= (most - least) / coarseness + 1.0;
    }
    return cells - 1.0;
}

TextureMean::TextureMean(const Texture& texture, double coarseness) : texture_(texture), to_cells_(to_cells(texture)) {
    Matrix coarser;
    coarser.setScale(VectorD(1.0 / coarseness, 1.0 / coarseness, 1.0));
    to_cells_ = to_cells_ * coarser;
}

ColorD TextureMean::over(std::span<const TexturedCorner> polygon) const {
    assert(polygon.size() <= 4);
    Polygon whole;
    for (const TexturedCorner& corner : polygon) {
        const VectorD cell = transform_point(to_cells_, VectorD(corner.uv.x, corner.uv.y, 0.0));
        whole.add({corner.place, corner.uv, Imath::V2d(cell.x, cell.y)});
    }
    constexpr double next_to_nothing = 1e-13;
    double area = 0.0;
    for (std::size_t i = 0; i + 2 < whole.size; ++i) area += whole.area(i);
    Integral integral;
    for_each_strip(whole, 1, [&](const Polygon& row) {
        for_each_strip(row, 0, [&](const Polygon& piece) { add(integral, texture_, piece, next_to_nothing * area); });
    });
    return integral.area > 0.0 ? integral.sum / integral.area : ColorD(0.0);
}

}  // namespace photonlab
