#include "gather/areas/flat_area.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace photonlab {

namespace {

/// Integrals of K(t) t, K(t) t^2 and K(t) t^3 from 0 to q in [0, 1].
struct Radial {
    double area;
    double first;
    double second;
};

Radial integrals_to(Kernel kernel, double q) {
    const double q2 = q * q;
    const double q3 = q2 * q;
    const double q4 = q2 * q2;
    switch (kernel) {
        case Kernel::Disc:
            return {q2 / 2.0, q3 / 3.0, q4 / 4.0};
        case Kernel::Cone:
            return {3.0 * (q2 / 2.0 - q3 / 3.0), 3.0 * (q3 / 3.0 - q4 / 4.0), 3.0 * (q4 / 4.0 - q4 * q / 5.0)};
        case Kernel::Epanechnikov:
            return {2.0 * (q2 / 2.0 - q4 / 4.0), 2.0 * (q3 / 3.0 - q4 * q / 5.0), 2.0 * (q4 / 4.0 - q4 * q2 / 6.0)};
        case Kernel::Biweight:
            return {3.0 * (q2 / 2.0 - q4 / 2.0 + q4 * q2 / 6.0), 3.0 * (q3 / 3.0 - 0.4 * q4 * q + q4 * q3 / 7.0),
                    3.0 * (q4 / 4.0 - q4 * q2 / 3.0 + q4 * q4 / 8.0)};
    }
    return {0.0, 0.0, 0.0};
}

struct Edge {
    Imath::V2d from;
    Imath::V2d to;
    double turn;  // sign of the angle from `from` to `to`; 0 where it is seen end on
};

/// Where the ray from 0 crosses the edge, in lengths of `ray`.
std::optional<double> crossing(const Edge& edge, const Imath::V2d& ray) {
    const double from = ray.cross(edge.from);
    const double to = ray.cross(edge.to);
    if ((from > 0.0) == (to > 0.0)) return std::nullopt;
    const double place = (edge.from.dot(ray) * to - edge.to.dot(ray) * from) / ((to - from) * ray.length2());
    return place > 0.0 ? std::optional(place) : std::nullopt;
}

/// So short are the intervals that four points integrate them to 5e-5 of the disc, grazing edges included.
constexpr int parts_of_turn = 16;

/// Edges in units of the radius, and the angles between which nothing changes its kind.
class PolarView {
public:
    PolarView(const FlatSurroundings& surroundings, double radius) {
        for (const auto& triangle : surroundings.triangles)
            for (std::size_t i = 0; i < 3; ++i) edges_.push_back(make_edge(triangle[i], triangle[(i + 1) % 3], radius));
        for (const auto& wall : surroundings.walls) walls_.push_back(make_edge(wall[0], wall[1], radius));
        for (const auto* list : {&edges_, &walls_})
            for (const Edge& edge : *list) add_angles(edge);
        for (const Edge& wall : walls_)
            for (const Edge& edge : edges_) add_meeting(wall, edge);
        for (int part = 0; part <= parts_of_turn; ++part) angles_.push_back(pi * (2.0 * part / parts_of_turn - 1.0));
        std::sort(angles_.begin(), angles_.end());
    }

    const std::vector<double>& angles() const { return angles_; }

    /// To the nearest wall or the rim.
    double seen_to(const Imath::V2d& ray) const {
        double nearest = 1.0;
        for (const Edge& wall : walls_)
            if (const auto place = crossing(wall, ray)) nearest = std::min(nearest, *place);
        return nearest;
    }

