// What other programs do differently, on purpose: six deviations of progressive photon mapping, each beside the right
// update, on one scene whose answer is exact. Photons, map and update are the program's own, so that only the
// deviation differs. docs/replications/deviations.md says where each is or was, and how to recognise it.
//
// The scene is a furnace cut in two: a cube of edge 2, its walls emit and reflect half of what arrives, with a slab a
// thousandth thick across the middle that does so on both faces. Either side is a closed chamber in which every
// surface emits its radiance Le and reflects as much again: Le / (1 - 1/2) in all. A disc on the slab has photons of
// both chambers within its radius.

#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "gather/map/photon_map.h"
#include "integrators/density_estimate.h"
#include "tests/statistical/scenes.h"
#include "transport/camera/camera_pass.h"

namespace photonlab::test {

inline constexpr double slab_thickness = 1e-3;
inline constexpr double chamber_area = 16.0;      ///< of the surfaces of the near chamber, 2 x 2 x 1
inline constexpr double photons_of_a_path = 2.0;  ///< expected, with albedo 1/2

/// Adds the inside of a box, emitting `radiance`.
inline void add_inside_of_box(SceneDescription& scene, const VectorD& low, const VectorD& high, double radiance) {
    const VectorD x(high.x - low.x, 0, 0);
    const VectorD y(0, high.y - low.y, 0);
    const VectorD z(0, 0, high.z - low.z);
    for (const auto& [first, second, third] : {std::array{x, y, z}, std::array{y, z, x}, std::array{z, x, y}}) {
        scene.shapes.push_back(shape(parallelogram(low, first, second), 0, ColorD(radiance)));
        scene.shapes.push_back(shape(parallelogram(low + third, second, first), 0, ColorD(radiance)));
    }
}

/// The near chamber, which emits 1, is above the slab's upper face at z = 0, of which `resolution`^2 points are seen,
/// on a regular grid within 0.8 of the middle. The chamber beyond emits `beyond`.
inline Scene slab_furnace(int resolution, double beyond = 1.0) {
    SceneDescription description;
    description.materials = {diffuse(Color(0.5f))};
    add_inside_of_box(description, VectorD(-1, -1, 0), VectorD(1, 1, 1), 1.0);
    add_inside_of_box(description, VectorD(-1, -1, -1), VectorD(1, 1, -slab_thickness), beyond);
    const double height = 0.9;
    description.camera = look_at(VectorD(0, 0, height), VectorD(0.0), resolution, resolution,
                                 2.0 * std::atan(0.8 / height) * 180.0 / pi);
    return build_scene(description);
}

/// Photons expected in a disc of `radius` (scene units) on the near face, of a pass of `paths`.
inline double expected_photons(double radius, double paths, double beyond = 1.0) {
    const double area_beyond = 8.0 + 8.0 * (1.0 - slab_thickness);
    const double near_share = chamber_area / (chamber_area + area_beyond * beyond);
    return paths * near_share * photons_of_a_path * pi * radius * radius / chamber_area;
}

/// What one pass brings to one point: its own estimate of the reflected radiance, which should be 1, and the photons
/// that the radius rule is told of.
struct PassEstimate {
    double radiance = 0.0;
    double photons = 0.0;
};

/// The photons of a pass, and the point and disc that ask for them.
struct PointOfPass {
    const Scene& scene;
    const PhotonMap& photons;
    double paths;
    HitPoint point;
    double squared_radius;

