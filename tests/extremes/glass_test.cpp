// Glass at the ends of what it can be: no glass at all, hardly any, the densest; light along its surface and at the
// critical angle; glass that touches glass; the camera inside. Lossless glass in uniform light is invisible from
// outside and n^2 times as bright from inside, whatever its shape (docs/theory.md, section 5).

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "scene/narrow_gaps.h"
#include "tests/extremes/foot_of_light.h"
#include "tests/statistical/rendering.h"

namespace photonlab::test {
namespace {

Material glass(float inside, float outside = 1.0f) {
    return {.id = "glass", .bsdf = Dielectric{.index_here = outside, .index_beyond = inside}};
}

constexpr double light = 2.0;

/// Uniform light from all sides; what is in it is the caller's.
SceneDescription uniform_surround() {
    SceneDescription scene;
    scene.materials = {diffuse(Color(0.0f))};
    scene.shapes = {sphere(VectorD(0.0), 4.0, true, 0, ColorD(light))};
    return scene;
}

/// A cube of edge 2 around `centre`, normals outwards.
void add_cube(SceneDescription& scene, const VectorD& centre, std::size_t material) {
    const VectorD axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            const VectorD first = axes[(axis + 1) % 3] * 2.0;
            const VectorD second = axes[(axis + 2) % 3] * 2.0;
            const VectorD corner = centre + axes[axis] * side - first * 0.5 - second * 0.5;
            scene.shapes.push_back(shape(
                side > 0.0 ? parallelogram(corner, first, second) : parallelogram(corner, second, first), material));
        }
}

/// Light seen by each pixel, relative to the surround's, and what was cut.
struct Seen {
    double least;
    double mean;
    double most;
    double cut;
};

Seen seen_in(const SceneDescription& description) {
    const HitPoints hit_points = trace_hit_points(build_scene(description), 1, 1);
    EXPECT_EQ(hit_points.nonfinite, 0u);
    Seen seen{1e300, 0.0, 0.0, hit_points.weight_cut};
    const std::vector<ColorD> image = emission_image(hit_points, -1);
    for (const ColorD& pixel : image) {
        seen.least = std::min(seen.least, pixel.x / light);
        seen.most = std::max(seen.most, pixel.x / light);
        seen.mean += pixel.x / light / static_cast<double>(image.size());
    }
    return seen;
}

/// Nothing is seen but for what was cut: in air it counts once, in glass for up to n^2 times as much.
void expect_invisible(const Seen& seen, double index, const std::string& what) {
    EXPECT_LE(seen.most, 1.0 + 1e-5) << what;
    EXPECT_GE(1.0 - seen.mean, seen.cut - 1e-5) << what;
    EXPECT_LE(1.0 - seen.mean, index * index * seen.cut + 1e-5) << what;
}

TEST(IndexOfRefraction, FromOneToFourLeavesGlassInvisibleInUniformLight) {
    for (const double index : {1.0, 1.0 + 1e-7, 1.0001, 1.5, 2.4, 4.0, 0.25}) {
        SceneDescription ball = uniform_surround();
        ball.materials.push_back(glass(static_cast<float>(index)));
        ball.shapes.push_back(sphere(VectorD(0.1, 0.0, 0.0), 1.2, false, 1));
        ball.camera = look_at(VectorD(0.2, 0.5, -3.0), VectorD(0.0), 24, 24, 40.0);
        SceneDescription cube = uniform_surround();
        cube.materials.push_back(glass(static_cast<float>(index)));
        add_cube(cube, VectorD(0.0), 1);
        cube.camera = look_at(VectorD(1.0, 1.4, -2.9), VectorD(0.0), 24, 24, 40.0);
        for (const SceneDescription& scene : {ball, cube}) {
            const Seen seen = seen_in(scene);
            const std::string what = "index " + std::to_string(index);
            expect_invisible(seen, std::max(1.0, index), what);
            if (std::abs(index - 1.0) < 1e-6) {
                EXPECT_NEAR(seen.least, 1.0, 1e-5) << what;
                EXPECT_NEAR(seen.most, 1.0, 1e-5) << what;
            }
            // Measured: 0.01% at 1.5, 0.1% at 2.4, 1% at 4: what branches below 1e-4 would still have brought.
            EXPECT_GT(seen.mean, index < 2.0 ? 0.999 : index < 3.0 ? 0.997 : 0.98) << what;
        }
    }
}

TEST(IndexOfRefraction, OfOneChangesNoPhoton) {
    for (const float index : {1.0f, 1.0f + 1e-7f}) {
        SceneDescription scene = FootOfLight{}.description();
        const PhotonPass without = trace_photons(build_scene(scene), {.paths = 20'000, .store_direct = true}, 1, 1);
        scene.materials.push_back(glass(index));
        add_cube(scene, VectorD(0.0), 2);
        for (std::size_t i = 3; i < scene.shapes.size(); ++i)
            for (VectorD& position : std::get<MeshDescription>(scene.shapes[i].geometry).positions)
                position = position * 0.05 + VectorD(0.0, -0.12, 0.0);
        const PhotonPass with = trace_photons(build_scene(scene), {.paths = 20'000, .store_direct = true}, 1, 1);
        double power = 0.0;
        for (const Photon& photon : without.photons) power += photon.power.x;
        ASSERT_GT(power, 1000.0);
        double power_with = 0.0;
        std::size_t through = 0;
        for (const Photon& photon : with.photons) {
            power_with += photon.power.x;
            through += photon.caustic;
        }
        EXPECT_GT(through, 500u);
        // Survival of at most 0.99 at each of two surfaces takes 2% of the photons and makes the rest as much stronger.
        EXPECT_NEAR(power_with, power, 0.02 * power) << index;
    }
}

TEST(CriticalAngle, IsRightToOneUlpOnBothSides) {
    for (const float index : {1.0f + 1e-6f, 1.33f, 1.5f, 2.4f, 4.0f}) {
        const Dielectric from_inside{.index_here = index, .index_beyond = 1.0f};
        const long double eta = index;
        const auto critical = static_cast<float>(std::sqrt(1.0L - 1.0L / (eta * eta)));
        float cosine = critical;
        for (int step = 0; step < 3; ++step) cosine = std::nextafter(cosine, 0.0f);
        for (int step = -3; step <= 3; ++step, cosine = std::nextafter(cosine, 1.0f)) {
            const long double z = cosine;
            const long double squared_beyond = 1.0L - eta * eta * (1.0L - z * z);
            const long double beyond = squared_beyond > 0.0L ? std::sqrt(squared_beyond) : 0.0L;
            const long double perpendicular = (eta * z - beyond) / (eta * z + beyond);
            const long double parallel = (z - eta * beyond) / (z + eta * beyond);
            const double reflected = static_cast<double>(0.5L * (perpendicular * perpendicular + parallel * parallel));
            const Vector outgoing(std::sqrt(1.0f - cosine * cosine), 0.0f, cosine);
            const SpecularBranches branches = from_inside.branches(outgoing, Carried::Flux);
            ASSERT_EQ(branches.count, squared_beyond > 0.0L ? 2 : 1) << index << ", step " << step;
            EXPECT_NEAR(branches.branch[0].weight.x, reflected, 1e-6);
            if (branches.count == 1) continue;
            EXPECT_NEAR(branches.branch[0].weight.x + branches.branch[1].weight.x, 1.0, 1e-6);
            EXPECT_NEAR(branches.branch[1].incoming.length(), 1.0, 1e-6);
            EXPECT_NEAR(branches.branch[1].incoming.z, -static_cast<double>(beyond), 1e-6);
            EXPECT_LT(branches.branch[1].incoming.z, 0.0f);
        }
        // And in double, as Fresnel's formula is asked: at one ulp the far cosine is of the order of 1e-8.
        const auto exact = static_cast<double>(std::sqrt(1.0L - 1.0L / (eta * eta)));
        double near = exact;
        for (int step = 0; step < 2; ++step) near = std::nextafter(near, 0.0);
        for (int step = -2; step <= 2; ++step, near = std::nextafter(near, 1.0)) {
            const FresnelDielectric fresnel = fresnel_dielectric(near, index);
            EXPECT_GE(fresnel.reflected, 1.0 - 1e-3 * (index < 1.1f) - 1e-6) << index << ", step " << step;
            EXPECT_LE(fresnel.reflected, 1.0);
            EXPECT_GE(fresnel.cos_beyond, 0.0);
            EXPECT_LE(fresnel.cos_beyond, 2e-7);
        }
        EXPECT_EQ(fresnel_dielectric(exact * (1.0 - 1e-9), index).cos_beyond, 0.0);
        EXPECT_GT(fresnel_dielectric(exact * (1.0 + 1e-9), index).cos_beyond, 0.0);
    }
}

// At cosine c -> 0 glass reflects 1 - c (2 + 2 n^2) / sqrt(n^2 - 1) to first order.
TEST(GrazingIncidence, ReflectsAllButItsFirstOrder) {
    for (const double index : {1.1, 1.5, 4.0})
        for (const double cosine : {1e-3, 1e-6, 1e-12, 1e-20, 1e-38}) {
            const double lost = 2.0 * cosine * (1.0 + index * index) / std::sqrt(index * index - 1.0);
            const FresnelDielectric fresnel = fresnel_dielectric(cosine, 1.0 / index);
            EXPECT_NEAR(1.0 - fresnel.reflected, lost, 20.0 * lost * lost + 1e-15) << index << " " << cosine;
            const Dielectric surface{.index_here = 1.0f, .index_beyond = static_cast<float>(index)};
            const auto z = static_cast<float>(cosine);
            const SpecularBranches branches = surface.branches(Vector(1.0f, 0.0f, z), Carried::Flux);
            ASSERT_EQ(branches.count, 2);
            EXPECT_NEAR(branches.branch[0].weight.x + branches.branch[1].weight.x, 1.0, 1e-6);
            EXPECT_EQ(branches.branch[0].incoming.z, z);
        }
}

// A point light at height h over a floor, seen at distance s: E = I h / (h^2 + s^2)^(3/2). Heights that float holds
// exactly; else 3e-8 of the scene would be 3e-4 of the lowest.
TEST(GrazingIncidence, OfLightOnAFloorHasItsCosine) {
    const double distance = 0.25;
    for (const int exponent : {-3, -8, -13, -16}) {
        const double height = std::ldexp(1.0, exponent);
        FootOfLight scene{.height = height, .floor_radius = 0.45};
        SceneDescription description = scene.description();
        std::get<PointLightDescription>(description.lights[0]).position.x = distance;
        const Scene built = build_scene(description);
        const Image image = render(built, {.max_depth = 2, .photons_per_pass = 1}, {.passes = 1}).image;
        const double expected = 3.0 * height / std::pow(height * height + distance * distance, 1.5) * 0.5 / pi;
        EXPECT_NEAR(mean_of(image, direct_layer).x / expected, 1.0, 1e-3) << height;
    }
}

TEST(GrazingIncidence, OfTheViewChangesNothing) {
    SceneDescription description = FootOfLight{}.description();
    const MethodSettings method{.radius = 0.1, .photons_per_pass = 5000};
    const Scene steep = build_scene(description);
    const Image expected = render(steep, method, {.passes = 2}).image;
    for (const double elevation : {1e-1, 1e-2, 1e-3}) {
        description.camera = look_at(VectorD(0.12, -0.25 + 0.12 * elevation, 0.0), VectorD(0.0, -0.25, 0.0));
        const Image image = render(build_scene(description), method, {.passes = 2}).image;
        EXPECT_NEAR(mean_of(image, direct_layer).x / mean_of(expected, direct_layer).x, 1.0, 1e-5) << elevation;
        EXPECT_NEAR(mean_of(image, gathered_layer).x, mean_of(expected, gathered_layer).x, 1e-3) << elevation;
    }
}

// Glass on water: one interface between them, which has an index on either side.
TEST(TouchingDielectrics, ThatShareTheirInterfaceAreInvisible) {
    SceneDescription scene = uniform_surround();
    scene.materials.push_back(glass(1.5f));
    scene.materials.push_back(glass(1.33f));
    scene.materials.push_back(glass(1.33f, 1.5f));  // from glass (the side of the normal) to water
    const auto level = [&](double y, bool faces_up, std::size_t material) {
        const VectorD corner(-2.5, y, -2.5);
        const VectorD x(5, 0, 0);
        const VectorD z(0, 0, 5);
        scene.shapes.push_back(shape(faces_up ? parallelogram(corner, z, x) : parallelogram(corner, x, z), material));
    };
    level(0.5, true, 1);
    level(0.0, true, 3);
    level(-0.5, false, 2);
    scene.camera = look_at(VectorD(0.0, 2.5, 0.3), VectorD(0.0), 8, 8, 20.0);
    const Seen seen = seen_in(scene);
    expect_invisible(seen, 1.5, "glass on water");
    EXPECT_GT(seen.least, 0.999);
    EXPECT_EQ(find_narrow_gaps(build_scene(scene)).found, 0u);
}

SceneDescription two_balls(double gap, const VectorD& camera, double fov) {
    SceneDescription scene = uniform_surround();
    scene.materials.push_back(glass(1.5f));
    for (const double side : {-1.0, 1.0})
        scene.shapes.push_back(sphere(VectorD(side * (0.7 + 0.5 * gap), 0.0, 0.0), 0.7, false, 1));
    scene.camera = look_at(camera, VectorD(0.0), 24, 24, fov);
    return scene;
}

// Across, through both, and along their axis, where a whole cone of paths is focused at the contact.
TEST(TouchingDielectrics, ThatAreAHundredThousandthOfTheSceneApartAreInvisible) {
    const double gap = 1e-5 * 8.0;
    expect_invisible(seen_in(two_balls(gap, VectorD(0.3, 0.4, -3.0), 4.0)), 1.5, "across");
    expect_invisible(seen_in(two_balls(gap, VectorD(-2.8, 0.9, 0.4), 20.0)), 1.5, "through both");
    expect_invisible(seen_in(two_balls(gap, VectorD(-3.0, 0.0, 0.0), 20.0)), 1.5, "along");
}

// Where the gap is below 2e-6 of the scene, what leaves one ball begins inside the other and misses its face: between
// balls of radius R that is within sqrt(2e-6 R) of the point of contact, 4e-4 of the scene here. Measured, such a path
// brings 4% too much, or n^2 times too much along the very axis. Hardly any goes there: one pixel of 576, by a weak
// reflection.
TEST(TouchingDielectrics, ThatMeetInAPointAreInvisibleButThere) {
    expect_invisible(seen_in(two_balls(0.0, VectorD(0.3, 0.4, -3.0), 4.0)), 1.5, "across");
    const Seen through = seen_in(two_balls(0.0, VectorD(-2.8, 0.9, 0.4), 20.0));
    EXPECT_LT(through.most, 1.0015);
    EXPECT_GE(1.0 - through.mean, through.cut - 1e-5);
    EXPECT_LE(1.0 - through.mean, 2.25 * through.cut + 1e-5);
    EXPECT_EQ(find_narrow_gaps(build_scene(two_balls(0.0, VectorD(0.0, 0.0, -3.0), 20.0))).found, 0u);
}

// Two faces in one plane cannot be told apart by a ray; info says so. They are to be modelled as one.
TEST(TouchingDielectrics, ThatHaveTwoFacesInOnePlaneAreFound) {
    SceneDescription scene = uniform_surround();
    scene.materials.push_back(glass(1.5f));
    add_cube(scene, VectorD(-1.0, 0.0, 0.0), 1);
    add_cube(scene, VectorD(1.0, 0.0, 0.0), 1);
    EXPECT_GE(find_narrow_gaps(build_scene(scene)).found, 8u);
}

TEST(CameraInsideGlass, SeesTheSquareOfTheIndexTimesTheLight) {
    for (const double index : {1.0, 1.0 + 1e-7, 1.33, 1.5, 4.0}) {
        SceneDescription scene = uniform_surround();
        scene.materials.push_back(glass(static_cast<float>(index)));
        scene.shapes.push_back(sphere(VectorD(0.0), 1.2, false, 1));
        // So near the centre that no direction is reflected totally.
        scene.camera = look_at(VectorD(0.05, 0.02, 0.0), VectorD(0.3, 0.1, 1.0), 16, 16, 100.0);
        const Seen seen = seen_in(scene);
        const double square = index * index;
        EXPECT_LE(seen.most / square, 1.0 + 1e-5) << index;
        EXPECT_NEAR(seen.mean / square + seen.cut, 1.0, 1e-3) << index;
        EXPECT_GT(seen.least / square, 0.999) << index;
    }
}

// Inside a slab over a lit floor, looking straight down: (1 - R) n^2 of its radiance comes straight, and R^2 of that
// again with each reflection at the slab's faces: n^2 / (1 + R) in all.
TEST(CameraInsideGlass, SeesAFloorThroughTheSlabItIsIn) {
    SceneDescription scene = FootOfLight{.height = 0.1}.description();
    std::get<PointLightDescription>(scene.lights[0]).position += VectorD(0.05, 0.0, 0.0);
    scene.materials.push_back(glass(1.5f));
    const VectorD x(0.8, 0, 0);
    const VectorD z(0, 0, 0.8);
    scene.shapes.push_back(shape(parallelogram(VectorD(-0.4, 0.1, -0.4), z, x), 2));
    scene.shapes.push_back(shape(parallelogram(VectorD(-0.4, -0.1, -0.4), x, z), 2));
    scene.camera = look_at(VectorD(0.0), VectorD(0.0, -1.0, 0.0));
    const MethodSettings method{.max_depth = -1, .photons_per_pass = 1};
    const Image image = render(build_scene(scene), method, {.passes = 1}).image;
    const double squared = 0.1 * 0.1 + 0.05 * 0.05;
    const double floor = 3.0 * 0.1 / std::pow(squared, 1.5) * 0.5 / pi;
    EXPECT_NEAR(mean_of(image, direct_layer).x / (floor * 2.25 / 1.04), 1.0, 3e-4);
}

}  // namespace
}  // namespace photonlab::test
