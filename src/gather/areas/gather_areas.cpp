#include "gather/areas/gather_areas.h"

#include <algorithm>
#include <cmath>

namespace photonlab {

namespace {

Imath::V2d slope_of(const AreaWeights& weights, double radius) {
    return Imath::V2d(weights.slope_u, weights.slope_v) / radius;
}

/// Radii are told apart by octaves and parts of these, from one that holds the scene around any point of it down to
/// where lines see nothing any more.
constexpr double largest_radius = 2.0;
constexpr double smallest_radius = 4e-5;
constexpr int whole_steps = 2;  ///< an octave, at which discs are asked whether they are whole
constexpr int flat_steps = 16;  ///< an octave, between which flat areas are interpolated: to 0.03% of the disc
constexpr double measured_octaves = 2.0;  ///< from the top of a SeenArea to its least radius

/// Octaves below the largest radius.
double depth_of(double radius) {
    return std::log2(largest_radius / std::clamp(radius, smallest_radius, largest_radius));
}
double radius_at(double depth) {
    return largest_radius * std::exp2(-depth);
}

/// The last step holds all smaller radii.
int last_step(int steps) {
    return static_cast<int>(steps * depth_of(smallest_radius));
}

/// Nothing is missing and nothing hidden, as far as lines can tell.
bool is_whole(const SeenArea& area) {
    return !area.is_obstructed && std::all_of(area.within.begin(), area.within.end(),
                                              [](const AreaMoments& moments) { return moments.area == 1.0; });
}

}  // namespace

/// Around one point: flat areas at two neighbouring radii, or, where these are not known, a measure by lines.
struct GatherAreas::Around {
    RadiusRange flat_range;
    int flat_step = -1;
    double outermost = 0.0;  // radii between which flat areas are interpolated
    double innermost = 0.0;
    FlatArea outer;
    FlatArea inner;
    RadiusRange surroundings_range;
    std::shared_ptr<const FlatSurroundings> surroundings;  // where they are flat
    std::unique_ptr<SeenArea> measured;

    /// True where the surroundings are flat; their areas around this radius are known then.
    bool is_flat(const Scene& scene, const SurfaceEnd& point, Kernel kernel, double radius) {
        if (!surroundings_range.holds(radius)) look(scene, point, radius);
        if (!surroundings) return false;
        if (!flat_range.holds(radius)) measure_flat(kernel, radius);
        return outer.is_valid && inner.is_valid;
    }

    FlatArea flat(double radius) const {
        const double share = std::clamp((radius - innermost) / (outermost - innermost), 0.0, 1.0);
        return {between(inner.moments, outer.moments, share), outer.is_obstructed || inner.is_obstructed};
    }

private:
    void look(const Scene& scene, const SurfaceEnd& point, double radius) {
        const int step = static_cast<int>(whole_steps * depth_of(radius));
        surroundings_range = range_of_step(step, whole_steps);
        flat_range = {};
        flat_step = -1;
        surroundings.reset();
        if (auto found = flat_surroundings(scene, point, radius_at(static_cast<double>(step) / whole_steps)))
            surroundings = std::make_shared<const FlatSurroundings>(std::move(*found));
    }