    GatherQuery query() const { return query_at(scene, point, std::sqrt(squared_radius)); }
    FluxSum nothing() const { return FluxSum(scene, point, -1); }
    PassEstimate estimate(const FluxSum& sum, double squared_radius_divided_by) const {
        return {sum.flux().x * scene.total_power / (pi * squared_radius_divided_by * paths),
                static_cast<double>(sum.count())};
    }
};

using GatherOfPass = std::function<PassEstimate(const PointOfPass&)>;

/// All accepted photons within the disc, by weight 1.
inline PassEstimate gather_right(const PointOfPass& at) {
    FluxSum sum = at.nothing();
    const GatherQuery query = at.query();
    at.photons.within(query.position, query.normal, query.radius,
                      [&](const Photon& photon, double) { sum.add(photon, 1.0); });
    return at.estimate(sum, at.squared_radius);
}

/// Deviation: those of the wrong side bring nothing and are counted.
inline PassEstimate gather_counting_the_wrong_side(const PointOfPass& at) {
    PassEstimate found = gather_right(at);
    const GatherQuery query = at.query();
    at.photons.within(query.position, -query.normal, query.radius,
                      [&](const Photon&, double) { found.photons += 1.0; });
    return found;
}

/// Deviation: the flux, which has the cosine in it, is multiplied by it once more.
inline PassEstimate gather_with_extra_cosine(const PointOfPass& at) {
    FluxSum sum = at.nothing();
    const GatherQuery query = at.query();
    at.photons.within(query.position, query.normal, query.radius, [&](const Photon& photon, double) {
        sum.add(photon, static_cast<double>(photon.incoming.unit().dot(query.normal)));
    });
    return at.estimate(sum, at.squared_radius);
}

/// No more than k photons: the k-th sets the radius and carries no flux.
inline GatherOfPass gather_nearest_right(std::size_t k) {
    return [k](const PointOfPass& at) {
        FluxSum sum = at.nothing();
        const NearestPhotons nearest =
            at.photons.nearest(at.query(), k, [&](const Photon& photon, double, double) { sum.add(photon, 1.0); });
        return at.estimate(sum, nearest.squared_radius);
    };
}

/// Deviation: the k-th sets the radius and is counted. Asked for k + 1, the map gives k, nearest first.
inline GatherOfPass gather_nearest_counting_the_last(std::size_t k) {
    return [k](const PointOfPass& at) {
        FluxSum sum = at.nothing();
        double farthest = 0.0;
        at.photons.nearest(at.query(), k + 1, [&](const Photon& photon, double squared_distance, double) {
            sum.add(photon, 1.0);
            farthest = squared_distance;
        });
        return at.estimate(sum, sum.count() < k ? at.squared_radius : farthest);
    };
}

/// Deviation: update number i divides the radius that there is by i^((1-g)/2), so that it falls as by a factorial.
class FactorialRadius : public RadiusRule {
public:
    explicit FactorialRadius(double g) : g_(g) {}
    void take(std::size_t, const PassGather& gathered, GatherStatistics& statistics) override {
        statistics.squared_radius *= std::pow(static_cast<double>(gathered.pass), g_ - 1.0);
    }
    void exchange(StateArchive&) override {}

private:
    const double g_;
};

/// Deviation: radius r_1 / (1 + i / decay) in pass i + 1, so that variance grows again.
class ReciprocalRadius : public RadiusRule {
public:
    explicit ReciprocalRadius(double decay) : decay_(decay) {}
    void take(std::size_t, const PassGather& gathered, GatherStatistics& statistics) override {
        const double passes = static_cast<double>(gathered.pass);
        const double shrink = (decay_ + passes - 1.0) / (decay_ + passes);
        statistics.squared_radius *= shrink * shrink;
    }
    void exchange(StateArchive&) override {}

private:
    const double decay_;
};

/// Emission that is added to the flux that shrinks with the disc: tau = (tau + Le n pi R^2) rho. Right with the radius
/// before the disc shrinks. Deviation: with the one after.
struct EmissionInFlux {
    double flux = 0.0;
    double paths = 0.0;

    void take(double paths_of_pass, double squared_radius, double shrink) {
        flux = (flux + paths_of_pass * pi * squared_radius) * shrink;
        paths += paths_of_pass;
    }
    /// In shares of Le.
    double shown(double squared_radius) const { return flux / (paths * pi * squared_radius); }
};

/// A gather and a radius rule at every point of an image, pass by pass, by the program's update.
class Estimates {
public:
    Estimates(const Scene& scene, const HitPoints& hit_points, double radius, GatherOfPass gather,
              std::unique_ptr<RadiusRule> rule)
        : scene_(scene), points_(hit_points.points), gather_(std::move(gather)), rule_(std::move(rule)) {
        first_squared_radius_ = radius * radius / (scene.unit_length * scene.unit_length);
        statistics_.assign(points_.size(), {.squared_radius = first_squared_radius_});
        emission_right_.resize(points_.size());
        emission_shrunk_.resize(points_.size());
    }

    void take(const PhotonMap& photons, std::uint64_t pass, double paths) {
        double shrinks = 0.0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            GatherStatistics& at = statistics_[i];
            const double before = at.squared_radius;
            const PassEstimate found = gather_({scene_, photons, paths, points_[i], before});
            take_pass(at, *rule_, i,
                      {.pass = pass, .passes = pass, .found = found.photons, .estimate = ColorD(found.radiance)}, 0.0);
            const double shrink = at.squared_radius / before;
            emission_right_[i].take(paths, before, shrink);
            emission_shrunk_[i].take(paths, at.squared_radius, shrink);
            shrinks += shrink;
        }
        mean_shrink_ += (shrinks / static_cast<double>(points_.size()) - mean_shrink_) / static_cast<double>(pass);
    }

