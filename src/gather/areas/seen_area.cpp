#include "gather/areas/seen_area.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/random.h"
#include "gather/areas/in_reach.h"
#include "gather/map/photon_map.h"

namespace photonlab {

namespace {

/// Heights below this are roundings of float positions: the crossing is taken to lie in the point's plane, so that
/// whole flat surface is whole to the last bit.
constexpr double flat_height = 1e-6;

double outer_radius(double top, int ring) {
    return top * std::exp2(-0.5 * ring);
}

double measured_radius(double top, std::size_t i) {
    return top * std::exp2(-0.25 * static_cast<double>(i));
}

/// Where a line crosses a surface on which a photon would count.
struct Crossing {
    std::size_t line;
    double squared_distance;
    double area;  ///< that it stands for, unit box
};

/// The lines of one measure, and what they cross.
class LineSet {
public:
    LineSet(const Scene& scene, const SurfaceEnd& point, double top, const AreaLines& lines)
        : scene_(scene), point_(point), frame_(make_frame(point.normal)), top_(top) {
        RandomStream random(0, RandomPurpose::SeenArea, lines.series, lines.index);
        for (int ring = 0; ring < SeenArea::rings; ++ring) draw_ring(ring, lines.per_ring, random);
        test_reach();
    }

    struct Line {
        double u;
        double v;
        double area;  ///< of the disc that it stands for

        double squared_distance() const { return u * u + v * v; }
    };
    const std::vector<Line>& lines() const { return lines_; }
    const std::vector<Crossing>& crossings() const { return crossings_; }
    bool is_obstructed() const { return is_obstructed_; }

private:
    void draw_ring(int ring, int count, RandomStream& random) {
        const double outer = std::pow(outer_radius(top_, ring), 2);
        const double inner = ring + 1 < SeenArea::rings ? std::pow(outer_radius(top_, ring + 1), 2) : 0.0;
        const double shift = random.next_double();
        const double turn = random.next_double();
        for (int i = 0; i < count; ++i) {
            const double radius = std::sqrt(inner + (outer - inner) * (i + shift) / count);
            const double angle = 2.0 * pi * (turn + i * std::numbers::phi);
            draw({radius * std::cos(angle), radius * std::sin(angle), pi * (outer - inner) / count});
        }
    }

    void draw(const Line& line) {
        lines_.push_back(line);
        const double half_chord = std::sqrt(std::max(0.0, top_ * top_ - line.squared_distance())) + flat_height;
        const VectorD foot =
            VectorD(point_.position) + VectorD(frame_.tangent) * line.u + VectorD(frame_.bitangent) * line.v;
        const Ray ray{Vector(foot + VectorD(frame_.normal) * half_chord), -frame_.normal};
        find_crossings(scene_, ray, static_cast<float>(2.0 * half_chord), hits_);
        for (const Hit& hit : hits_) add(hit, line);
    }

    void add(const Hit& hit, const Line& line) {
        const std::optional<Surface> surface = orient_to_gather(scene_, hit, frame_.normal);
        if (!surface || !is_scattering(surface->bsdf)) return;
        // The photon that could lie there, kept as photons are.
        const Photon photon{.position = hit.position,
                            .power = Color(0.0f),
                            .incoming = PackedDirection(frame_.normal),
                            .normal = CoarseDirection(surface->frame.normal),
                            .edges = 1};
        if (!PhotonSide(photon).is_accepted_at({point_.position, point_.normal, top_})) return;
        double height = (VectorD(hit.position) - VectorD(point_.position)).dot(VectorD(frame_.normal));
        if (std::abs(height) < flat_height) height = 0.0;
        const double cosine = surface->geometric_normal.dot(frame_.normal);
        crossings_.push_back({lines_.size() - 1, line.squared_distance() + height * height,
                              line.area / (cosine > 1.0 - 1e-6 ? 1.0 : cosine)});
        photons_.push_back(photon);
    }

    /// Drops what is out of reach.
    void test_reach() {
        std::size_t kept = 0;
        for (std::size_t first = 0; first < photons_.size(); first += 8) {
            const std::size_t count = std::min<std::size_t>(8, photons_.size() - first);
            const unsigned in_reach = in_reach_of_eight(scene_, point_, std::span(photons_).subspan(first, count));
            for (std::size_t i = 0; i < count; ++i)
                if (in_reach >> i & 1u) crossings_[kept++] = crossings_[first + i];
        }
        is_obstructed_ = kept < crossings_.size();
        crossings_.resize(kept);
    }

    const Scene& scene_;
    const SurfaceEnd& point_;
    const Frame frame_;
    const double top_;
    std::vector<Line> lines_;
    std::vector<Crossing> crossings_;
    std::vector<Photon> photons_;  // one a crossing
    std::vector<Hit> hits_;
    bool is_obstructed_ = false;
};

/// The area is 1 less what the lines find less than they would on a whole
/// disc: without variance there, and unbiased elsewhere, since the lines' own measure of the disc is.
AreaMoments moments_within(const LineSet& set, Kernel kernel, double radius) {
    const double squared_radius = radius * radius;
    const auto kernel_at = [&](double squared_distance) {
        return squared_distance > squared_radius * (1.0 + 1e-12)
                   ? 0.0
                   : kernel_weight(kernel, std::min(1.0, squared_distance / squared_radius));
    };
    AreaMoments sum;
    double missing = 0.0;
    auto crossing = set.crossings().begin();  // in the order of the lines
    for (std::size_t i = 0; i < set.lines().size(); ++i) {
        const LineSet::Line& line = set.lines()[i];
        double found = 0.0;
        for (; crossing != set.crossings().end() && crossing->line == i; ++crossing)
            found += crossing->area * kernel_at(crossing->squared_distance);
        missing += line.area * kernel_at(line.squared_distance()) - found;
        const double u = line.u / radius;
        const double v = line.v / radius;
        sum.u += found * u;
        sum.v += found * v;
        sum.uu += found * u * u;
        sum.uv += found * u * v;
        sum.vv += found * v * v;
    }
    const double disc = pi * squared_radius;
    return {1.0 - missing / disc, sum.u / disc, sum.v / disc, sum.uu / disc, sum.uv / disc, sum.vv / disc};
}

}  // namespace

AreaMoments SeenArea::moments(double radius) const {
    const double place = std::clamp(-4.0 * std::log2(radius / top), 0.0, static_cast<double>(radii - 1));
    const auto outer = std::min(static_cast<std::size_t>(place), radii - 2);
    const double inner_radius = measured_radius(top, outer + 1);
    const double share = (radius - inner_radius) / (measured_radius(top, outer) - inner_radius);
    return between(within[outer + 1], within[outer], std::clamp(share, 0.0, 1.0));
}

SeenArea measure_seen_area(const Scene& scene, const SurfaceEnd& point, Kernel kernel, double top,
                           const AreaLines& lines) {
    SeenArea area;
    area.top = std::max(top, least_seen_radius);
    const LineSet set(scene, point, area.top, lines);
    area.is_obstructed = set.is_obstructed();
    for (std::size_t i = 0; i < SeenArea::radii; ++i)
        area.within[i] = moments_within(set, kernel, measured_radius(area.top, i));
    return area;
}

}  // namespace photonlab
