// Light by Sobol's points instead of independent numbers: the same mean under every radius rule, as the program draws
// them, less variance, and why a sequence over all passes is for radii that follow nothing.

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"
#include "tests/support/radius_rules.h"

namespace photonlab::test {
namespace {

constexpr float floor_reflectance = 0.5f;
constexpr double irradiance = 2.0;

/// A floor under parallel light, so many pixels a side of it, away from its rim: the photons' density is the same
/// everywhere, so no blurring changes it, and every radius rule has it exactly in expectation.
Scene evenly_lit_floor(int side) {
    SceneDescription description;
    description.materials = {diffuse(Color(floor_reflectance))};
    description.shapes = {disk(VectorD(0.0), VectorD(0, 1, 0), 4.0, 0)};
    description.lights = {DirectionalDescription{VectorD(0, -1, 0), ColorD(irradiance), "test"}};
    description.camera = look_at(VectorD(0.0, 5.0, 0.0), VectorD(0.0), side, side, 50.0);
    return build_scene(description);
}

/// The point light of the quickest gain: photons carry direct light onto a floor.
Scene floor_under_a_lamp() {
    SceneDescription description;
    description.materials = {diffuse(Color(floor_reflectance))};
    description.shapes = {disk(VectorD(0.0), VectorD(0, 1, 0), 4.0, 0)};
    description.lights = {point_light(VectorD(0.0, 1.5, 0.0), ColorD(1.0))};
    description.camera = look_at(VectorD(0.0, 5.0, 0.1), VectorD(0.0), 8, 8, 30.0);
    return build_scene(description);
}

MethodSettings by_photons(double radius, std::uint64_t photons) {
    return {.light_sequence = LightSequenceMode::Sobol,
            .radius = radius,
            .area = AreaMode::Disc,
            .direct = DirectMode::Photons,
            .photons_per_pass = photons};
}

/// Mean over the picture of the gathered light, a value a seed.
std::vector<double> picture_means(const Scene& scene, const MethodSettings& method, std::uint64_t passes,
                                  std::uint64_t seeds, std::uint64_t first_seed = 1) {
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    std::vector<double> values;
    for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed)
        values.push_back(
            mean_of(render(scene, hit_points, method, {.passes = passes, .seed = seed}).image, gathered_layer).x);
    return values;
}

TEST(LightSequence, HasTheMeanOfEvenLightUnderEveryRadiusRule) {
    const Scene scene = evenly_lit_floor(4);
    ClaimFamily claims;
    for (const NamedMethod& method : methods_by_every_radius_rule(by_photons(0.2, 1000)))
        claims.mean_is(method.name, picture_means(scene, method.settings, 16, 60),
                       static_cast<double>(floor_reflectance) * irradiance / pi, 0.02);
}

// Radii that follow from counts, and photons of the next pass that lie where those of the last did not: both are of one
// sequence, and a disc that shrank because it was full gets fewer than it should.
TEST(LightSequence, OverAllPassesIsBiasedWhereRadiiFollowFromCounts) {
    const Scene scene = evenly_lit_floor(12);
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    const double expected = static_cast<double>(floor_reflectance) * irradiance / pi;
    const auto deviations = [&](EmissionNumbers emission) {
        const MethodSettings method = by_photons(0.2, 1000);
        std::vector<double> values;
        for (std::uint64_t seed = 1; seed <= 200; ++seed) {
            PassLoop loop = loop_of(method, scene, hit_points, {.seed = seed});
            PhotonSettings photons = photon_settings(method, seed);
            photons.emission = emission;
            for (std::uint64_t pass = 1; pass <= 32; ++pass) loop.take(pass, trace_photons(scene, photons, pass, 1));
            values.push_back(mean_of(loop.image(), gathered_layer).x / expected - 1.0);
        }
        return SampleMean(values);
    };
    const SampleMean of_all = deviations(EmissionNumbers::SobolOfAllPasses);
    const SampleMean of_pass = deviations(EmissionNumbers::SobolOfPass);
    EXPECT_GT(std::abs(of_all.mean), 5.0 * std::sqrt(of_all.squared_error)) << of_all.mean;
    EXPECT_LT(std::abs(of_pass.mean), 4.0 * std::sqrt(of_pass.squared_error)) << of_pass.mean;
    RecordProperty("bias_of_all",
                   std::to_string(of_all.mean) + " +- " + std::to_string(std::sqrt(of_all.squared_error)));
    RecordProperty("bias_of_pass",
                   std::to_string(of_pass.mean) + " +- " + std::to_string(std::sqrt(of_pass.squared_error)));
}

// Radii of Knaus and Zwicker are the same for both, so the expectation is too, to the bit; and so is that of photon
// mapping, and of emission that learns.
TEST(LightSequence, HasTheMeanOfIndependentNumbers) {
    const Scene scene = floor_under_a_lamp();
    ClaimFamily claims;
    MethodSettings knaus_zwicker = by_photons(0.3, 1000);
    knaus_zwicker.schedule = ScheduleName::KnausZwicker;
    MethodSettings learning = knaus_zwicker;
    learning.emission = EmissionMode::Adaptive;
    learning.learn_passes = 4;
    MethodSettings mapping = knaus_zwicker;
    mapping.integrator = "photonmapper";
    for (const auto& [name, method] :
         {std::pair{"knaus-zwicker", knaus_zwicker}, {"emission that learns", learning}, {"photonmapper", mapping}}) {
        MethodSettings independent = method;
        independent.light_sequence = LightSequenceMode::Independent;
        claims.means_agree(name, picture_means(scene, method, 16, 60), picture_means(scene, independent, 16, 60, 1000),
                           0.005);
    }
}

/// Variance over seeds, mean over pixels.
double variance_of(const Scene& scene, const MethodSettings& method, std::uint64_t passes) {
    constexpr std::uint64_t seeds = 24;
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    std::vector<double> sums(pixel_count(hit_points), 0.0);
    std::vector<double> squares(sums.size(), 0.0);
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        const Image image = render(scene, hit_points, method, {.passes = passes, .seed = seed}).image;
        for (std::size_t i = 0; i < sums.size(); ++i) {
            const double value = (*image.find(gathered_layer))[i].x;
            sums[i] += value / seeds;
            squares[i] += value * value / seeds;
        }
    }
    double variance = 0.0;
    for (std::size_t i = 0; i < sums.size(); ++i) variance += squares[i] - sums[i] * sums[i];
    return variance / static_cast<double>(sums.size());
}

