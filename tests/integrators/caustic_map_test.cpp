// The two maps of photon mapping: photons that came by mirrors alone are searched apart from the others, each with its
// own settings, and together they are all photons.

#include <gtest/gtest.h>

#include "gather/map/photon_map.h"
#include "integrators/density_estimate.h"
#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"

namespace photonlab::test {
namespace {

/// A floor in front of a mirror and a white wall, under a lamp.
Scene room_with_a_mirror() {
    SceneDescription scene = floor_seen_at_origin(Color(0.7f), 3.0);
    scene.materials.push_back({.id = "mirror", .bsdf = Conductor{}, .two_sided = true});
    scene.shapes.push_back(shape(parallelogram({-2, 0, -2}, {4, 0, 0}, {0, 4, 0}), 2));
    scene.shapes.push_back(shape(parallelogram({-2, 0, -2}, {0, 4, 0}, {0, 0, 4}), 0));
    scene.shapes.push_back(disk({1.0, 2.0, 1.0}, {-0.2, -1.0, -0.6}, 0.3, 1, ColorD(20.0)));
    scene.camera = look_at({4.0, 2.5, 1.0}, VectorD(0.0), 6, 6, 30.0);
    return build_scene(scene);
}

constexpr double global_radius = 0.8;
constexpr double caustic_radius = 0.3;
constexpr int traced_passes = 3;

class CausticMap : public ::testing::Test {
protected:
    CausticMap() {
        for (std::uint64_t pass = 1; pass <= traced_passes; ++pass)
            for (const Photon& photon : trace_photons(scene_, {.paths = 4000}, pass, 1).photons)
                (photon.caustic ? caustic_ : global_).push_back(photon);
    }

    /// Gathered layer of photonmapper with these settings.
    std::vector<Color> gathered(MethodSettings method) const {
        method.integrator = "photonmapper";
        method.area = AreaMode::Disc;  // as the sums here divide
        method.photons_per_pass = 4000;
        return *render(scene_, hit_points_, method, {.passes = traced_passes}).image.find(gathered_layer);
    }

    /// What `sum(point)` brings, divided and weighted as the layer is. One hit point a pixel.
    template <typename Sum>
    void expect_layer(const std::vector<Color>& layer, Sum&& sum) const {
        double mean = 0.0;
        for (const HitPoint& point : hit_points_.points) {
            const ColorD expected = sum(point) * (scene_.total_power / (4000.0 * traced_passes));
            EXPECT_NEAR(layer[point.pixel].x, expected.x, 1e-5 * expected.x);
            mean += expected.x;
        }
        EXPECT_GT(mean, 0.0);
    }

    const Scene scene_ = room_with_a_mirror();
    const HitPoints hit_points_ = trace_hit_points(scene_, 1, 1);
    std::vector<Photon> global_;
    std::vector<Photon> caustic_;
};

TEST_F(CausticMap, HasPhotonsInBothMapsHere) {
    EXPECT_GT(global_.size(), 500u);
    EXPECT_GT(caustic_.size(), 500u);
}

TEST_F(CausticMap, IsSearchedWithItsOwnRadius) {
    const PhotonMap global(global_);
    const PhotonMap caustic(caustic_);
    const auto within = [&](const PhotonMap& map, const HitPoint& point, double radius) {
        const double r = radius / scene_.unit_length;
        FluxSum sum(scene_, point, -1);
        map.within(point.position, point.normal, r, [&](const Photon& photon, double) { sum.add(photon, 1.0); });
        return sum.flux() / (pi * r * r);
    };
    expect_layer(gathered({.radius = global_radius, .caustic_radius = caustic_radius}), [&](const HitPoint& point) {
        return within(global, point, global_radius) + within(caustic, point, caustic_radius);
    });
}

TEST_F(CausticMap, DensityIsThatOfBothMapsEachInItsOwnDisc) {
    const PhotonMap global(global_);
    const PhotonMap caustic(caustic_);
    PassLoop loop(scene_, hit_points_,
                  {{.method = {.integrator = "photonmapper",
                               .radius = global_radius,
                               .caustic_radius = caustic_radius,
                               .area = AreaMode::Disc,
                               .photons_per_pass = 4000}}});
    for (std::uint64_t pass = 1; pass <= traced_passes; ++pass) loop.take(pass);
    const Image image = loop.image();
    double caustic_share = 0.0;
    for (std::size_t i = 0; i < hit_points_.points.size(); ++i) {
        const HitPoint& point = hit_points_.points[i];
        const auto density = [&](const PhotonMap& map, double radius) {
            FluxSum sum(scene_, point, -1);
            map.within(point.position, point.normal, radius / scene_.unit_length,
                       [&](const Photon& photon, double) { sum.add(photon, 1.0); });
            return static_cast<double>(sum.count()) / (pi * radius * radius);
        };
        const double of_caustic = density(caustic, caustic_radius);
        const double expected = density(global, global_radius) + of_caustic;
        EXPECT_NEAR(loop.integrator(0).gather_state(i)->density.value(), expected, 1e-9 * expected) << i;
        caustic_share = std::max(caustic_share, of_caustic / std::max(expected, 1e-300));
    }
    EXPECT_GT(caustic_share, 0.5) << "some point has a caustic";
}

TEST_F(CausticMap, TakesTheGlobalRadiusUnlessItHasItsOwn) {
    EXPECT_EQ(gathered({.radius = global_radius}),
              gathered({.radius = global_radius, .caustic_radius = global_radius}));
}

TEST_F(CausticMap, SearchesItsOwnNumberOfPhotons) {
    const PhotonMap global(global_);
    const PhotonMap caustic(caustic_);
    const auto nearest = [&](const PhotonMap& map, const HitPoint& point, std::size_t k) {
        FluxSum sum(scene_, point, -1);
        const NearestPhotons found = map.nearest(point.position, point.normal, k, global_radius / scene_.unit_length,
                                                 [&](const Photon& photon, double, double) { sum.add(photon, 1.0); });
        return sum.flux() / (pi * found.squared_radius);
    };
    expect_layer(gathered({.mode = GatherMode::Nearest,
                           .k = 60,
                           .max_radius = global_radius,
                           .caustic_k = 15,
                           .caustic_max_radius = global_radius}),
                 [&](const HitPoint& point) { return nearest(global, point, 60) + nearest(caustic, point, 15); });
}

}  // namespace
}  // namespace photonlab::test
