// The gather layer with photons where no scene would put them: all in one point, all on one line, fewer than are asked
// for, one a million times as bright as the rest. Every answer is a sum that can be written down.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "integrators/density_estimate.h"
#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"

namespace photonlab::test {
namespace {

const Vector up(0.0f, 0.0f, 1.0f);
constexpr std::size_t million = 1'000'000;

Photon photon_at(const Vector& position, float power) {
    return {.position = position,
            .power = Color(power, 0.5f * power, 0.25f * power),
            .incoming = PackedDirection(up),
            .normal = CoarseDirection(up),
            .edges = 1};
}

/// A floor of 1 x 1 through the origin of the unit box, whose one hit point is in its middle.
SceneDescription floor_description() {
    SceneDescription scene;
    scene.materials = {diffuse(Color(1.0f, 0.5f, 0.25f))};
    scene.shapes = {shape(parallelogram(VectorD(-0.5, -0.5, 0.0), VectorD(1, 0, 0), VectorD(0, 1, 0)), 0)};
    scene.lights = {point_light(VectorD(0.0, 0.0, 0.3), ColorD(1.0))};
    scene.camera = look_at(VectorD(0.0, 0.0, 1.0), VectorD(0.0));
    return scene;
}

/// What a method makes of these photons at the middle of the floor, as one path's; times what it is divided by.
ColorD radiance_times_power(const MethodSettings& method, std::vector<Photon> photons) {
    const Scene scene = build_scene(floor_description());
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    EXPECT_EQ(hit_points.points.size(), 1u);
    // To what Embree's reciprocals round to, which differ between makers of processors; the photons lie around it.
    const Vector middle = hit_points.points[0].position;
    EXPECT_LT(middle.length(), 1e-7f);
    for (Photon& photon : photons) photon.position += middle;
    PassLoop run = loop_of(method, scene, hit_points);
    PhotonPass pass;
    pass.photons = std::move(photons);
    pass.paths_emitted = 1;
    run.take(1, std::move(pass));
    return mean_of(run.image(), gathered_layer) / scene.total_power;
}

void expect_radiance(const ColorD& found, const ColorD& flux, double squared_radius, double tolerance = 1e-6) {
    const ColorD expected = flux * ColorD(1.0, 0.5, 0.25) / (pi * pi * squared_radius);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] / expected[c], 1.0, tolerance) << "channel " << c;
}

MethodSettings within(const std::string& integrator, double radius) {
    return {.integrator = integrator, .radius = radius, .area = AreaMode::Disc, .direct = DirectMode::Photons};
}

MethodSettings nearest(int k, double max_radius) {
    return {.integrator = "photonmapper",
            .mode = GatherMode::Nearest,
            .k = k,
            .max_radius = max_radius,
            .area = AreaMode::Disc,
            .direct = DirectMode::Photons};
}

TEST(GatherExtremes, AMillionPhotonsInOnePointAreAllCounted) {
    const ColorD flux = ColorD(1.0, 0.5, 0.25) * (million * static_cast<double>(0.001f));
    const std::vector<Photon> here(million, photon_at(Vector(0.0f), 0.001f));
    for (const double radius : {1e-6, 2.0})
        expect_radiance(radiance_times_power(within("ppm", radius), here), flux, radius * radius);
    expect_radiance(radiance_times_power(within("photonmapper", 1e-3), here), flux, 1e-6);
    // Beside the hit point, just inside the disc and just outside of it.
    expect_radiance(
        radiance_times_power(within("ppm", 1e-3),
                             std::vector<Photon>(million, photon_at(Vector(0.999e-3f, 0.0f, 0.0f), 0.001f))),
        flux, 1e-6);
    EXPECT_EQ(radiance_times_power(within("ppm", 1e-3),
                                   std::vector<Photon>(million, photon_at(Vector(1.001e-3f, 0.0f, 0.0f), 0.001f))),
              ColorD(0.0));
}

// The k nearest of a million photons that are equally far: any k - 1 of them, over the disc on whose rim they lie.
TEST(GatherExtremes, TheNearestOfAMillionPhotonsInOnePointAreOverTheDiscThatTheySpan) {
    const std::vector<Photon> photons(million, photon_at(Vector(0.25f, 0.0f, 0.0f), 1.0f));
    for (const int k : {2, 100, 5000})
        expect_radiance(radiance_times_power(nearest(k, 1.0), photons), ColorD(1.0, 0.5, 0.25) * (k - 1.0), 0.0625);
}

