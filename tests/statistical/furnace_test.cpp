// The furnace: inside a closed surface that emits radiance Le and reflects the share rho, every ray sees Le / (1 -
// rho), and with at most K reflections Le (1 - rho^(K+1)) / (1 - rho), wherever it points and whatever the shape. A
// sphere with its analytic surface and a cube of rectangles are tried: the cube has corners, and its lights are chosen
// among six.

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

const Color furnace_colour(0.2f, 0.5f, 0.75f);
const ColorD wall_radiance(1.0, 3.0, 2.0);
constexpr double furnace_radius = 0.15;

/// Radiance of the orders of reflection from `first` to `last`; last = -1 is all.
double furnace_radiance_of_orders(int c, int first, int last) {
    const double rho = furnace_colour[c];
    const double beyond = last < 0 ? 0.0 : std::pow(rho, last + 1);
    return wall_radiance[c] * (std::pow(rho, first) - beyond) / (1.0 - rho);
}

struct Furnace {
    std::string name;
    Scene scene;
    double share_found;  ///< of photons that a gather of furnace_radius accepts: integrating_sphere_test.cpp says why
};

std::vector<Furnace> furnaces() {
    std::vector<Furnace> result;
    result.push_back({"sphere", build_scene(hollow_sphere(furnace_colour, wall_radiance)),
                      1.0 - furnace_radius * furnace_radius / (8.0 * sphere_radius * sphere_radius)});
    result.push_back({"cube", build_scene(hollow_cube(furnace_colour, wall_radiance)), 1.0});
    return result;
}

TEST(Furnace, EveryMethodSeesTheExactRadiance) {
    ClaimFamily claims;
    for (const Furnace& furnace : furnaces()) {
        const HitPoints hit_points = trace_hit_points(furnace.scene, 1, 1);
        for (const std::string integrator : {"path", "ppm", "photonmapper"})
            for (const DirectMode direct : {DirectMode::Sampled, DirectMode::Photons})
                for (const int reflections : {-1, 0, 1, 2, 4}) {
                    if (integrator == "path" && direct == DirectMode::Photons) continue;
                    if (integrator == "photonmapper" && reflections > 1) continue;
                    if (integrator == "ppm" && reflections == 2) continue;
                    const MethodSettings method{.integrator = integrator,
                                                .radius = furnace_radius,
                                                .direct = direct,
                                                .direct_samples = 16,
                                                .max_depth = reflections < 0 ? -1 : reflections + 1,
                                                .photons_per_pass = 2000};
                    std::vector<double> direct_values[3];
                    std::vector<double> gathered_values[3];
                    for (std::uint64_t seed = 1; seed <= 24; ++seed) {
                        const Rendering result = render(furnace.scene, hit_points, method,
                                                        {.passes = integrator == "path" ? 24u : 4u, .seed = seed});
                        const ColorD emission = mean_of(result.image, emission_layer);
                        for (int c = 0; c < 3; ++c) {
                            EXPECT_NEAR(emission[c], wall_radiance[c], 1e-6);
                            direct_values[c].push_back(mean_of(result.image, direct_layer)[c]);
                            gathered_values[c].push_back(mean_of(result.image, gathered_layer)[c]);
                        }
                    }
                    const int first_gathered = direct == DirectMode::Photons ? 1 : 2;
                    const std::string what = furnace.name + " " + integrator + ", direct " + name_of(direct) +
                                             ", at most " + std::to_string(reflections) + ", ";
                    for (int c = 0; c < 3; ++c) {
                        if (direct == DirectMode::Photons || reflections == 0)
                            EXPECT_EQ(SampleMean(direct_values[c]).mean, 0.0) << what;
                        else
                            claims.mean_is(what + "direct", direct_values[c], furnace_radiance_of_orders(c, 1, 1),
                                           0.01);
                        if (reflections >= 0 && reflections < first_gathered)
                            EXPECT_EQ(SampleMean(gathered_values[c]).mean, 0.0) << what;
                        else
                            claims.mean_is(what + "gathered", gathered_values[c],
                                           furnace_radiance_of_orders(c, first_gathered, reflections) *
                                               (integrator == "path" ? 1.0 : furnace.share_found),
                                           0.02);
                    }
                }
    }
}

}  // namespace
}  // namespace photonlab::test