    Radial covered_to(const Imath::V2d& ray, Kernel kernel, double farthest) const {
        Radial sum{0.0, 0.0, 0.0};
        for (const Edge& edge : edges_) {
            const auto place = edge.turn != 0.0 ? crossing(edge, ray) : std::nullopt;
            if (!place) continue;
            const Radial part = integrals_to(kernel, std::min(*place, farthest));
            sum.area += edge.turn * part.area;
            sum.first += edge.turn * part.first;
            sum.second += edge.turn * part.second;
        }
        return sum;
    }

private:
    static Edge make_edge(const Imath::V2d& from, const Imath::V2d& to, double radius) {
        const double turn = from.cross(to);
        return {from / radius, to / radius, turn > 0.0 ? 1.0 : turn < 0.0 ? -1.0 : 0.0};
    }

    void add_angle(const Imath::V2d& place) { angles_.push_back(std::atan2(place.y, place.x)); }

    /// Its ends, and where it passes the rim.
    void add_angles(const Edge& edge) {
        add_angle(edge.from);
        add_angle(edge.to);
        const Imath::V2d along = edge.to - edge.from;
        const double squared = along.length2();
        if (squared == 0.0) return;
        const double half = edge.from.dot(along) / squared;
        const double discriminant = half * half - (edge.from.length2() - 1.0) / squared;
        if (discriminant <= 0.0) return;
        for (const double place : {-half - std::sqrt(discriminant), -half + std::sqrt(discriminant)})
            if (place > 0.0 && place < 1.0) add_angle(edge.from + along * place);
    }

    void add_meeting(const Edge& a, const Edge& b) {
        const Imath::V2d along_a = a.to - a.from;
        const Imath::V2d along_b = b.to - b.from;
        const double slope = along_a.cross(along_b);
        if (slope == 0.0) return;
        const double place = (b.from - a.from).cross(along_b) / slope;
        if (place > 0.0 && place < 1.0) add_angle(a.from + along_a * place);
    }

    std::vector<Edge> edges_;  // of the triangles
    std::vector<Edge> walls_;
    std::vector<double> angles_;
};

}  // namespace

FlatArea flat_area(const FlatSurroundings& surroundings, Kernel kernel, double radius) {
    // [Abramowitz & Stegun, table 25.4: Gauss, four points]
    constexpr std::array nodes{-0.861136311594053, -0.339981043584856, 0.339981043584856, 0.861136311594053};
    constexpr std::array weights{0.347854845137454, 0.652145154862546, 0.652145154862546, 0.347854845137454};
    const PolarView view(surroundings, radius);
    FlatArea area;
    double hidden = 0.0;
    for (std::size_t i = 0; i + 1 < view.angles().size(); ++i) {
        const double middle = 0.5 * (view.angles()[i + 1] + view.angles()[i]);
        const double half = 0.5 * (view.angles()[i + 1] - view.angles()[i]);
        if (half < 1e-12) continue;
        for (std::size_t node = 0; node < nodes.size(); ++node) {
            const double angle = middle + half * nodes[node];
            const Imath::V2d ray(std::cos(angle), std::sin(angle));
            const double seen_to = view.seen_to(ray);
            const Radial seen = view.covered_to(ray, kernel, seen_to);
            const double weight = half * weights[node] / pi;
            area.moments.area += weight * seen.area;
            area.moments.u += weight * seen.first * ray.x;
            area.moments.v += weight * seen.first * ray.y;
            area.moments.uu += weight * seen.second * ray.x * ray.x;
            area.moments.uv += weight * seen.second * ray.x * ray.y;
            area.moments.vv += weight * seen.second * ray.y * ray.y;
            if (seen_to < 1.0) hidden += weight * (view.covered_to(ray, kernel, 1.0).area - seen.area);
            if (seen.area > integrals_to(kernel, seen_to).area + 1e-6) area.is_valid = false;
        }
    }
    area.is_obstructed = hidden > 1e-9;
    return area;
}

bool is_hidden(const FlatSurroundings& surroundings, const Imath::V2d& offset) {
    return std::any_of(surroundings.walls.begin(), surroundings.walls.end(), [&](const auto& wall) {
        const auto place = crossing({wall[0], wall[1], 0.0}, offset);
        return place && *place < 1.0;
    });
}

}  // namespace photonlab
