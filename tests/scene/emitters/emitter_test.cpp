// Lights against closed forms and against each other: what sample_direct draws, what direct_density says of it, and
// what light leaves in sample_emission must be three views of the same light.
//
// Statistical claims: each chi-square fails by chance with probability 1e-4 (chi_square.h), each mean within 4.5
// standard errors with 7e-6; the file as a whole with less than 1e-3. Seeds are fixed.

#include "scene/emitter.h"

#include <gtest/gtest.h>

#include "core/sampling.h"
#include "tests/scene/described.h"
#include "tests/support/chi_square.h"

namespace photonlab {
namespace {

constexpr double standard_errors = 4.5;

std::optional<DirectSample> draw_direct(const Scene& scene, const Vector& receiver, RandomStream& random) {
    const Imath::V2f u = random.next_2d();
    return sample_direct(scene, 0, receiver, u, random.next_double());
}

EmissionSample draw_emission(const Scene& scene, std::uint32_t emitter, RandomStream& random) {
    const Imath::V2f u = random.next_2d();
    const double u_triangle = random.next_double();
    return sample_emission(scene, emitter, u, u_triangle, random.next_2d());
}

TEST(Emitters, PowersAndChoicesFollowAreaAndRadianceAndNotTheirScale) {
    for (const double c : {1.0, 0x1p-100, 3.0}) {
        const Scene scene =
            build_scene(describe({floor_of_eight(), shape(SphereDescription{{0, 0, 2}, 0.5, false}, ColorD(2.0 * c))},
                                 {{{0, 0, 3}, ColorD(5.0 * c), "test:2"}}));
        ASSERT_EQ(scene.emitters.size(), 2u);
        const double sphere = 4.0 * pi * pi * 0.25 * 2.0;
        const double point = 4.0 * pi * 5.0;
        const double scale = scene.unit_length * scene.unit_length / c;
        EXPECT_NEAR(scene.emitters[0].power.x * scale, sphere, 1e-5 * sphere);
        EXPECT_NEAR(scene.emitters[1].power.x * scale, point, 1e-12 * point);
        EXPECT_NEAR(scene.emitters[0].choice_probability, sphere / (sphere + point), 1e-6);
        EXPECT_EQ(choose_emitter(scene, 0.0), 0u);
        EXPECT_EQ(choose_emitter(scene, std::nextafter(1.0, 0.0)), 1u);
    }
}

/// Mean and standard error of irradiance at `receiver` (normal +z) by sample_direct.
std::pair<double, double> irradiance(const Scene& scene, const Vector& receiver, int samples) {
    RandomStream random = stream_of_scenes();
    double sum = 0.0, squares = 0.0;
    for (int i = 0; i < samples; ++i) {
        const auto light = draw_direct(scene, receiver, random);
        const double value = light ? light->radiance.x * std::max(0.0f, light->direction.z) / light->density : 0.0;
        sum += value;
        squares += value * value;
    }
    const double mean = sum / samples;
    return {mean, std::sqrt(std::max(0.0, squares / samples - mean * mean) / samples)};
}

TEST(SampleDirect, ADiscLightOnTheAxisGivesItsClosedForm) {
    for (const double height : {0.1, 1.0, 5.0}) {
        const Scene scene = build_scene(
            describe({floor_of_eight(), shape(DiskDescription{{0, 0, height}, {0, 0, -1}, 0.7}, ColorD(3.0))}));
        const auto [mean, error] = irradiance(scene, to_box(scene, {0, 0, 0}), 400'000);
        EXPECT_NEAR(mean, pi * 3.0 * 0.49 / (0.49 + height * height), standard_errors * error + 1e-6) << height;
    }
}

TEST(SampleDirect, ASphereLightGivesItsClosedFormAtEveryInclination) {
    for (const double slope : {0.0, 0.5, 0.8})
        for (const double radius : {0.5, 0.01, 1e-4}) {
            const double distance = 2.0;
            const VectorD centre(distance * slope, 0, distance * std::sqrt(1.0 - slope * slope));
            const Scene scene =
                build_scene(describe({floor_of_eight(), shape(SphereDescription{centre, radius, false}, ColorD(3.0))}));
            const auto [mean, error] = irradiance(scene, to_box(scene, {0, 0, 0}), 20'000);
            const double exact = pi * 3.0 * (radius / distance) * (radius / distance) * std::sqrt(1.0 - slope * slope);
            EXPECT_NEAR(mean, exact, standard_errors * error + 1e-4 * exact) << slope << " " << radius;
        }
}

TEST(SampleDirect, APointLightFallsWithTheSquareOfTheDistanceInSceneUnits) {
    const Scene scene = build_scene(describe({floor_of_eight()}, {{{0, 0, 3}, ColorD(5.0, 6.0, 7.0), "test:2"}}));
    const auto light = sample_direct(scene, 0, to_box(scene, {4, 0, 0}), {0.5f, 0.5f}, 0.5);
    ASSERT_TRUE(light);
    EXPECT_TRUE(light->is_delta);
    EXPECT_EQ(light->density, 1.0);
    EXPECT_NEAR(light->radiance.y, 6.0 / 25.0, 1e-6);
    EXPECT_LT((light->direction - Vector(-0.8f, 0, 0.6f)).length(), 1e-6f);
    EXPECT_FALSE(sample_direct(scene, 0, light->position, {0.5f, 0.5f}, 0.5)) << "a receiver at the light itself";
}

TEST(SampleDirect, IsEmptyBehindALightThatIsFlat) {
    for (const Geometry& geometry :
         {Geometry(square({0, 0, 2}, {1, 0, 0}, {0, 1, 0})), Geometry(DiskDescription{{0, 0, 2}, {0, 0, 1}, 1.0})}) {
        const Scene scene = build_scene(describe({floor_of_eight(), shape(geometry, ColorD(1.0))}));
        const Vector receiver = to_box(scene, {0, 0, 0});
        RandomStream random = stream_of_scenes();
        for (int i = 0; i < 100; ++i) EXPECT_FALSE(draw_direct(scene, receiver, random));
        const auto hit = intersect(scene, {offset_from_surface(receiver, {0, 0, 1}, {0, 0, 1}), {0, 0, 1}});
        EXPECT_EQ(direct_density(scene, receiver, {0, 0, 1}, *hit), 0.0);
        EXPECT_TRUE(is_black(emitted_radiance(scene, *hit, {0, 0, -1})));
        EXPECT_FALSE(is_black(emitted_radiance(scene, *hit, {0, 0, 1})));
    }
}

TEST(SampleDirect, IsEmptyInsideASphereThatShinesOutwardsAndNotInOneThatShinesInwards) {
    for (const bool inwards : {false, true}) {
        const Scene scene = build_scene(describe({shape(SphereDescription{{0, 0, 0}, 1.0, inwards}, ColorD(1.0))}));
        RandomStream random = stream_of_scenes();
        for (int i = 0; i < 100; ++i) EXPECT_EQ(draw_direct(scene, {0.2f, 0.1f, 0}, random).has_value(), inwards);
    }
}

TEST(SampleDirect, FillsTheConeOfASphereUniformlyInSolidAngle) {
    for (const double radius : {1.5, 0.4, 1e-3}) {
        const double distance = 2.0;
        const Scene scene = build_scene(
            describe({floor_of_eight(), shape(SphereDescription{{0, 0, distance}, radius, false}, ColorD(1.0))}));
        const Vector receiver = to_box(scene, {0, 0, 0});
        const double sine = radius / distance;
        const double one_minus_cos_max = sine * sine / (1.0 + std::sqrt(1.0 - sine * sine));
        RandomStream random = stream_of_scenes();
        expect_distributed(
            [&] {
                const VectorD d(draw_direct(scene, receiver, random)->direction);
                const double sine_squared = d.x * d.x + d.y * d.y;
                return std::pair<double, double>(
                    sine_squared / (1.0 + std::sqrt(1.0 - sine_squared)) / one_minus_cos_max, std::atan2(d.y, d.x));
            },
            [](double, double) { return 1.0 / (2.0 * pi); }, 0.0, 1.0 + 1e-3, -pi - 1e-6, pi + 1e-6, 100'000);
    }
}

TEST(SampleDirect, StretchesSolidAngleByTheInverseOfItsDensity) {
    for (const Geometry& geometry : {Geometry(SphereDescription{{0.3, 0, 2}, 1.0, false}),
                                     Geometry(DiskDescription{{0.3, 0, 2}, {0, 0.6, -0.8}, 0.8}),
                                     Geometry(square({0.3, 0, 2}, {0, 1, 0}, {1, 0, 0}))}) {
        const Scene scene = build_scene(describe({floor_of_eight(), shape(geometry, ColorD(1.0))}));
        const Vector receiver = to_box(scene, {0, 0, 0});
        // Of a mesh's two triangles the first is drawn here: half the area, so half the density of the whole.
        const double share = std::holds_alternative<MeshDescription>(geometry) ? 0.5 : 1.0;
        const float h = 2e-3f;
        for (const Imath::V2f& u : {Imath::V2f(0.2f, 0.3f), Imath::V2f(0.7f, 0.4f), Imath::V2f(0.6f, 0.9f)}) {
            const auto at = [&](float x, float y) {
                return VectorD(sample_direct(scene, 0, receiver, {x, y}, 0.25)->direction);
            };
            const VectorD along_x = (at(u.x + h, u.y) - at(u.x - h, u.y)) / (2.0 * h);
            const VectorD along_y = (at(u.x, u.y + h) - at(u.x, u.y - h)) / (2.0 * h);
            const double density = sample_direct(scene, 0, receiver, u, 0.25)->density;
            EXPECT_NEAR(along_x.cross(along_y).length() * density / share, 1.0, 0.01);
        }
    }
}

/// A light that wholly faces a receiver at (0, 0, 0), with a cone around its centre that holds it.
struct FacingLight {
    Geometry geometry;
    VectorD centre;
    double one_minus_cos;
};

std::vector<FacingLight> facing_lights() {
    return {{square({0.3, 0, 2}, {0, 1, 0}, {1, 0, 0}), {0.3, 0, 2}, 0.25},
            {DiskDescription{{0.3, 0, 2}, {0, 0.6, -0.8}, 0.8}, {0.3, 0, 2}, 0.12},
            {SphereDescription{{0.3, 0, 2}, 1.0, false}, {0.3, 0, 2}, 0.2},
            {SphereDescription{{0.3, 0, 2}, 0.05, false}, {0.3, 0, 2}, 5e-4},
            {SphereDescription{{0.3, 0.1, 0.2}, 1.0, true}, {0.3, 0.1, 0.2}, 2.0}};
}

TEST(SampleDirect, DirectDensityAgreesWithWhatWasDrawn) {
    for (const FacingLight& light : facing_lights()) {
        const Scene scene = build_scene(describe({shape(light.geometry, ColorD(1.0)), floor_of_eight()}));
        const Vector receiver = to_box(scene, {0, 0, 0});
        RandomStream random = stream_of_scenes();
        int missed = 0;
        for (int i = 0; i < 10'000; ++i) {
            const auto drawn = draw_direct(scene, receiver, random);
            ASSERT_TRUE(drawn);
            if (drawn->direction.z <= 0.0f) continue;
            const Vector start = offset_from_surface(receiver, {0, 0, 1}, drawn->direction);
            const auto hit = intersect(scene, {start, drawn->direction});
            if (!hit || hit->shape != 0 || hit->geometric_normal.dot(drawn->direction) > -0.01f) {
                ++missed;  // a direction at the light's very rim
                continue;
            }
            // The ray began a little above the receiver, which matters as the distance to the light over the step.
            EXPECT_NEAR(direct_density(scene, receiver, drawn->direction, *hit) / drawn->density, 1.0, 2e-3);
            EXPECT_FALSE(is_occluded(scene, {start, drawn->position}));
            EXPECT_DOUBLE_EQ(emitted_radiance(scene, *hit, -drawn->direction).x, 1.0);
        }
        EXPECT_LT(missed, 20);
    }
}

TEST(DirectDensity, IntegratesToOneOverDirections) {
    for (const FacingLight& light : facing_lights()) {
        const Scene scene = build_scene(
            describe({shape(light.geometry, ColorD(1.0)), shape(SphereDescription{{9, 9, 9}, 0.1, false})}));
        const Vector receiver = to_box(scene, {0, 0, 0});
        const Frame frame = make_frame((to_box(scene, light.centre) - receiver).normalized());
        RandomStream random = stream_of_scenes();
        const int samples = 100'000;
        double sum = 0.0, squares = 0.0;
        for (int i = 0; i < samples; ++i) {
            const Vector direction =
                frame.to_world(sample_cone(random.next_2d(), static_cast<float>(light.one_minus_cos)));
            const auto hit = intersect(scene, {receiver, direction});
            const double value = hit && hit->shape == 0
                                     ? direct_density(scene, receiver, direction, *hit) * 2.0 * pi * light.one_minus_cos
                                     : 0.0;
            sum += value;
            squares += value * value;
        }
        const double mean = sum / samples;
        const double error = std::sqrt(std::max(0.0, squares / samples - mean * mean) / samples);
        EXPECT_LT(error, 0.01);
        EXPECT_NEAR(mean, 1.0, standard_errors * error);
    }
}

TEST(SampleDirect, ThePointDrawnOnATinySphereIsOnTheReceiversSide) {
    for (const double radius : {1e-2, 1e-5, 1e-7, 1e-8, 1e-9, 1e-12}) {
        const Scene scene = build_scene(
            describe({floor_of_eight(), shape(SphereDescription{{0.3, 0.2, 2}, radius, false}, ColorD(1.0))}));
        const Vector centre = std::get<Sphere>(scene.shapes[1].geometry).centre;
        RandomStream random = stream_of_scenes();
        for (int i = 0; i < 20'000; ++i) {
            const Vector receiver = to_box(scene, {4.0 * random.next(), 4.0 * random.next(), 0});
            const auto light = draw_direct(scene, receiver, random);
            ASSERT_TRUE(light);
            // The point was moved off the sphere by more than a rounding, so its side is sure.
            ASSERT_LT((light->position - centre).dot(light->direction), 0.0f) << radius;
            ASSERT_FALSE(
                is_occluded(scene, {offset_from_surface(receiver, {0, 0, 1}, light->direction), light->position}))
                << radius;
        }
    }
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(SampleEmission, FollowsTheCosineFromEveryShapeAndWeighsOneInTheMean) {
    for (const Geometry& geometry :
         {Geometry(square({0, 0, 0}, {1, 0, 0}, {0, 1, 0})), Geometry(DiskDescription{{0, 0, 0}, {0, 0, 1}, 1.0})}) {
        const Scene scene = build_scene(describe({shape(geometry, ColorD(1.0, 2.0, 6.0))}));
        RandomStream random = stream_of_scenes();
        const Color weight = draw_emission(scene, 0, random).weight;
        EXPECT_NEAR(mean_channel(ColorD(weight)), 1.0, 1e-6);
        EXPECT_NEAR(weight.z / weight.x, 6.0, 1e-5);
        expect_distributed(
            [&] {
                const Vector d = draw_emission(scene, 0, random).ray.direction;
                return std::pair<double, double>(static_cast<double>(d.z) * d.z, std::atan2(d.y, d.x));
            },
            [](double, double) { return 1.0 / (2.0 * pi); }, 0.0, 1.0 + 1e-6, -pi - 1e-6, pi + 1e-6);
    }
}

TEST(SampleEmission, StartsUniformInAreaHoweverTheTrianglesDivideIt) {
    MeshDescription mesh;  // a square cut into triangles of very different size, with some of no size at all
    mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.9, 0.1, 0}, {0.99, 0.01, 0}};
    mesh.triangles = {{0, 0, 1}, {0, 1, 5}, {0, 5, 4}, {1, 2, 4}, {1, 4, 5},
                      {4, 5, 5}, {2, 3, 4}, {0, 4, 3}, {3, 3, 3}};
    const Scene scene = build_scene(describe({shape(mesh, ColorD(1.0))}));
    EXPECT_NEAR(scene.shapes[0].area, 1.0, 1e-6);
    EXPECT_EQ(std::get<TriangleMesh>(scene.shapes[0].geometry).triangle_cdf.back(), 1.0);
    RandomStream random = stream_of_scenes();
    expect_distributed(
        [&] {
            const EmissionSample sample = draw_emission(scene, 0, random);
            EXPECT_GT(sample.ray.direction.z, -1e-6f);
            EXPECT_GT(sample.ray.origin.z, 0.0f);  // moved off its surface
            return std::pair<double, double>(sample.ray.origin.x, sample.ray.origin.y);
        },
        [](double, double) { return 1.0; }, -0.5, 0.5, -0.5, 0.5);
}

TEST(SampleEmission, LeavesASphereToTheSideOfItsNormal) {
    for (const bool inwards : {false, true}) {
        const Scene scene = build_scene(describe({shape(SphereDescription{{0, 0, 0}, 1.0, inwards}, ColorD(1.0))}));
        RandomStream random = stream_of_scenes();
        expect_distributed(
            [&] {
                const Ray ray = draw_emission(scene, 0, random).ray;
                EXPECT_EQ(ray.origin.length() < 0.5f, inwards);
                const double cosine = ray.direction.dot(ray.origin.normalized()) * (inwards ? -1.0 : 1.0);
                EXPECT_GT(cosine, -1e-6);
                return std::pair<double, double>(std::min(1.0, cosine * cosine), ray.origin.z);
            },
            [](double, double) { return 1.0; }, 0.0, 1.0, -0.5 - 1e-5, 0.5 + 1e-5, 100'000);
    }
}

TEST(SampleEmission, OfAPointLightIsUniform) {
    const Scene scene = build_scene(describe({floor_of_eight()}, {{{0, 0, 3}, ColorD(5.0), "test:2"}}));
    RandomStream random = stream_of_scenes();
    expect_distributed(
        [&] {
            const EmissionSample sample = draw_emission(scene, 0, random);
            EXPECT_EQ(sample.ray.origin, to_box(scene, {0, 0, 3}));
            return std::pair<double, double>(sample.ray.direction.z,
                                             std::atan2(sample.ray.direction.y, sample.ray.direction.x));
        },
        [](double, double) { return 1.0 / (4.0 * pi); }, -1.0, 1.0, -pi - 1e-6, pi + 1e-6);
}

/// Four lights of very different power and colour, the second without any.
Scene four_lights(double c) {
    return build_scene(
        describe({floor_of_eight(), shape(SphereDescription{{0, 0, 2}, 0.5, false}, ColorD(2.0, 0.5, 0.0) * c),
                  shape(DiskDescription{{1, 0, 2}, {0, 0, -1}, 0.5}, ColorD(0.0)),
                  shape(square({1, 1, 2}, {0, 0.1, 0}, {0.1, 0, 0}), ColorD(0.0, 3.0, 40.0) * c)},
                 {{{0, 0, 3}, ColorD(0.01) * c, "test:2"}}));
}

TEST(SampleEmission, WeighsOneInTheMeanOverLightsAndGivesEachLightItsPower) {
    const Scene scene = four_lights(1.0);
    ASSERT_EQ(scene.emitters.size(), 3u) << "the light without power is not listed";
    EXPECT_EQ(scene.emitters.back().choice_cdf, 1.0);
    ColorD mean(0.0), power(0.0);
    RandomStream random = stream_of_scenes();
    for (std::uint32_t i = 0; i < 3; ++i) {
        const Emitter& emitter = scene.emitters[i];
        mean += ColorD(draw_emission(scene, i, random).weight) * emitter.choice_probability;
        power += emitter.power;
    }
    EXPECT_NEAR(mean_channel(mean), 1.0, 1e-6);
    for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(mean[channel] * scene.total_power, power[channel], 1e-6 * scene.total_power);
}

TEST(ChooseEmitter, ChoosesByPower) {
    const Scene scene = four_lights(1.0);
    double before = 0.0;
    for (std::uint32_t i = 0; i < 3; ++i) {
        const Emitter& emitter = scene.emitters[i];
        EXPECT_NEAR(emitter.choice_cdf - before, emitter.choice_probability, 1e-15);
        EXPECT_EQ(choose_emitter(scene, before), i);
        EXPECT_EQ(choose_emitter(scene, std::nextafter(emitter.choice_cdf, 0.0)), i);
        before = emitter.choice_cdf;
    }
}

TEST(Emitters, LightTimesAFactorChangesNothingButPowerAndRadiance) {
    const Scene original = four_lights(1.0);
    for (const double c : {0x1p-200, 0x1p60, 3.0, 1e-9}) {
        const Scene scaled = four_lights(c);
        const bool exact = std::exp2(std::round(std::log2(c))) == c;
        const double tolerance = exact ? 0.0 : 1e-14;
        EXPECT_NEAR(scaled.total_power / c / original.total_power, 1.0, tolerance) << c;
        RandomStream random = stream_of_scenes();
        for (std::uint32_t i = 0; i < 3; ++i) {
            const Emitter& a = original.emitters[i];
            const Emitter& b = scaled.emitters[i];
            EXPECT_NEAR(a.choice_probability, b.choice_probability, tolerance) << c;
            EXPECT_NEAR(a.choice_cdf, b.choice_cdf, tolerance) << c;
            const Imath::V2f u = random.next_2d();
            const Imath::V2f v = random.next_2d();
            const EmissionSample from_a = sample_emission(original, i, u, 0.3, v);
            const EmissionSample from_b = sample_emission(scaled, i, u, 0.3, v);
            EXPECT_EQ(from_a.ray.origin, from_b.ray.origin);
            EXPECT_EQ(from_a.ray.direction, from_b.ray.direction);
            for (int channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(from_a.weight[channel], from_b.weight[channel],
                            exact ? 0.0f : 4e-7f * from_a.weight[channel])
                    << c;
            const auto direct_a = sample_direct(original, i, {0, 0, 0}, u, 0.3);
            const auto direct_b = sample_direct(scaled, i, {0, 0, 0}, u, 0.3);
            ASSERT_EQ(direct_a.has_value(), direct_b.has_value());
            if (!direct_a) continue;
            EXPECT_EQ(direct_a->direction, direct_b->direction);
            EXPECT_EQ(direct_a->density, direct_b->density);
            EXPECT_NEAR(direct_b->radiance.y / c, direct_a->radiance.y, tolerance * 100.0) << c;
        }
    }
}

TEST(Emitters, LightsWhosePowerUnderflowsAreNotListed) {
    const Scene scene = build_scene(
        describe({shape(square({0, 0, 0}, {4e10, 0, 0}, {0, 4e10, 0}))}, {{{0, 0, 0}, ColorD(1e-310), "test:2"}}));
    EXPECT_TRUE(scene.emitters.empty());
    EXPECT_EQ(scene.total_power, 0.0);
}

}  // namespace
}  // namespace photonlab