    void measure_flat(Kernel kernel, double radius) {
        const int step = static_cast<int>(flat_steps * depth_of(radius));
        const bool follows = step == flat_step + 1 && flat_step >= 0;
        flat_range = range_of_step(step, flat_steps);
        flat_step = step;
        outermost = radius_at(static_cast<double>(step) / flat_steps);
        innermost = radius_at((step + 1.0) / flat_steps);
        outer = follows ? inner : flat_area(*surroundings, kernel, outermost);
        inner = flat_area(*surroundings, kernel, innermost);
    }
};

GatherArea::GatherArea(const SurfaceEnd& point, double radius, const AreaWeights& weights,
                       std::shared_ptr<const FlatSurroundings> walls)
    : part_(std::make_shared<const Part>(Part{std::move(walls), false, point, make_frame(point.geometric_normal),
                                              weights.constant, slope_of(weights, radius)})) {}

GatherArea::GatherArea(const SurfaceEnd& point, double radius, const AreaWeights& weights, bool tests_reach)
    : part_(std::make_shared<const Part>(
          Part{nullptr, tests_reach, point, make_frame(point.normal), weights.constant, slope_of(weights, radius)})) {}

GatherAreas::GatherAreas(const Scene& scene, const GatherAreaSettings& settings, std::size_t points)
    : scene_(scene),
      settings_(settings),
      known_(settings.mode == AreaMode::Disc ? 0 : points),
      around_(known_.size()) {}

GatherAreas::~GatherAreas() = default;

GatherAreas::RadiusRange GatherAreas::range_of_step(int step, int steps) {
    constexpr double rounding = 1e-6;
    const double above = step < last_step(steps) ? radius_at((step + 1.0) / steps) * (1.0 + rounding) : 0.0;
    const double below = radius_at(static_cast<double>(step) / steps) * (1.0 - rounding);
    return {static_cast<float>(above), static_cast<float>(below)};
}

bool GatherAreas::is_whole(const SurfaceEnd& point, Known& known, double radius) const {
    if (!known.range.holds(radius)) {
        const int step = static_cast<int>(whole_steps * depth_of(radius));
        known = {range_of_step(step, whole_steps),
                 is_whole_around(scene_, point, radius_at(static_cast<double>(step) / whole_steps))};
    }
    return known.is_whole;
}

AreaWeights GatherAreas::weights_of(const AreaMoments& moments) const {
    return settings_.mode == AreaMode::Linear ? linear_weights(moments) : seen_weights(moments);
}

GatherArea GatherAreas::area_of(const SurfaceEnd& point, const FlatArea& flat,
                                const std::shared_ptr<const FlatSurroundings>& surroundings, double radius) const {
    if (!flat.is_obstructed && std::abs(flat.moments.area - 1.0) < 1e-9) return {};
    return {point, radius, weights_of(flat.moments), flat.is_obstructed ? surroundings : nullptr};
}

GatherArea GatherAreas::area_of(const SurfaceEnd& point, const SeenArea& measured, double radius) const {
    if (photonlab::is_whole(measured)) return {};
    return {point, radius, weights_of(measured.moments(radius)), measured.is_obstructed};
}

GatherArea GatherAreas::at(const SurfaceEnd& point, std::size_t index, double radius) {
    if (is_of_disc(point)) return {};
    // What is kept follows from this radius alone, so that memory is that of a run which was continued here.
    if (is_whole(point, known_[index], radius)) {
        around_[index].reset();
        return {};
    }
    if (!around_[index]) around_[index] = std::make_unique<Around>();
    Around& around = *around_[index];
    if (around.is_flat(scene_, point, settings_.kernel, radius)) {
        around.measured.reset();
        return area_of(point, around.flat(radius), around.surroundings, radius);
    }

    const int series = static_cast<int>(depth_of(radius) / measured_octaves);
    const double top = radius_at(measured_octaves * series);
    if (!around.measured || around.measured->top != top)
        around.measured = std::make_unique<SeenArea>(measure_seen_area(
            scene_, point, settings_.kernel, top, {settings_.lines, index, static_cast<std::uint64_t>(series)}));
    return area_of(point, *around.measured, radius);
}

GatherArea GatherAreas::of_pass(const SurfaceEnd& point, std::uint64_t index, std::uint64_t pass, double radius) const {
    constexpr int fewer = 8;
    constexpr std::uint64_t first_series = 256;  // beyond those of at()
    if (is_of_disc(point) || is_whole_around(scene_, point, radius)) return {};
    if (auto surroundings = flat_surroundings(scene_, point, radius)) {
        const FlatArea flat = flat_area(*surroundings, settings_.kernel, radius);
        if (flat.is_valid)
            return area_of(point, flat, std::make_shared<const FlatSurroundings>(std::move(*surroundings)), radius);
    }
    return area_of(point,
                   measure_seen_area(scene_, point, settings_.kernel, radius,
                                     {(settings_.lines + fewer - 1) / fewer, index, first_series + pass}),
                   radius);
}

std::uint64_t GatherAreas::bytes() const {
    std::uint64_t bytes = known_.size() * (sizeof(Known) + sizeof(around_[0]));
    for (const auto& around : around_)
        if (around) bytes += sizeof(Around) + (around->measured ? sizeof(SeenArea) : 0);
    return bytes;
}

}  // namespace photonlab