// 24 seeds and some ten discs that do not overlap: over 200 degrees of freedom, so a ratio of 0.7 beside 1 has a
// probability below 1e-4.
TEST(LightSequence, HasLessVarianceThanIndependentNumbers) {
    const Scene scene = floor_under_a_lamp();
    MethodSettings sobol = by_photons(0.3, 1000);
    sobol.schedule = ScheduleName::KnausZwicker;
    MethodSettings independent = sobol;
    independent.light_sequence = LightSequenceMode::Independent;
    const double ratio_of_all = variance_of(scene, sobol, 32) / variance_of(scene, independent, 32);
    EXPECT_LT(ratio_of_all, 0.4);
    sobol.schedule = independent.schedule = ScheduleName::Hachisuka;
    const double ratio_of_pass = variance_of(scene, sobol, 32) / variance_of(scene, independent, 32);
    EXPECT_LT(ratio_of_pass, 0.8);
    RecordProperty("ratio_of_all", std::to_string(ratio_of_all));
    RecordProperty("ratio_of_pass", std::to_string(ratio_of_pass));
}

// Two lamps, each in a hollow sphere of its own, one three times as bright: of any power of two of paths, a quarter and
// three quarters.
TEST(LightSequence, GivesEachLightItsShareOfThePaths) {
    SceneDescription description;
    description.materials = {diffuse(Color(floor_reflectance), true)};
    description.shapes = {sphere(VectorD(-2.0, 0.0, 0.0), 1.0, true, 0), sphere(VectorD(2.0, 0.0, 0.0), 1.0, true, 0)};
    description.lights = {point_light(VectorD(-2.0, 0.0, 0.0), ColorD(1.0)),
                          point_light(VectorD(2.0, 0.0, 0.0), ColorD(3.0))};
    description.camera = look_at(VectorD(0.0, 5.0, 0.1), VectorD(0.0), 8, 8, 30.0);
    const Scene scene = build_scene(description);
    for (const std::uint64_t paths : {4, 64, 4096}) {
        const PhotonSettings settings{
            .paths = paths, .max_depth = 2, .store_direct = true, .emission = EmissionNumbers::SobolOfAllPasses};
        const PhotonPass pass = trace_photons(scene, settings, 3, 1);
        ASSERT_EQ(pass.photons.size(), paths);
        EXPECT_EQ(std::count_if(pass.photons.begin(), pass.photons.end(),
                                [](const Photon& photon) { return photon.position.x < 0.0f; }),
                  static_cast<std::ptrdiff_t>(paths / 4));
    }
}

// Whichever pass a node begins at, it continues the one sequence.
TEST(LightSequence, IsAFunctionOfPassAndPath) {
    const Scene scene = floor_under_a_lamp();
    PhotonSettings settings{.paths = 700, .store_direct = true, .emission = EmissionNumbers::SobolOfAllPasses};
    const PhotonPass second = trace_photons(scene, settings, 2, 1);
    const PhotonPass by_two_threads = trace_photons(scene, settings, 2, 2);
    settings.paths = 1400;
    const PhotonPass both = trace_photons(scene, settings, 1, 1);
    ASSERT_EQ(second.photons.size(), by_two_threads.photons.size());
    const std::size_t before = both.photons.size() - second.photons.size();
    for (std::size_t i = 0; i < second.photons.size(); ++i) {
        EXPECT_EQ(second.photons[i].position, by_two_threads.photons[i].position);
        EXPECT_EQ(second.photons[i].position, both.photons[before + i].position);
    }
}

}  // namespace
}  // namespace photonlab::test
