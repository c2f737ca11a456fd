// Every radius rule, with fixed and with new hit points, on light that no blurring changes: the expectation of the
// image is exact after any number of passes, with so few photons that most passes of a point are empty (docs/theory.md,
// section 9). Photons are placed by hand on a floor; what gathers them is the program's own loop.

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"
#include "tests/support/laid_photons.h"
#include "tests/support/radius_rules.h"

namespace photonlab::test {
namespace {

constexpr double disc_radius = 0.5;  // initial, scene units
constexpr double half_patch = 12.0;  // photons lie in |x|, |z| < this
constexpr float patch_reflectance = 0.6f;
constexpr int resolution = 8;  // pixels, about two radii apart

/// A floor of 60 x 60 seen from straight above: 8 x 8 pixels over |x|, |z| < 8.
Scene floor_from_above() {
    SceneDescription description;
    description.materials = {diffuse(Color(patch_reflectance))};
    description.shapes = {disk(VectorD(0.0), VectorD(0, 1, 0), 40.0, 0)};
    const double height = 20.0;
    description.camera = look_at(VectorD(0.0, height, 0.0), VectorD(0.0), resolution, resolution,
                                 2.0 * std::atan(8.0 / height) * 180.0 / pi);
    description.lights = {point_light(VectorD(0.0, 50.0, 0.0), ColorD(1.0))};
    return build_scene(description);
}

/// Density of the photons that a path leaves, times the patch's area: 1 + slope x, x in scene units.
struct Density {
    double slope = 0.0;
    double at(double x) const { return 1.0 + slope * x; }
};

/// A pass of `count` paths that leave one photon each, of power 1.
PhotonPass place_photons(const Scene& scene, const Density& density, std::uint64_t count, std::uint64_t seed,
                         std::uint64_t pass) {
    RandomStream random(seed, RandomPurpose::Test, pass, 0);
    PhotonPass placed{.photons = {}, .paths_emitted = count};
    while (placed.photons.size() < count) {
        const double x = half_patch * (2.0 * random.next_double() - 1.0);
        const double z = half_patch * (2.0 * random.next_double() - 1.0);
        const double most = 1.0 + std::abs(density.slope) * half_patch;
        if (random.next_double() * most > density.at(x)) continue;
        placed.photons.push_back(photon_on_floor(scene, {x, 0.0, z}, 2));
    }
    return placed;
}

/// Radiance where the density is 1: patch_reflectance / pi times the flux of all paths over the patch's area, in the
/// units of the program's image.
double unit_radiance(const Scene& scene) {
    const double area = 4.0 * half_patch * half_patch / (scene.unit_length * scene.unit_length);
    return static_cast<double>(patch_reflectance) / pi * scene.total_power / area;
}

std::vector<NamedMethod> all_methods() {
    return methods_by_every_radius_rule({.radius = disc_radius});
}

/// Mean over the image after 1, 3 and 64 passes of many independent runs, each against the light at its own hit points.
void expect_unbiased(const NamedMethod& method, const Density& density, ClaimFamily& claims) {
    const Scene scene = floor_from_above();
    const HitPoints grid = trace_hit_points(scene, 1, 1);
    const Needs needs = needs_of(method.settings);
    // About one photon in the first disc.
    const auto photons = static_cast<std::uint64_t>(4.0 * half_patch * half_patch / (pi * disc_radius * disc_radius));
    constexpr std::uint64_t runs = 40;
    const std::vector<std::uint64_t> shown{1, 3, 64};
    std::vector<std::vector<double>> means(shown.size());
    std::vector<std::vector<double>> expected(shown.size());
    for (std::uint64_t seed = 1; seed <= runs; ++seed) {
        PassLoop loop(scene, grid, {{.method = method.settings, .seed = seed}});
        double lit = 0.0;  // mean density at the hit points, summed over passes
        std::size_t next = 0;
        for (std::uint64_t pass = 1; pass <= shown.back(); ++pass) {
            loop.take(pass, place_photons(scene, density, photons, seed, pass));
            const HitPoints points =
                needs.new_points ? trace_new_hit_points(scene, 1, *needs.new_points, {.seed = seed, .pass = pass}, 1)
                                 : grid;
            for (const HitPoint point : points.points) {
                const double x = (VectorD(point.position) * scene.unit_length + scene.centre).x;
                lit += density.at(x) / static_cast<double>(points.points.size());
            }
            if (pass != shown[next]) continue;
            means[next].push_back(mean_of(loop.image(), gathered_layer).x);
            expected[next++].push_back(unit_radiance(scene) * lit / static_cast<double>(pass));
        }
    }
    for (std::size_t i = 0; i < shown.size(); ++i)
        claims.means_are(method.name + ", " + std::to_string(shown[i]) + " passes", means[i], expected[i], 0.03);
}

// 40 runs of 64 points: standard errors of 2% after one pass (of 3% with kernels that fall off), 0.3% after 64.
TEST(RadiusRules, AreUnbiasedOnUniformLight) {
    ClaimFamily claims;
    for (const NamedMethod& method : all_methods()) expect_unbiased(method, {}, claims);
}

TEST(RadiusRules, AreUnbiasedOnLightThatGrowsAlongTheFloor) {
    ClaimFamily claims;
    for (const NamedMethod& method : all_methods()) expect_unbiased(method, {.slope = 1.0 / 14.0}, claims);
}

// No photon, one photon, all in one place: finite, and what the photon brings.
TEST(RadiusRules, SurviveFewPhotonsAndManyInOnePlace) {
    const Scene scene = floor_from_above();
    const HitPoints grid = trace_hit_points(scene, 1, 1);
    for (const NamedMethod& method : all_methods()) {
        PassLoop loop(scene, grid, {{.method = method.settings, .seed = 1}});
        loop.take(1, PhotonPass{.photons = {}, .paths_emitted = 100});
        EXPECT_EQ(mean_of(loop.image(), gathered_layer).x, 0.0) << method.name;
        PhotonPass one = place_photons(scene, {}, 1, 3, 2);
        one.photons[0].position = grid.points[20].position;
        loop.take(2, one);
        for (std::uint64_t pass = 3; pass <= 40; ++pass) {
            PhotonPass heap{.photons = {}, .paths_emitted = 1000};
            heap.photons.assign(1000, one.photons[0]);
            loop.take(pass, std::move(heap));
        }
        const Image image = loop.image();
        for (const Color& pixel : *image.find(gathered_layer)) EXPECT_TRUE(is_finite(pixel)) << method.name;
        EXPECT_GT(mean_of(image, gathered_layer).x, 0.0) << method.name;
        const IntegratorReport report = loop.state_now(0).report;
        EXPECT_GT(*report.radius_min, 0.0) << method.name;
        EXPECT_LT(*report.radius_max, 200.0) << method.name;
    }
}

}  // namespace
}  // namespace photonlab::test
