// Paths through mirrors and glass, from the camera and from the lights: what their weights sum to, how they count
// edges, where photons are left, and that what cannot end is ended and counted.
//
// Claims on random walks and photons fail by chance when a mean is more than four standard errors off: 6e-5 each; the
// seeds are fixed.

#include <gtest/gtest.h>

#include <cstring>
#include <functional>

#include "scene/materials/smooth/dielectric.h"
#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/transport/same_photons.h"

namespace photonlab::test {
namespace {

constexpr double glass_index = 1.5;
constexpr double normal_reflectance = 0.04;  // of glass

/// What throughput lost inside glass was worth outside: radiance is 1 / n^2 of itself there, against air.
constexpr double glass_over_air = glass_index * glass_index;

Material glass() {
    return {.id = "glass", .bsdf = Dielectric{}};
}

Material mirror(const Color& reflectance = Color(1.0f)) {
    return {.id = "mirror", .bsdf = Conductor{.reflectance = reflectance}, .two_sided = true};
}

/// A plate of glass between y = 0 and y = 1, and the two diffuse planes of the materials 0 below and 1 above it.
SceneDescription slab_between_planes(double width = 40.0) {
    SceneDescription scene;
    scene.materials = {diffuse(Color(0.5f)), diffuse(Color(0.25f)), glass()};
    scene.shapes = {disk({0, -1, 0}, {0, 1, 0}, width, 0), disk({0, 4, 0}, {0, -1, 0}, width, 1),
                    disk({0, 0, 0}, {0, -1, 0}, width, 2), disk({0, 1, 0}, {0, 1, 0}, width, 2)};
    scene.camera = look_at({0, 3, 0}, {0, 0, 0});
    return scene;
}

/// Sum of the weights of the hit points on one material.
double weight_on(const HitPoints& hit_points, std::uint16_t material) {
    double sum = 0.0;
    for (const HitPoint& point : hit_points.points)
        if (point.material == material) sum += static_cast<double>(point.weight.y);
    return sum;
}

// ---------------------------------------------------------------------------------------------------------------------
// From the camera.

// All internal reflections together let T = (1 - R) / (1 + R) through and reflect 2 R / (1 + R). Inside, throughput is
// 1 / n^2 of that outside, and the third inner reflection, 0.96 x 0.04^3 / 2.25, is the first branch below 1e-4: all
// that is cut is cut in the glass.
TEST(SplitPaths, ThroughASlabSumToItsTransmittance) {
    const Scene scene = build_scene(slab_between_planes());
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    const double transmitted = weight_on(hit_points, 0);
    const double reflected = weight_on(hit_points, 1);
    const double cut = hit_points.weight_cut * glass_over_air;
    EXPECT_NEAR(hit_points.weight_cut, 0.96 * std::pow(normal_reflectance, 3) / glass_over_air, 1e-9);
    EXPECT_NEAR(transmitted + reflected + cut, 1.0, 1e-6);

    const double expected = (1.0 - normal_reflectance) / (1.0 + normal_reflectance);
    EXPECT_NEAR(expected, 0.923077, 1e-6);
    EXPECT_LE(transmitted, expected + 1e-6);
    EXPECT_GE(transmitted, expected - cut - 1e-6);
    EXPECT_LE(reflected, 1.0 - expected + 1e-6);
    EXPECT_GE(reflected, 1.0 - expected - cut - 1e-6);
}

TEST(SplitPaths, CountEveryEdgeAndUnfoldTheirDistance) {
    const Scene scene = build_scene(slab_between_planes());
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    ASSERT_EQ(hit_points.points.size(), 4u);  // reflected, and after no, one and two inner reflections
    for (std::size_t i = 0; i < hit_points.points.size(); ++i) {
        const HitPoint& point = hit_points.points[i];
        const bool below = point.material == 0;
        // Weight tells the order of reflection; edges: to the slab, each crossing of it, and away from it.
        int crossings = 0;
        const double weight = static_cast<double>(point.weight.y);
        if (below || weight < 0.95 * normal_reflectance)
            crossings =
                static_cast<int>(std::lround(std::log(weight / (0.96 * 0.96)) / std::log(normal_reflectance))) + 1;
        EXPECT_EQ(crossings % 2, below ? 1 : 0);
        EXPECT_EQ(point.camera_edges, 2 + crossings);
        const double distance = 2.0 + crossings + (below ? 1.0 : 3.0);
        // At each surface the ray starts 32 roundings off it (offset_from_surface).
        const double off = (crossings + 1) * 2e-6 * scene.unit_length;
        EXPECT_NEAR(hit_points.footprints[i] * scene.unit_length / scene.camera.pixel_angle, distance, off);
    }
}

/// A glass ball and a mirror ball in a closed box whose halves, x < 0 and x > 0, are of the two materials 0 and 1.
SceneDescription balls_in_two_halves(int resolution) {
    SceneDescription scene;
    scene.materials = {diffuse(Color(0.9f, 0.5f, 0.1f)), diffuse(Color(0.1f, 0.3f, 0.8f)), glass(),
                       mirror(Color(0.9f, 0.8f, 0.7f))};
    const auto wall = [&](const VectorD& corner, const VectorD& first, const VectorD& second, std::size_t material) {
        scene.shapes.push_back(shape(parallelogram(corner, first, second), material));
    };
    for (const std::size_t half : {0, 1}) {  // a box of [-3, 3] x [-2, 2] x [-3, 3], cut at x = 0
        const double left = half == 0 ? -3.0 : 0.0;
        const VectorD x(3, 0, 0), y(0, 4, 0), z(0, 0, 6);
        wall({left, -2, -3}, z, x, half);
        wall({left, 2, -3}, x, z, half);
        wall({left, -2, -3}, x, y, half);
        wall({left, -2, 3}, y, x, half);
        if (half == 0)
            wall({-3, -2, -3}, y, z, half);
        else
            wall({3, -2, -3}, z, y, half);
    }
    scene.shapes.push_back(sphere({-0.7, -0.2, 0.5}, 0.9, false, 2));
    scene.shapes.push_back(sphere({1.1, -0.6, 1.2}, 0.7, false, 3));
    scene.camera = look_at({0.2, 0.6, -2.6}, {0.0, -0.3, 0.6}, resolution, resolution, 60.0);
    return scene;
}

// A lossless ball in a closed room: every pixel's weights sum to 1 but for what was cut, which was in air, where it
// counts once, or in glass, where it stood for n^2 times as much.
TEST(SplitPaths, ThroughABallSumToOneButForWhatWasCut) {
    SceneDescription description = balls_in_two_halves(24);
    description.shapes.pop_back();
    const HitPoints hit_points = trace_hit_points(build_scene(description), 1, 1);
    std::vector<double> sum(pixel_count(hit_points), 0.0);
    std::vector<int> count(sum.size(), 0);
    for (const HitPoint& point : hit_points.points) {
        sum[point.pixel] += static_cast<double>(point.weight.y);
        ++count[point.pixel];
    }
    double missing = 0.0;
    int split = 0;
    for (std::size_t pixel = 0; pixel < sum.size(); ++pixel) {
        missing += (1.0 - sum[pixel]) / static_cast<double>(sum.size());
        split += count[pixel] > 1;
        EXPECT_LE(sum[pixel], 1.0 + 1e-6);
        // At worst at grazing incidence: R = 0.99 reflects (1 - R)^2 = 1e-4 out at each inner reflection, all cut.
        EXPECT_GE(sum[pixel], 0.99 - 1e-6);
    }
    EXPECT_GT(split, 30);
    EXPECT_GT(hit_points.weight_cut, 0.0);
    EXPECT_GE(missing, hit_points.weight_cut - 1e-6);
    EXPECT_LE(missing, hit_points.weight_cut * glass_over_air + 1e-6);
}

/// Colour that a walk with chance finds: one branch at each specular surface, no cut-off.
ColorD stochastic_walk(const Scene& scene, Ray ray, RandomStream& random) {
    ColorD throughput(1.0);
    for (int edges = 0; edges < 1000; ++edges) {
        const auto hit = intersect(scene, ray);
        if (!hit) return ColorD(0.0);
        const auto surface = orient(scene, *hit, -ray.direction);
        if (!surface) return ColorD(0.0);
        if (const auto* found = std::get_if<Diffuse>(&surface->bsdf)) return throughput * ColorD(found->reflectance);
        const auto bounce =
            sample(surface->bsdf, surface->frame.to_local(-ray.direction), Carried::Radiance, random.next_2d());
        if (!bounce) return ColorD(0.0);
        throughput *= ColorD(bounce->weight);
        const Vector direction = surface->frame.to_world(bounce->incoming);
        if (!sides_agree(*surface, direction)) return ColorD(0.0);
        ray = {offset_from_surface(surface->position, surface->geometric_normal, direction), direction};
    }
    return ColorD(0.0);
}

TEST(SplitPaths, HaveTheMeanOfAnUnbiasedWalk) {
    constexpr int resolution = 12;
    constexpr int walks = 600;  // a pixel
    const Scene scene = build_scene(balls_in_two_halves(resolution));
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    ColorD expected(0.0);
    for (const HitPoint& point : hit_points.points)
        expected += ColorD(point.weight * std::get<Diffuse>(scene.materials[point.material].bsdf).reflectance) /
                    static_cast<double>(pixel_count(hit_points));
    ColorD sum(0.0);
    ColorD variance(0.0);  // of the mean over all pixels
    for (int pixel = 0; pixel < resolution * resolution; ++pixel) {
        RandomStream random(5, RandomPurpose::Test, 1, static_cast<std::uint64_t>(pixel));
        ColorD mean(0.0);
        ColorD squares(0.0);
        for (int walk = 0; walk < walks; ++walk) {
            const Ray ray{
                scene.camera.position,
                scene.camera.ray(pixel % resolution + 0.5, pixel / resolution + 0.5, Imath::V2f(0.0f)).direction};
            const ColorD value = stochastic_walk(scene, ray, random);
            mean += value / walks;
            squares += value * value / walks;
        }
        sum += mean;
        variance += (squares - mean * mean) / (walks - 1.0);
    }
    constexpr double pixels = resolution * resolution;
    for (int channel = 0; channel < 3; ++channel) {
        const double error = std::sqrt(variance[channel]) / pixels;
        EXPECT_LT(error, 2e-3 * expected[channel]);
        EXPECT_NEAR(sum[channel] / pixels, expected[channel], 4.0 * error + hit_points.weight_cut * glass_over_air);
    }
}

TEST(SplitPaths, SeeALampThroughGlassWithItsDepth) {
    // The ceiling shines; the camera looks up at it through the slab, from below.
    SceneDescription description = slab_between_planes();
    description.shapes[1].radiance = ColorD(2.0);
    description.shapes[1].material = 3;
    description.shapes[0].material = 3;
    description.materials.push_back(diffuse(Color(0.0f)));
    description.camera = look_at({0, -0.5, 0}, {0, 3, 0});
    const HitPoints hit_points = trace_hit_points(build_scene(description), 1, 1);
    // Through both faces: 3 edges; each pair of inner reflections adds 2 edges and a factor R^2.
    const double once = 2.0 * 0.96 * 0.96;
    for (const int max_depth : {1, 2}) EXPECT_EQ(emission_image(hit_points, max_depth)[0], ColorD(0.0));
    for (const int max_depth : {3, 4}) EXPECT_NEAR(emission_image(hit_points, max_depth)[0].x, once, 1e-6);
    for (const int max_depth : {5, 6, -1})
        EXPECT_NEAR(emission_image(hit_points, max_depth)[0].x, once * (1.0 + normal_reflectance * normal_reflectance),
                    1e-6);
}

TEST(SplitPaths, SeeALampInMirrorsWithItsDepth) {
    // Mirrors at y = 0 and y = 1 facing each other; the camera looks across and meets the lamp at x = 5 after two.
    SceneDescription description;
    description.materials = {mirror(Color(0.5f)), diffuse(Color(0.0f))};
    description.shapes = {disk({0, 0, 0}, {0, 1, 0}, 40.0, 0), disk({0, 1, 0}, {0, -1, 0}, 40.0, 0),
                          disk({3, 0.5, 0}, {-1, 0, 0}, 3.0, 1, ColorD(8.0))};
    description.camera = look_at({0, 0.5, 0}, {0.9, 0, 0});  // y = 0 at x = 0.9, y = 1 at x = 2.7, then the lamp
    const HitPoints hit_points = trace_hit_points(build_scene(description), 1, 1);
    for (const int max_depth : {1, 2}) EXPECT_EQ(emission_image(hit_points, max_depth)[0], ColorD(0.0));
    for (const int max_depth : {3, 4, -1}) EXPECT_NEAR(emission_image(hit_points, max_depth)[0].x, 2.0, 1e-6);
}

// ---------------------------------------------------------------------------------------------------------------------
// From the lights.

/// The box with both balls under a lamp.
Scene lit_balls() {
    SceneDescription description = balls_in_two_halves(1);
    description.materials.push_back(diffuse(Color(0.0f)));
    description.shapes.push_back(disk({0.3, 1.9, 0.8}, {0, -1, 0}, 0.6, 4, ColorD(1.0)));
    return build_scene(description);
}

// Mirrors lead back from a photon along its path, up to the last diffuse surface or the lamp.
TEST(SpecularPhotons, AreCausticExactlyAfterSpecularSurfacesAlone) {
    SceneDescription description = balls_in_two_halves(1);
    description.shapes[description.shapes.size() - 2].material = 3;  // both balls are mirrors
    description.materials.push_back(diffuse(Color(0.0f)));
    const VectorD lamp(0.3, 1.9, 0.8);
    description.shapes.push_back(disk(lamp, {0, -1, 0}, 0.6, 4, ColorD(1.0)));
    const Scene scene = build_scene(description);
    const auto lamp_shape = static_cast<std::uint32_t>(description.shapes.size() - 1);
    const PhotonPass pass = trace_photons(scene, {.paths = 20'000, .store_direct = true}, 1, 1);
    int caustic = 0;
    int after_diffuse = 0;
    int untold = 0;  // the way back grazed an edge
    for (const Photon& photon : pass.photons) {
        const Vector incoming = photon.incoming.unit();
        Ray ray{offset_from_surface(photon.position, photon.normal.unit(), incoming), incoming};
        bool only_specular = photon.edges > 1;
        bool told = true;
        for (std::uint32_t edge = 1; edge <= photon.edges && told; ++edge) {
            const auto hit = intersect(scene, ray);
            ASSERT_TRUE(hit);
            if (edge == photon.edges) {
                told = hit->shape == lamp_shape;
                break;
            }
            const auto surface = orient(scene, *hit, -ray.direction);
            if (!surface) {
                told = false;
            } else if (!is_specular(surface->bsdf)) {
                only_specular = false;
                break;
            } else {
                const auto ways =
                    specular_branches(surface->bsdf, surface->frame.to_local(-ray.direction), Carried::Radiance);
                const Vector direction = surface->frame.to_world(ways.branch[0].incoming);
                ray = {offset_from_surface(surface->position, surface->geometric_normal, direction), direction};
            }
        }
        if (!told) {
            ++untold;
            continue;
        }
        EXPECT_EQ(photon.caustic != 0, only_specular) << photon.edges << " edges";
        caustic += photon.caustic;
        after_diffuse += photon.edges > 1 && !photon.caustic;
    }
    EXPECT_GT(caustic, 500);
    EXPECT_GT(after_diffuse, 5000);
    EXPECT_LT(untold, 20);
}

TEST(SpecularPhotons, AreNeverLeftOnMirrorsOrGlass) {
    const Scene scene = lit_balls();
    const PhotonPass pass = trace_photons(scene, {.paths = 20'000, .store_direct = true}, 1, 1);
    ASSERT_GT(pass.photons.size(), 20'000u);
    for (const Photon& photon : pass.photons) {
        const VectorD position = VectorD(photon.position) * scene.unit_length + scene.centre;
        EXPECT_GT(std::abs((position - VectorD(-0.7, -0.2, 0.5)).length() - 0.9), 1e-4);
        EXPECT_GT(std::abs((position - VectorD(1.1, -0.6, 1.2)).length() - 0.7), 1e-4);
    }
}

TEST(SpecularPhotons, OfCausticsAreStoredWhetherDirectLightIsOrNot) {
    const Scene scene = lit_balls();
    const PhotonPass without = trace_photons(scene, {.paths = 5000}, 1, 1);
    PhotonPass with = trace_photons(scene, {.paths = 5000, .store_direct = true}, 1, 1);
    std::uint64_t caustic = 0;
    for (const Photon& photon : without.photons) {
        EXPECT_GT(photon.edges, 1u);
        caustic += photon.caustic;
    }
    EXPECT_GT(caustic, 500u);
    for (const Photon& photon : with.photons) EXPECT_FALSE(photon.caustic && photon.edges == 1);
    EXPECT_GT(std::erase_if(with.photons, [](const Photon& photon) { return photon.edges == 1; }), 2000u);
    EXPECT_TRUE(same_bits(with, without));
}

/// Flux of caustic photons in one channel, relative to that emitted, and its standard error: paths that land at most
/// one caustic photon are independent.
struct Flux {
    double mean = 0.0;
    double error = 0.0;
};

Flux caustic_flux(const PhotonPass& pass, int channel, const std::function<bool(const Photon&)>& counts) {
    double sum = 0.0;
    double squares = 0.0;
    const double paths = static_cast<double>(pass.paths_emitted);
    for (const Photon& photon : pass.photons)
        if (photon.caustic && counts(photon)) {
            const double power = static_cast<double>(photon.power[channel]);
            sum += power;
            squares += power * power;
        }
    const double mean = sum / paths;
    return {mean, std::sqrt((squares / paths - mean * mean) / paths)};
}

bool any_photon(const Photon&) {
    return true;
}

// A point at height h over a mirror lights what is above as its image at -h would.
TEST(SpecularPhotons, OfAPointOverAMirrorComeFromItsImage) {
    constexpr double height = 1.0;
    constexpr double receiver_height = 3.0;
    constexpr double receiver_radius = 4.0;
    SceneDescription description;
    description.materials = {diffuse(Color(0.5f)), mirror(Color(1.0f, 0.5f, 0.25f))};
    description.shapes = {disk({0, receiver_height, 0}, {0, -1, 0}, receiver_radius, 0),
                          disk({0, 0, 0}, {0, 1, 0}, 10.0, 1)};
    description.lights = {point_light({0, height, 0}, ColorD(1.0))};
    const PhotonPass pass = trace_photons(build_scene(description), {.paths = 100'000}, 1, 1);
    const double far = height + receiver_height;
    const double share = 0.5 * (1.0 - far / std::hypot(far, receiver_radius));  // of all directions
    for (int channel = 0; channel < 3; ++channel) {
        const Flux flux = caustic_flux(pass, channel, any_photon);
        EXPECT_LT(flux.error, 0.01 * share);
        EXPECT_NEAR(flux.mean, share * std::pow(0.5, channel), 4.0 * flux.error);
    }
}

// A disc lamp and a disc receiver of radius 1 at right angles, a mirror at 45 degrees between them: the form factor of
// coaxial discs at the unfolded distance.
TEST(SpecularPhotons, OfADiscInAMirrorHaveTheFormFactorOfItsImage) {
    constexpr double distance = 1.2;
    SceneDescription description;
    description.materials = {diffuse(Color(0.5f)), mirror(), diffuse(Color(0.0f))};
    description.shapes = {disk({0, distance, 0}, {0, -1, 0}, 1.0, 0),
                          disk({-distance, 0, 0}, {1, 0, 0}, 1.0, 2, ColorD(1.0)),
                          // The plane y = x; it ends below the receiver's edge.
                          shape(parallelogram({-1.1, -1.1, -9}, {0, 0, 18}, {2.2, 2.2, 0}), 1)};
    const PhotonPass pass = trace_photons(build_scene(description), {.paths = 100'000}, 1, 1);
    const double s = 2.0 + 4.0 * distance * distance;  // 1 + (1 + R^2) / R^2 with R = 1 / (2 distance)
    const double form_factor = 0.5 * (s - std::sqrt(s * s - 4.0));
    const Flux flux = caustic_flux(pass, 1, [](const Photon& photon) { return photon.edges == 2; });
    EXPECT_LT(flux.error, 0.02 * form_factor);
    EXPECT_NEAR(flux.mean, form_factor, 4.0 * flux.error);
}

/// Fresnel's share of unpolarised light for glass from outside, written out.
double fresnel_of_glass(double cosine) {
    const double inside = std::sqrt(1.0 - (1.0 - cosine * cosine) / (glass_index * glass_index));
    const double perpendicular = (cosine - glass_index * inside) / (cosine + glass_index * inside);
    const double parallel = (glass_index * cosine - inside) / (glass_index * cosine + inside);
    return 0.5 * (perpendicular * perpendicular + parallel * parallel);
}

// A slab keeps directions, so each bin of the cosine gets the share of directions in it times the transmittance of all
// inner reflections. The slab and the floor are so wide that light with cosine 0.2 moves sideways by less than them in
// 20 crossings, and there R = 0.39: what leaves at the rim is below 0.39^20.
TEST(SpecularPhotons, ThroughASlabHaveItsTransmittanceAtEveryAngle) {
    SceneDescription description = slab_between_planes(200.0);
    description.shapes.erase(description.shapes.begin() + 1);  // no ceiling
    description.lights = {point_light({0, 2, 0}, ColorD(1.0))};
    const PhotonPass pass = trace_photons(build_scene(description), {.paths = 200'000}, 1, 1);
    constexpr int bins = 8;
    for (int bin = 0; bin < bins; ++bin) {
        const double from = 0.2 + 0.8 * bin / bins;
        const double to = 0.2 + 0.8 * (bin + 1) / bins;
        double expected = 0.0;
        for (int step = 0; step < 100; ++step) {
            const double reflected = fresnel_of_glass(from + (to - from) * (step + 0.5) / 100.0);
            expected += (1.0 - reflected) / (1.0 + reflected) * 0.5 * (to - from) / 100.0;
        }
        const Flux flux = caustic_flux(pass, 0, [&](const Photon& photon) {
            const double cosine = static_cast<double>(photon.incoming.unit().y);
            return cosine >= from && cosine < to;
        });
        EXPECT_LT(flux.error, 0.015 * expected);
        EXPECT_NEAR(flux.mean, expected, 4.0 * flux.error) << "cosine " << from << " to " << to;
    }
    EXPECT_NEAR((1.0 - fresnel_of_glass(1.0)) / (1.0 + fresnel_of_glass(1.0)), 0.923077, 1e-6);
}

// Nothing absorbs between the lamp and the walls of a closed box with a ball of glass: all flux arrives.
TEST(SpecularPhotons, AllArriveThroughLosslessGlass) {
    SceneDescription description = balls_in_two_halves(1);
    description.shapes.pop_back();
    description.lights = {point_light({-0.7, -0.2, 0.8}, ColorD(1.0))};  // inside the ball, off its centre
    const PhotonPass pass = trace_photons(build_scene(description), {.paths = 50'000}, 1, 1);
    const Flux flux = caustic_flux(pass, 1, any_photon);
    EXPECT_LT(flux.error, 0.002);
    EXPECT_NEAR(flux.mean, 1.0, 4.0 * flux.error);
    EXPECT_EQ(pass.paths_cut, 0u);
}

// ---------------------------------------------------------------------------------------------------------------------
// What nothing absorbs.

SceneDescription mirror_box(const Color& reflectance) {
    SceneDescription description = hollow_cube(Color(0.5f), std::nullopt);
    description.materials = {mirror(reflectance)};
    description.camera.width = description.camera.height = 3;
    return description;
}

TEST(CapturedLight, InAPerfectMirrorBoxIsCutAtTheCapAndCounted) {
    const HitPoints hit_points = trace_hit_points(build_scene(mirror_box(Color(1.0f))), 1, 1);
    EXPECT_TRUE(hit_points.points.empty());
    EXPECT_TRUE(hit_points.emission.empty());
    EXPECT_NEAR(hit_points.weight_cut, 1.0, 1e-6);
}

TEST(CapturedLight, InAGreyMirrorBoxIsCutBelowTheSmallestWeight) {
    // 0.5^13 = 1.2e-4 goes on, 0.5^14 does not; the weaker channels are cut with the strongest.
    const HitPoints hit_points = trace_hit_points(build_scene(mirror_box(Color(0.5f, 0.5f, 0.0f))), 4, 1);
    EXPECT_TRUE(hit_points.points.empty());
    EXPECT_NEAR(hit_points.weight_cut, std::pow(0.5, 14) * 2.0 / 3.0, 1e-9);
}

TEST(CapturedLight, IsCutWhereItIsAskedTo) {
    const Scene scene = build_scene(mirror_box(Color(0.5f)));
    for (const int reflections : {1, 3, 20})  // the last that goes on carries just the cut-off
        EXPECT_NEAR(trace_hit_points(scene, 1, 1, std::pow(0.5, reflections)).weight_cut,
                    std::pow(0.5, reflections + 1), 1e-12);
}

TEST(CapturedLight, OfTheCameraInsideABallOfGlassEnds) {
    // Off the centre by more than R / n, so that directions across the radius are reflected totally for ever.
    SceneDescription description;
    description.materials = {glass(), diffuse(Color(0.5f))};
    description.shapes = {sphere({0, 0, 0}, 1.0, false, 0), sphere({0, 0, 0}, 3.0, true, 1)};
    description.camera = look_at({0.9, 0, 0}, {0.9, 0, 1}, 9, 9, 100.0);
    const HitPoints hit_points = trace_hit_points(build_scene(description), 1, 1);
    double weight = 0.0;
    for (const HitPoint& point : hit_points.points) weight += static_cast<double>(point.weight.y) / 81.0;
    EXPECT_GT(hit_points.weight_cut, 0.3);
    EXPECT_LT(hit_points.weight_cut, 0.9);
    // Leaving the glass multiplies by n^2 what was not cut, in glass or (weaker, at most 2% of it) outside.
    EXPECT_NEAR(weight / glass_over_air + hit_points.weight_cut, 1.0, 0.02);
}

TEST(CapturedLight, OfALampInAMirrorBoxOrInGlassEnds) {
    SceneDescription box = mirror_box(Color(1.0f));
    box.lights = {point_light({0.1, 0.2, 0.3}, ColorD(1.0))};
    SceneDescription ball;
    ball.materials = {glass()};
    ball.shapes = {sphere({0, 0, 0}, 1.0, false, 0)};
    ball.lights = {point_light({0.9, 0, 0}, ColorD(1.0))};
    for (const SceneDescription& description : {box, ball}) {
        const PhotonPass pass = trace_photons(build_scene(description), {.paths = 2000}, 1, 1);
        EXPECT_TRUE(pass.photons.empty());
        EXPECT_EQ(pass.paths_emitted, 2000u);
        // Survival of at most 0.99 ends a path long before the cap of 10,000 edges: 0.99^10000 = 2e-44.
        EXPECT_EQ(pass.paths_cut, 0u);
        EXPECT_EQ(pass.power_cut, 0.0);
        EXPECT_EQ(pass.nonfinite, 0u);
    }
}

// A white ball and a small lamp inside a ball of glass hardly larger: light is reflected totally, bounces, and leaves.
TEST(CapturedLight, AmongWhiteSurfacesInGlassEnds) {
    SceneDescription description;
    description.materials = {glass(), diffuse(Color(1.0f)), diffuse(Color(0.0f))};
    description.shapes = {sphere({0, 0, 0}, 2.0, false, 0), sphere({0, 0, 0}, 1.7, false, 1),
                          sphere({0, 0, -1.85}, 0.1, false, 2, ColorD(1.0))};
    description.camera = look_at({0, 0, -5}, {0, 0, 0}, 8, 8, 60.0);
    const Scene scene = build_scene(description);
    const PhotonPass pass = trace_photons(scene, {.paths = 5000, .store_direct = true}, 1, 1);
    EXPECT_GT(pass.photons.size(), 3000u);
    EXPECT_EQ(pass.paths_cut, 0u);
    for (const Photon& photon : pass.photons) EXPECT_TRUE(is_finite(photon.power));
    const Rendering paths = render(scene, {.integrator = "path"}, {.passes = 8});
    EXPECT_GT(mean_of(paths.image, gathered_layer).x, 0.0);
    EXPECT_TRUE(is_finite(mean_total(paths.image)));
}

// ---------------------------------------------------------------------------------------------------------------------
// Depth.

/// A floor beside a mirror under a lamp, both photographed in part through another mirror: layers differ at every
/// depth.
Scene room_of_mirrors() {
    SceneDescription description;
    description.materials = {diffuse(Color(0.7f)), mirror(Color(0.9f)), diffuse(Color(0.0f))};
    description.shapes = {disk({0, 0, 0}, {0, 1, 0}, 6.0, 0),
                          shape(parallelogram({-3, 0, -2}, {6, 0, 0}, {0, 4, 0}), 1),
                          shape(parallelogram({-2, 0, -2}, {0, 4, 0}, {0, 0, 4}), 0),
                          shape(parallelogram({2, 0, -2}, {0, 0, 4}, {0, 4, 0}), 1),
                          disk({0, 3, 0.5}, {0.1, -1, -0.2}, 0.8, 2, ColorD(10.0))};
    description.camera = look_at({0.5, 2.2, 5.0}, {0.2, 0.6, 0.0}, 16, 16, 45.0);
    return build_scene(description);
}

// What a pixel sees with at most D edges is the same for every method. The gather's radius of 0.06 loses light along
// the floor's and wall's edges with the mirrors and with each other: 0.21 r of the light beside each, 12 edges' length
// of some 4 in 30 of area seen, so below 0.21 x 0.06 x 48 / 30 = 2% if everything seen were lit alike; that is allowed
// for.
TEST(Depth, CountsSpecularEdgesAlikeForEveryMethod) {
    const Scene scene = room_of_mirrors();
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    std::vector<ColorD> totals;
    for (const int max_depth : {2, 3, 4}) {
        constexpr int seeds = 12;
        const auto statistics = [&](MethodSettings method, std::uint64_t passes) {
            method.max_depth = max_depth;
            double sum = 0.0;
            double squares = 0.0;
            for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
                const Image image = render(scene, hit_points, method, {.passes = passes, .seed = seed}).image;
                const double value = mean_of(image, direct_layer).x + mean_of(image, gathered_layer).x;
                sum += value;
                squares += value * value;
            }
            const double mean = sum / seeds;
            return Flux{mean, std::sqrt((squares / seeds - mean * mean) / (seeds - 1.0))};
        };
        const Flux path = statistics({.integrator = "path"}, 40);
        EXPECT_LT(path.error, 0.01 * path.mean);
        for (const std::string integrator : {"ppm", "photonmapper"})
            for (const DirectMode direct : {DirectMode::Sampled, DirectMode::Photons}) {
                const Flux photons = statistics({.integrator = integrator,
                                                 .alpha = 1.0,
                                                 .radius = 0.06,
                                                 .direct = direct,
                                                 .direct_samples = 8,
                                                 .photons_per_pass = 6000},
                                                1);
                EXPECT_LT(photons.error, 0.02 * path.mean);
                EXPECT_NEAR(photons.mean, path.mean, 4.0 * std::hypot(photons.error, path.error) + 0.02 * path.mean)
                    << integrator << ", direct " << name_of(direct) << ", max_depth " << max_depth;
            }
        totals.push_back(ColorD(path.mean));
    }
    // Each depth adds more than all that was allowed for, so an edge too many or too few would show.
    EXPECT_GT(totals[1].x, 1.1 * totals[0].x);
    EXPECT_GT(totals[2].x, 1.1 * totals[1].x);
}

}  // namespace
}  // namespace photonlab::test