TEST(GatherExtremes, AMillionPhotonsOnOneLineAreCountedByLength) {
    // At (i + 1/2) / million - 1/2: a radius that is a multiple of the step holds exactly 2 radius / step.
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < million; ++i)
        photons.push_back(
            photon_at(Vector(static_cast<float>((static_cast<double>(i) + 0.5) / million - 0.5), 0.0f, 0.0f), 1.0f));
    std::reverse(photons.begin(), photons.end());
    for (const double radius : {1e-4, 1e-3, 0.25, 3.0})
        expect_radiance(radiance_times_power(within("ppm", radius), photons),
                        ColorD(1.0, 0.5, 0.25) * std::min(1.0, 2.0 * radius) * million, radius * radius);
    // Two photons at each distance: the k-th, k even, is k / 2 - 1/2 steps away. Positions are off by 3e-8.
    for (const int k : {100, 5000}) {
        const double distance = (0.5 * k - 0.5) / million;
        expect_radiance(radiance_times_power(nearest(k, 1.0), photons), ColorD(1.0, 0.5, 0.25) * (k - 1.0),
                        distance * distance, 4e-8 / distance);
    }
}

TEST(GatherExtremes, WhereKIsLargerThanTheMapAllPhotonsAreOverTheLargestDisc) {
    for (const std::size_t count : {1u, 2u, 99u}) {
        std::vector<Photon> photons;
        for (std::size_t i = 0; i < count; ++i)
            photons.push_back(photon_at(Vector(0.001f * static_cast<float>(i + 1), 0.0f, 0.0f), 1.0f));
        for (const int k : {100, 1'000'000, 2'147'483'647})
            expect_radiance(radiance_times_power(nearest(k, 0.3), photons),
                            ColorD(1.0, 0.5, 0.25) * static_cast<double>(count), 0.09);
        if (count >= 2)  // as many as there are: the last sets the radius and carries nothing
            expect_radiance(radiance_times_power(nearest(static_cast<int>(count), 0.3), photons),
                            ColorD(1.0, 0.5, 0.25) * (static_cast<double>(count) - 1.0),
                            1e-6 * static_cast<double>(count * count));
    }
}

// A float's sum of these would lose a photon in two, or all of them after the bright one.
TEST(GatherExtremes, OnePhotonAMillionTimesAsBrightLosesNoneOfTheOthers) {
    for (const bool bright_first : {false, true}) {
        std::vector<Photon> photons(million, photon_at(Vector(0.01f, 0.0f, 0.0f), 1e-3f));
        photons.push_back(photon_at(Vector(0.02f, 0.0f, 0.0f), 1e3f));
        if (bright_first) std::swap(photons.front(), photons.back());
        const double sum = million * static_cast<double>(1e-3f) + 1e3;
        for (const std::string integrator : {"ppm", "photonmapper"})
            expect_radiance(radiance_times_power(within(integrator, 0.1), photons), ColorD(1.0, 0.5, 0.25) * sum, 0.01,
                            1e-6);
    }
}

TEST(GatherExtremes, AFloatSumWouldLoseHalfOfThirtyMillionPhotons) {
    const Scene scene = build_scene(floor_description());
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    FluxSum sum(scene, hit_points.points[0], -1);
    float in_float = 0.0f;
    const Photon photon = photon_at(Vector(0.0f), 1.0f);
    constexpr std::uint64_t photons = 30'000'000;
    for (std::uint64_t i = 0; i < photons; ++i) {
        sum.add(photon, 1.0);
        in_float += photon.power.x;
    }
    EXPECT_EQ(sum.count(), photons);
    EXPECT_NEAR(sum.flux().x * pi, static_cast<double>(photons), 1e-6 * photons);
    EXPECT_EQ(in_float, 0x1p24f);
}

// The smallest radius that there can be is the shrinking one's floor, 1e-18, whose square float still holds: a radius
// below finds what one of 1e-18 finds, and no division is by 0.
TEST(GatherExtremes, ARadiusWhoseSquareUnderflowsFindsWhatIsInThePoint) {
    const PhotonMap map({photon_at(Vector(0.0f), 1.0f), photon_at(Vector(1e-17f, 0.0f, 0.0f), 1.0f)});
    for (const double radius : {1e-18, 1e-24, 1e-160, 1e-200, 1e-300, 0.0}) {
        int found = 0;
        map.within(Vector(0.0f), up, radius, [&](const Photon&, double) { ++found; });
        EXPECT_EQ(found, 1) << radius;
    }
    // An update that would shrink below keeps to the floor.
    constexpr double floor = PhotonMap::minimum_radius * PhotonMap::minimum_radius;
    const auto rule = make_radius_rule({.alpha = 1e-6}, 1);
    GatherStatistics statistics{.squared_radius = 1e-30};
    for (std::uint64_t pass = 1; pass <= 1000; ++pass)
        take_pass(statistics, *rule, 0, {.pass = pass, .passes = pass, .found = 1e9}, floor);
    EXPECT_EQ(statistics.squared_radius, floor);
}

}  // namespace
}  // namespace photonlab::test
