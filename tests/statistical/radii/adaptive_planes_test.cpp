// What adaptive radii gain beside those of Knaus and Zwicker on planes whose light is known: below and beside a point
// light, beside a straight edge of light, where light is uniform. Photons are placed by hand; the program's own loop
// gathers them, and all methods share them.
//
// The expected gains are those of adaptive_planes.py beside this file, a simulation of the rule that shares nothing
// with the program. They see a Laplacian, a variance or kappa that is wrong by a factor of two or three, and a
// bandwidth or radii that do not fall; not an exponent that is a little off, nor the smallest radius.

#include <gtest/gtest.h>

#include <array>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/support/laid_photons.h"

namespace photonlab::test {
namespace {

constexpr double albedo = 0.5;
constexpr std::uint64_t photons_per_pass = 2000;
constexpr std::uint64_t runs = 128;
constexpr std::array<std::uint64_t, 3> shown{8, 64, 512};
constexpr std::array<double, 4> first_radii{0.1, 0.2, 0.4, 0.8};  // the point light is at height 1
constexpr double pixel = 0.05;                                    // between neighbours on the floor
constexpr double half_patch = 2.0;                                // where uniform light ends

/// Light on a floor that ends far away.
struct KnownLight {
    std::string name;
    double flux;                             ///< of all photons of a pass, where irradiance() is in units of its own
    VectorD (*place)(RandomStream& random);  ///< of a photon on the floor
    std::vector<double> places;              ///< z of the points that are looked at
    std::vector<double> irradiance;          ///< there
    std::uint64_t stream;                    ///< of its photons
};

VectorD below_point_light(RandomStream& random) {
    const double cosine = 1.0 - random.next_double();
    const double distance = std::min(100.0, std::sqrt(1.0 / (cosine * cosine) - 1.0));
    const double angle = 2.0 * pi * random.next_double();
    return {distance * std::cos(angle), 0.0, distance * std::sin(angle)};
}

VectorD in_patch(RandomStream& random) {
    const double x = half_patch * (2.0 * random.next_double() - 1.0);
    return {x, 0.0, half_patch * (2.0 * random.next_double() - 1.0)};
}

VectorD before_edge(RandomStream& random) {
    const double x = half_patch * (2.0 * random.next_double() - 1.0);
    return {x, 0.0, -half_patch * random.next_double()};
}

std::vector<KnownLight> known_lights() {
    const auto point = [](double s) { return std::pow(1.0 + s * s, -1.5); };
    return {{"point light", 2.0 * pi, below_point_light, {0.0, 0.7, 1.5}, {point(0.0), point(0.7), point(1.5)}, 0},
            {"edge", 2.0 * half_patch * half_patch, before_edge, {-0.05, -0.15}, {1.0, 1.0}, 1},
            {"uniform", 4.0 * half_patch * half_patch, in_patch, {0.0}, {1.0}, 2}};
}

/// A floor seen from straight above in a row of pixels from the first place to the last.
Scene floor_under(const KnownLight& light) {
    const auto [first, last] = std::minmax_element(light.places.begin(), light.places.end());
    const double centre = 0.5 * (*first + *last);
    const int count = static_cast<int>(std::lround((*last - *first) / pixel)) + 1;
    SceneDescription description;
    description.materials = {diffuse(Color(static_cast<float>(albedo)))};
    description.shapes = {disk(VectorD(0.0), VectorD(0, 1, 0), 110.0, 0)};
    description.lights = {point_light(VectorD(0.0, 50.0, 0.0), ColorD(1.0))};
    const double camera_height = 20.0;
    description.camera = look_at(VectorD(0.0, camera_height, centre), VectorD(0.0, 0.0, centre), count, 1,
                                 2.0 * std::atan(0.5 * count * pixel / camera_height) * 180.0 / pi);
    return build_scene(description);
}

PhotonPass photons_of(const KnownLight& light, const Scene& scene, std::uint64_t seed, std::uint64_t pass) {
    RandomStream random(seed, RandomPurpose::Test, pass, light.stream);
    PhotonPass placed{.photons = {}, .paths_emitted = photons_per_pass};
    for (std::uint64_t i = 0; i < photons_per_pass; ++i)
        placed.photons.push_back(photon_on_floor(scene, light.place(random), 2));
    return placed;
}

/// Each first radius by Knaus and Zwicker, then each by adaptive radii.
std::vector<RunSettings> all_runs(std::uint64_t seed) {
    std::vector<RunSettings> settings;
    for (const ScheduleName schedule : {ScheduleName::KnausZwicker, ScheduleName::Adaptive})
        for (const double radius : first_radii)
            settings.push_back(
                {.method = {.schedule = schedule, .alpha = 2.0 / 3.0, .radius = radius, .area = AreaMode::Disc},
                 .seed = seed});
    return settings;
}

/// The pixel that looks at z.
std::size_t pixel_at(const Scene& scene, const HitPoints& points, double z) {
    std::size_t found = 0;
    double nearest = infinity;
    for (std::size_t i = 0; i < points.points.size(); ++i) {
        const double away = std::abs((VectorD(points.points[i].position) * scene.unit_length + scene.centre).z - z);
        if (away < nearest) nearest = away, found = i;
    }
    EXPECT_LT(nearest, 1e-3);
    return found;
}

/// Sums over the cases of log(MSE of adaptive radii / MSE of Knaus and Zwicker's), after each of `shown`.
void add_log_ratios(const KnownLight& light, std::array<double, 3>& sums, int& cases) {
    const Scene scene = floor_under(light);
    const HitPoints points = trace_hit_points(scene, 1, 1);
    std::vector<std::size_t> pixels;
    for (const double z : light.places) pixels.push_back(pixel_at(scene, points, z));
    // Radiance of irradiance 1, in the program's units.
    const double unit = albedo / pi * scene.total_power * scene.unit_length * scene.unit_length / light.flux;
    const std::size_t methods = 2 * first_radii.size();
    std::vector<double> errors(shown.size() * methods * pixels.size(), 0.0);
    for (std::uint64_t seed = 1; seed <= runs; ++seed) {
        PassLoop loop(scene, points, all_runs(seed));
        for (std::uint64_t pass = 1; pass <= shown.back(); ++pass) {
            loop.take(pass, photons_of(light, scene, seed, pass));
            const auto at = static_cast<std::size_t>(std::find(shown.begin(), shown.end(), pass) - shown.begin());
            if (at == shown.size()) continue;
            std::vector<std::size_t> all(methods);
            for (std::size_t method = 0; method < methods; ++method) all[method] = method;
            loop.show(all, [&](std::size_t method, const Image& image) {
                for (std::size_t i = 0; i < pixels.size(); ++i) {
                    const double value = (*image.find(gathered_layer))[pixels[i]].x / unit;
                    errors[(at * methods + method) * pixels.size() + i] += std::pow(value - light.irradiance[i], 2.0);
                }
            });
        }
    }
    for (std::size_t at = 0; at < shown.size(); ++at)
        for (std::size_t radius = 0; radius < first_radii.size(); ++radius)
            for (std::size_t i = 0; i < pixels.size(); ++i) {
                const auto error = [&](std::size_t method) {
                    return errors[(at * methods + method) * pixels.size() + i];
                };
                sums[at] += std::log(error(first_radii.size() + radius) / error(radius));
            }
    cases += static_cast<int>(first_radii.size() * pixels.size());
}

// An MSE of 128 runs is known to an eighth; the mean over 24 cases, whose photons are shared by light, to some 4%, that
// of the simulation likewise.
TEST(AdaptiveRadius, GainsOnPlanesWhatASimulationSays) {
    std::array<double, 3> sums{};
    int cases = 0;
    for (const KnownLight& light : known_lights()) add_log_ratios(light, sums, cases);
    EXPECT_EQ(cases, 24);
    const std::array<double, 3> expected{0.70, 0.54, 0.44};
    for (std::size_t at = 0; at < shown.size(); ++at) {
        const double ratio = std::exp(sums[at] / cases);
        RecordProperty("after_" + std::to_string(shown[at]), std::to_string(ratio));
        EXPECT_NEAR(ratio, expected[at], 0.08 * expected[at]) << shown[at] << " passes";
    }
}

}  // namespace
}  // namespace photonlab::test