    /// Means over points; right is 1, and 0 for the error.
    double radiance() const {
        return mean([&](std::size_t i) { return statistics_[i].estimate.x; });
    }
    double squared_error() const {
        return mean(
            [&](std::size_t i) { return (statistics_[i].estimate.x - 1.0) * (statistics_[i].estimate.x - 1.0); });
    }
    double squared_radius() const {  ///< in shares of the first
        return mean([&](std::size_t i) { return statistics_[i].squared_radius / first_squared_radius_; });
    }
    double emission_right() const {
        return mean([&](std::size_t i) { return emission_right_[i].shown(statistics_[i].squared_radius); });
    }
    double emission_shrunk() const {
        return mean([&](std::size_t i) { return emission_shrunk_[i].shown(statistics_[i].squared_radius); });
    }
    double mean_shrink() const { return mean_shrink_; }  ///< over points and passes, of the squared radius

private:
    template <typename Value>
    double mean(const Value& value) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < points_.size(); ++i) sum += value(i);
        return sum / static_cast<double>(points_.size());
    }

    const Scene& scene_;
    const HitPointList& points_;
    const GatherOfPass gather_;
    const std::unique_ptr<RadiusRule> rule_;
    double first_squared_radius_ = 0.0;  // unit box
    std::vector<GatherStatistics> statistics_;
    std::vector<EmissionInFlux> emission_right_;
    std::vector<EmissionInFlux> emission_shrunk_;
    double mean_shrink_ = 0.0;
};

/// One deviation with everything that its curve needs.
struct Deviation {
    std::string name;
    std::string quantity;
    int resolution;        ///< points along a side
    double radius;         ///< of the first pass, scene units
    std::uint64_t paths;   ///< a pass, in both chambers
    std::uint64_t passes;  ///< of the curve
    double beyond;         ///< emitted in the other chamber
    GatherOfPass gather_right;
    GatherOfPass gather_deviating;
    std::function<std::unique_ptr<RadiusRule>()> rule_right;
    std::function<std::unique_ptr<RadiusRule>()> rule_deviating;
    std::function<double(const Estimates&)> value_right;
    std::function<double(const Estimates&)> value_deviating;
};

/// Runs both side by side on the same photons; `see(pass, right, deviating)` after every pass.
template <typename See>
void run_deviation(const Deviation& deviation, std::uint64_t seed, std::uint64_t passes, const See& see) {
    const Scene scene = slab_furnace(deviation.resolution, deviation.beyond);
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    Estimates right(scene, hit_points, deviation.radius, deviation.gather_right, deviation.rule_right());
    Estimates deviating(scene, hit_points, deviation.radius, deviation.gather_deviating, deviation.rule_deviating());
    for (std::uint64_t pass = 1; pass <= passes; ++pass) {
        PhotonPass traced =
            trace_photons(scene, {.paths = deviation.paths, .seed = seed, .store_direct = true}, pass, 1);
        const double paths = static_cast<double>(traced.paths_emitted);
        const PhotonMap photons(std::move(traced.photons));
        right.take(photons, pass, paths);
        deviating.take(photons, pass, paths);
        see(pass, right, deviating);
    }
}

inline constexpr std::size_t capped_k = 10;

/// All six, with alpha 0.7 where the rule is Hachisuka's and LuxCore's 0.96 where the mistake is.
inline std::vector<Deviation> deviations() {
    const auto rule = [](ScheduleName schedule, double alpha) {
        return [=] { return make_radius_rule({.schedule = schedule, .alpha = alpha}, 0); };
    };
    const auto hachisuka = rule(ScheduleName::Hachisuka, 0.7);
    const auto knaus_zwicker = rule(ScheduleName::KnausZwicker, 2.0 / 3.0);
    const GatherOfPass right = gather_right;
    const auto radiance = [](const Estimates& of) { return of.radiance(); };
    const auto squared_error = [](const Estimates& of) { return of.squared_error(); };
    const auto squared_radius = [](const Estimates& of) { return of.squared_radius(); };
    return {
        {"emission", "emission shown", 8, 0.09, 12'600, 128, 1.0, right, right, hachisuka, hachisuka,
         [](const Estimates& of) { return of.emission_right(); },
         [](const Estimates& of) { return of.emission_shrunk(); }},
        {"factorial", "squared error", 16, 0.045, 12'600, 64, 1.0, right, right, rule(ScheduleName::KnausZwicker, 0.96),
         [] { return std::make_unique<FactorialRadius>(0.96); }, squared_error, squared_error},
        {"reciprocal", "squared error", 16, 0.045, 200, 16'384, 1.0, right, right, knaus_zwicker,
         [] { return std::make_unique<ReciprocalRadius>(256.0); }, squared_error, squared_error},
        {"k-th photon", "radiance", 4, 0.19, 5'640, 256, 1.0, gather_nearest_right(capped_k),
         gather_nearest_counting_the_last(capped_k), knaus_zwicker, knaus_zwicker, radiance, radiance},
        {"wrong side", "squared radius", 16, 0.045, 2'550, 512, 50.0, right, gather_counting_the_wrong_side, hachisuka,
         hachisuka, squared_radius, squared_radius},
        {"cosine", "radiance", 8, 0.09, 3'150, 64, 1.0, right, gather_with_extra_cosine, hachisuka, hachisuka, radiance,
         radiance},
    };
}

inline Deviation deviation_named(const std::string& name) {
    for (const Deviation& deviation : deviations())
        if (deviation.name == name) return deviation;
    throw std::invalid_argument(name);
}

}  // namespace photonlab::test
