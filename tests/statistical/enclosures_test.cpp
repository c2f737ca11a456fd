// Two diffuse surfaces that light each other, of different albedo: radiosity in closed form. Unlike in a furnace each
// surface has an answer of its own, so light that lands on the wrong one shows.

#include <gtest/gtest.h>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

const Color first_colour(0.5f, 0.3f, 0.7f);
const Color second_colour(0.8f, 0.6f, 0.4f);
const ColorD first_exitance(2.0, 5.0, 3.0);

/// Claims the mean image of each method against `radiance` (one a channel), `share_found` of what photons bring.
void expect_radiance(ClaimFamily& claims, const std::string& what, const SceneDescription& description,
                     const ColorD& radiance, double gather_radius, double share_found, std::uint64_t photons,
                     DirectMode progressive_direct) {
    const Scene scene = build_scene(description);
    struct Method {
        std::string name;
        MethodSettings settings;
        std::uint64_t passes;
    };
    const Method methods[] = {
        {"path", {.integrator = "path"}, 1500},
        {"ppm",
         {.alpha = 0.9,
          .radius = gather_radius,
          .direct = progressive_direct,
          .direct_samples = 20,
          .photons_per_pass = photons},
         10},
        {"photonmapper, direct by photons",
         {.integrator = "photonmapper",
          .radius = gather_radius,
          .direct = DirectMode::Photons,
          .photons_per_pass = photons},
         10},
    };
    for (const Method& method : methods) {
        std::vector<double> values[3];
        ColorD expected = radiance;
        for (std::uint64_t seed = 1; seed <= 24; ++seed) {
            const Rendering result = render(scene, method.settings, {.passes = method.passes, .seed = seed});
            const ColorD emission = mean_of(result.image, emission_layer);
            const ColorD reflected = mean_of(result.image, direct_layer) + mean_of(result.image, gathered_layer);
            for (int c = 0; c < 3; ++c) values[c].push_back(reflected[c]);
            expected = radiance - emission;
        }
        for (int c = 0; c < 3; ++c)
            claims.mean_is(what + ", " + method.name + ", channel " + std::to_string(c), values[c],
                           expected[c] * (method.settings.integrator == "path" ? 1.0 : share_found), 0.02);
    }
}

// Discs of radius 100 times their gap stand for infinite planes. A hop across the gap is longer than s with probability
// g^2 / (g^2 + s^2), 1e-4 at the rim; light that counts here makes three hops on average, so some 3e-4 of it is
// missing: far below the 1% that is resolved.
TEST(ParallelPlanes, HaveTheRadiosityOfInfinitePlanes) {
    constexpr double gap = 0.5;
    SceneDescription description;
    description.materials = {diffuse(first_colour), diffuse(second_colour)};
    description.shapes = {disk(VectorD(0.0), VectorD(0, 1, 0), 100.0 * gap, 0, first_exitance / pi),
                          disk(VectorD(0.0, gap, 0.0), VectorD(0, -1, 0), 100.0 * gap, 1)};
    ColorD first;
    ColorD second;
    for (int c = 0; c < 3; ++c) {
        first[c] = first_exitance[c] / (1.0 - static_cast<double>(first_colour[c]) * second_colour[c]) / pi;
        second[c] = second_colour[c] * first[c];
    }
    // A point drawn on so wide a lamp is nearly always far: shadow rays are left out, photons and the path tracer's own
    // directions find what they would.
    ClaimFamily claims;
    description.camera = look_at(VectorD(0.6, 0.5 * gap, 0.3), VectorD(0.0));
    expect_radiance(claims, "the emitting plane", description, first, 10.0 * gap, 1.0, 3000, DirectMode::Photons);
    description.camera = look_at(VectorD(0.6, 0.5 * gap, 0.3), VectorD(0.0, gap, 0.0));
    expect_radiance(claims, "the other plane", description, second, 10.0 * gap, 1.0, 3000, DirectMode::Photons);
}

// Form factors of concentric spheres: F12 = 1, F21 = A1 / A2, F22 = 1 - F21. Each sphere is uniform by symmetry.
TEST(ConcentricSpheres, HaveTheRadiosityOfATwoSurfaceEnclosure) {
    constexpr double inner_radius = 1.2;
    constexpr double outer_radius = 2.0;
    constexpr double gather_radius = 0.3;
    SceneDescription description;
    description.materials = {diffuse(first_colour), diffuse(second_colour)};
    description.shapes = {sphere(VectorD(0.0), inner_radius, false, 0, first_exitance / pi),
                          sphere(VectorD(0.0), outer_radius, true, 1)};
    const double from_outer = inner_radius * inner_radius / (outer_radius * outer_radius);  // F21
    ColorD inner;
    ColorD outer;
    for (int c = 0; c < 3; ++c) {
        const double rho1 = first_colour[c];
        const double rho2 = second_colour[c];
        // B1 = M + rho1 B2;  B2 = rho2 (F21 B1 + F22 B2)
        outer[c] = rho2 * from_outer * first_exitance[c] / (1.0 - rho2 * (from_outer * rho1 + 1.0 - from_outer)) / pi;
        inner[c] = first_exitance[c] / pi + rho1 * outer[c];
    }
    ClaimFamily claims;
    // On the convex sphere a photon at distance d has its horizon turned by as much as its normal, so d^2 / (4 R1^2) of
    // the light comes from below the gather point's: r^2 / (8 R1^2) of it over the disc. On the hollow one what comes
    // from itself loses less than r^2 / (8 R2^2), 0.3%: below what is resolved.
    const double refused = gather_radius * gather_radius / (8.0 * inner_radius * inner_radius);
    description.camera = look_at(VectorD(0.0, 1.5, 0.3), VectorD(0.0));
    expect_radiance(claims, "the inner sphere", description, inner, gather_radius, 1.0 - refused, 5000,
                    DirectMode::Sampled);
    description.camera = look_at(VectorD(0.0, 1.5, 0.3), VectorD(0.4, 2.0, 0.5));
    expect_radiance(claims, "the outer sphere", description, outer, gather_radius, 1.0, 5000, DirectMode::Sampled);
}

}  // namespace
}  // namespace photonlab::test
