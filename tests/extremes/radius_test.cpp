// Initial radii from 10^-6 of the scene to ten times it, and passes of a single photon, against the light of a point
// over a plane. Whatever radii progressive photon mapping takes, a pass's own estimate has the closed form of its
// radius, so the image's expectation is the mean of that over the radii that it took.

#include <gtest/gtest.h>

#include <string>

#include "core/error.h"
#include "tests/extremes/foot_of_light.h"
#include "tests/statistical/rendering.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

/// Claims that every seed's image is what the closed form says of its radii.
void expect_closed_form(ClaimFamily& claims, const std::string& what, const FootOfLight& light, bool of_triangles,
                        const MethodSettings& method, std::uint64_t passes, double largest_error) {
    const Scene scene = build_scene(light.description(of_triangles));
    ASSERT_NEAR(scene.unit_length, 1.0, 1e-12) << "the radii are meant as shares of the scene";
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    ASSERT_EQ(hit_points.points.size(), 1u);
    std::vector<double> values[3];
    std::vector<double> expected[3];
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
        const Rendering result = render(scene, hit_points, method, {.passes = passes, .seed = seed});
        for (int c = 0; c < 3; ++c) {
            values[c].push_back(mean_of(result.image, gathered_layer)[c]);
            expected[c].push_back(mean_over(result.radii, [&](double radius) { return light.radiance(radius)[c]; }));
        }
    }
    for (int c = 0; c < 3; ++c)
        claims.means_are(what + ", channel " + std::to_string(c), values[c], expected[c], largest_error);
}

MethodSettings photons_of(const std::string& integrator, double radius, std::uint64_t photons) {
    return {.integrator = integrator, .radius = radius, .direct = DirectMode::Photons, .photons_per_pass = photons};
}

// The light is eight radii above the floor, so that many photons land in the disc; heights and levels are powers of
// two, which float holds exactly.
TEST(InitialRadius, OfAMillionthOfTheSceneToAQuarterIsRight) {
    ClaimFamily claims;
    for (const int exponent : {-20, -17, -10, -5}) {
        const double radius = std::ldexp(1.0, exponent);
        const FootOfLight light{.height = 8.0 * radius};
        for (const std::string integrator : {"ppm", "photonmapper"})
            for (const bool of_triangles : {false, true})
                expect_closed_form(claims, integrator + ", radius 2^" + std::to_string(exponent), light, of_triangles,
                                   photons_of(integrator, radius, 10'000), 8, 0.02);
    }
}

TEST(InitialRadius, LargerThanTheSceneIsRight) {
    ClaimFamily claims;
    for (const double radius : {0.2, 0.9, 10.0, 1e6})
        for (const std::string integrator : {"ppm", "photonmapper"}) {
            MethodSettings method = photons_of(integrator, radius, 2000);
            method.area = AreaMode::Disc;  // of which most lies beyond the floor
            method.alpha = 1.0;  // or the disc of the second pass would be a smaller one, and the fourth on the floor
            expect_closed_form(claims, integrator + ", radius " + std::to_string(radius), {}, false, method, 10, 0.01);
            if (integrator == "ppm" && radius < 1.0) {
                method.alpha = 0.5;
                expect_closed_form(claims, "shrinking", {}, false, method, 10, 0.02);
            }
        }
}

TEST(Passes, OfOnePhotonEachAreRightForEveryAlpha) {
    ClaimFamily claims;
    for (const double alpha : {0.5, 0.7, 1.0 - 1e-9, 1.0})
        for (const ScheduleName schedule : {ScheduleName::Hachisuka, ScheduleName::KnausZwicker}) {
            MethodSettings method = photons_of("ppm", 0.1, 1);
            method.schedule = schedule;
            method.alpha = alpha;
            expect_closed_form(claims, name_of(schedule) + ", alpha " + std::to_string(alpha), {}, false, method, 4000,
                               0.25);
        }
    expect_closed_form(claims, "photonmapper", {}, false, photons_of("photonmapper", 0.1, 1), 4000, 0.05);
}

// After the first pass with photons the disc has a millionth of its area left, so what follows is nearly always empty.
TEST(Alpha, OfAMillionthLeavesAThousandthOfTheRadius) {
    ClaimFamily claims;
    MethodSettings method = photons_of("ppm", 0.1, 2000);
    method.alpha = 1e-6;
    const Scene scene = build_scene(FootOfLight{}.description());
    std::vector<double> first;
    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
        const Rendering result = render(scene, method, {.passes = 2, .seed = seed});
        ASSERT_NEAR(result.radii[1], 1e-3 * result.radii[0], 1e-12);
        // Empty in nearly every seed; what the first pass found is then halved.
        first.push_back(mean_of(result.image, gathered_layer).x);
    }
    claims.mean_is("half of the first pass", first, 0.5 * FootOfLight{}.radiance(0.1).x, 0.03);
}

// The floor gets no photon at all: the light is below it.
TEST(Passes, WithNoPhotonStoredAreBlackAndCount) {
    FootOfLight light;
    light.height = -0.2;
    const Scene scene = build_scene(light.description());
    for (const std::string integrator : {"ppm", "photonmapper"}) {
        const Rendering result = render(scene, photons_of(integrator, 0.1, 100), {.passes = 50});
        EXPECT_EQ(mean_total(result.image), ColorD(0.0));
        EXPECT_EQ(result.report.photons_gathered, 0u);
        EXPECT_EQ(*result.report.radius_mean, 0.1) << "nothing was found, so nothing shrinks";
    }
}

// ---------------------------------------------------------------------------------------------------------------------

// Positions are float: near 1/4 of the box they are 3e-8 apart, so a disc of 10^-7 holds some thirty of them and no
// longer has its area, and one of 10^-10 holds one. Measured: off by 0.2% at 10^-6, 5% at 10^-7.
TEST(Radius, BelowWhatFloatPositionsResolveIsRefused) {
    SceneDescription description = FootOfLight{}.description();
    for (const double unit : {1.0, 1e-6, 1e6}) {
        SceneDescription scaled = description;
        scaled.shapes.resize(1);
        auto& floor = std::get<DiskDescription>(scaled.shapes[0].geometry);
        floor.radius = 0.5 * unit;
        scaled.lights.clear();
        const Scene scene = build_scene(scaled);
        const HitPoints hit_points = trace_hit_points(scene, 1, 1);
        const auto make = [&](const MethodSettings& method) { loop_of(method, scene, hit_points); };
        for (const double share : {9e-8, 1e-12, 1e-18, 1e-200, 2e18, 1e300}) {
            for (const std::string integrator : {"ppm", "photonmapper"}) try {
                    make({.integrator = integrator, .radius = share * unit});
                    FAIL() << share;
                } catch (const InputError& error) {
                    EXPECT_NE(std::string(error.what()).find("radius: expected"), std::string::npos) << error.what();
                    EXPECT_NE(std::string(error.what()).find("of the scene"), std::string::npos) << error.what();
                }
            EXPECT_THROW(make({.integrator = "photonmapper", .mode = GatherMode::Nearest, .max_radius = share * unit}),
                         InputError);
            EXPECT_THROW(make({.integrator = "photonmapper", .caustic_radius = share * unit}), InputError);
            EXPECT_THROW(
                make({.integrator = "photonmapper", .mode = GatherMode::Nearest, .caustic_max_radius = share * unit}),
                InputError);
        }
        for (const double share : {1.1e-7, 1e-6, 1.0, 1e6, 1e17}) EXPECT_NO_THROW(make({.radius = share * unit}));
    }
}

}  // namespace
}  // namespace photonlab::test
