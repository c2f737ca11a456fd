// At edges: what photons are divided by (settings `area`), against exact answers that the disc's area misses by far.
// A closed cube that emits and reflects shows one radiance everywhere, its corners included, at any gather radius.
// Photons drawn by hand on a floor that ends have a known density, uniform or with a gradient.

#include <gtest/gtest.h>

#include "integrators/density_estimate.h"
#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

const Color cube_colour(0.5f);
const ColorD cube_radiance(1.0);           // so that what is reflected is as bright
constexpr double cube_radius = 2.0 / 3.0;  // a third of its edge

/// Seen from near one corner towards the opposite one: walls, edges and the corner.
Scene cube_with_corners() {
    SceneDescription cube = hollow_cube(cube_colour, cube_radiance);
    cube.camera = look_at(VectorD(-0.7, -0.8, -0.6), VectorD(0.9, 0.95, 1.0), 6, 6, 70.0);
    return build_scene(cube);
}

/// The gathered light of each pixel, a value a seed.
std::vector<std::vector<double>> pixels_over_seeds(const Scene& scene, const MethodSettings& method) {
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    std::vector<std::vector<double>> values(pixel_count(hit_points));
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
        const Rendering result = render(scene, hit_points, method, {.passes = 4, .seed = seed});
        const std::vector<Color>& gathered = *result.image.find(gathered_layer);
        for (std::size_t i = 0; i < values.size(); ++i) values[i].push_back(mean_channel(ColorD(gathered[i])));
    }
    return values;
}

MethodSettings in_cube(MethodSettings method) {
    method.radius = cube_radius;
    method.max_radius = cube_radius;
    method.direct = DirectMode::Photons;
    method.photons_per_pass = 1500;
    return method;
}

std::vector<MethodSettings> every_method() {
    return {{.schedule = ScheduleName::Hachisuka},
            {.schedule = ScheduleName::KnausZwicker},
            {.integrator = "sppm"},
            {.integrator = "photonmapper", .mode = GatherMode::Radius},
            {.integrator = "photonmapper", .mode = GatherMode::Nearest, .k = 150}};
}

TEST(ClosedCube, IsRightInEveryPixelByEveryMethodKernelAndArea) {
    const Scene scene = cube_with_corners();
    ClaimFamily claims;
    for (const AreaMode area : {AreaMode::Seen, AreaMode::Linear})
        for (const Kernel kernel : {Kernel::Disc, Kernel::Cone, Kernel::Epanechnikov, Kernel::Biweight})
            for (MethodSettings method : every_method()) {
                if (area == AreaMode::Linear && kernel != Kernel::Disc && kernel != Kernel::Epanechnikov) continue;
                method.area = area;
                method.kernel = kernel;
                const auto pixels = pixels_over_seeds(scene, in_cube(method));
                for (std::size_t i = 0; i < pixels.size(); ++i)
                    claims.mean_is(method.integrator + " " + name_of(area) + " " + name_of(kernel) + ", pixel " +
                                       std::to_string(i),
                                   pixels[i], 1.0, 0.06, 1e-3);
            }
}

TEST(ClosedCube, IsDarkInItsCornersByTheDiscsArea) {
    const Scene scene = cube_with_corners();
    for (MethodSettings method : every_method()) {
        method.area = AreaMode::Disc;
        double darkest = 1.0;
        for (const auto& pixel : pixels_over_seeds(scene, in_cube(method)))
            darkest = std::min(darkest, SampleMean(pixel).mean);
        EXPECT_LT(darkest, 0.75) << method.integrator;
    }
}

TEST(AreasOfSmoothLight, AreTheDiscsToTheBit) {
    SceneDescription plane = floor_seen_at_origin(Color(0.5f));
    plane.camera = look_at(VectorD(4.0, 2.5, 1.0), VectorD(0.0), 8, 8, 40.0);
    plane.lights = {point_light(VectorD(0, 2, 0), ColorD(3.0))};
    for (const Scene& scene : {build_scene(plane), build_scene(hollow_sphere(Color(0.5f), ColorD(1.0)))})
        for (MethodSettings method : every_method()) {
            method.radius = 0.2;
            method.max_radius = 0.4;
            method.direct = DirectMode::Photons;
            method.kernel = Kernel::Epanechnikov;
            method.photons_per_pass = 1000;
            method.area = AreaMode::Disc;
            const Image disc = render(scene, method, {.passes = 3}).image;
            for (const AreaMode area : {AreaMode::Seen, AreaMode::Linear}) {
                method.area = area;
                EXPECT_EQ(*render(scene, method, {.passes = 3}).image.find(gathered_layer), *disc.find(gathered_layer))
                    << method.integrator;
            }
        }
}

// ---------------------------------------------------------------------------------------------------------------------

constexpr double floor_end = 1.0;      // the floor lies at |x|, |z| <= floor_end, scene units
constexpr double floor_radius = 0.25;  // of the gather
constexpr double seen_at = 0.05;       // from the end

/// A floor that ends beside the point that is seen, and whatever stands on it.
Scene ending_floor(std::vector<ShapeDescription> standing = {}) {
    SceneDescription scene;
    scene.materials = {diffuse(Color(0.5f), true)};
    scene.shapes = {shape(parallelogram(VectorD(-floor_end, 0, -floor_end), VectorD(0, 0, 2.0 * floor_end),
                                        VectorD(2.0 * floor_end, 0, 0)),
                          0)};
    for (ShapeDescription& one : standing) scene.shapes.push_back(std::move(one));
    scene.camera = look_at(VectorD(floor_end - seen_at, 2.0, 0.0), VectorD(floor_end - seen_at, 0.0, 0.0));
    return build_scene(scene);
}

/// Estimates of a density of photons that is 1 at the point, `paths` uniform over the floor, each with power
/// `power(offset)` of its offset from the point in radii: one a seed.
template <typename Power>
std::vector<double> estimates_on_floor(const Scene& scene, const AreaMode area, const Kernel kernel,
                                       const Power& power) {
    constexpr int paths = 4000;
    constexpr int seeds = 400;
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    const HitPoint point = hit_points.points[0];
    const double radius = floor_radius / scene.unit_length;
    GatherAreas areas(scene, {.mode = area, .kernel = kernel, .lines = 4000}, 1);
    const GatherReach reach{.radius = radius, .area = areas.at(surface_end(scene, point), 0, radius)};
    std::vector<double> estimates;
    for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
        RandomStream random(seed, RandomPurpose::Test, 1, 0);
        std::vector<Photon> photons;
        for (int i = 0; i < paths; ++i) {
            const VectorD at((2.0 * random.next_double() - 1.0) * floor_end, 0.0,
                             (2.0 * random.next_double() - 1.0) * floor_end);
            const Vector position((at - scene.centre) / scene.unit_length);
            photons.push_back({.position = {position.x, point.position.y, position.z},
                               .power = Color(static_cast<float>(power(VectorD(position - point.position) / radius))),
                               .incoming = PackedDirection(Vector(0, 1, 0)),
                               .normal = CoarseDirection(Vector(0, 1, 0)),
                               .edges = 1});
        }
        const FluxSum sum =
            gather_within(PhotonMap(photons), scene, hit_points.points, SearchOrder(hit_points.points), {0, 1},
                          {.kernel = kernel}, [&](std::size_t, const HitPoint&) { return reach; })[0]
                .sum;
        const double density = paths / (4.0 * floor_end * floor_end);
        estimates.push_back(mean_channel(sum.flux()) * pi / 0.5 / (pi * floor_radius * floor_radius * density));
    }
    return estimates;
}

/// Mean of the offset towards the end over the part of the disc that is there, in radii.
double centroid_at(double t) {
    const double missing = (std::acos(t) - t * std::sqrt(1.0 - t * t)) / pi;
    return -2.0 / (3.0 * pi) * std::pow(1.0 - t * t, 1.5) / (1.0 - missing);
}

TEST(GradientAtAnEdge, AlongItIsUnbiasedAcrossItOfFirstOrderAndWithLinearWeightsNeither) {
    const Scene scene = ending_floor();
    ClaimFamily claims;
    const auto along = [](const VectorD& offset) { return 1.0 + 0.7 * offset.z; };
    const auto across = [](const VectorD& offset) { return 1.0 + 0.7 * offset.x; };
    for (const Kernel kernel : {Kernel::Disc, Kernel::Biweight}) {
        claims.mean_is("seen, along", estimates_on_floor(scene, AreaMode::Seen, kernel, along), 1.0, 0.01, 1e-3);
        claims.mean_is("linear, along", estimates_on_floor(scene, AreaMode::Linear, kernel, along), 1.0, 0.02, 1e-3);
        claims.mean_is("linear, across", estimates_on_floor(scene, AreaMode::Linear, kernel, across), 1.0, 0.02, 1e-3);
    }
    claims.mean_is("seen, across", estimates_on_floor(scene, AreaMode::Seen, Kernel::Disc, across),
                   1.0 + 0.7 * centroid_at(seen_at / floor_radius), 0.01, 1e-3);
}

TEST(ThinWall, LetsNoLightThroughFromBehind) {
    const auto wall = [](double height) {  // between the point and the end of the floor, 0.02 from the point
        const VectorD foot(floor_end - seen_at - 0.02, 0, -floor_end);
        return shape(parallelogram(foot, VectorD(0, height, 0), VectorD(0, 0, 2.0 * floor_end)), 0);
    };
    const auto behind = [](const VectorD& offset) { return offset.x < -0.02 / floor_radius ? 1.0 : 0.0; };
    const auto sum_of = [](const std::vector<double>& values) {
        double sum = 0.0;
        for (const double value : values) sum += value;
        return sum;
    };
    for (const double height : {0.5, 0.1}) {
        const Scene scene = ending_floor({wall(height)});
        EXPECT_GT(sum_of(estimates_on_floor(scene, AreaMode::Disc, Kernel::Disc, behind)), 100.0);
        EXPECT_EQ(sum_of(estimates_on_floor(scene, AreaMode::Seen, Kernel::Disc, behind)), 0.0);
    }
    // And what lies on the point's own side is right.
    const auto before = [](const VectorD& offset) { return offset.x < -0.02 / floor_radius ? 0.0 : 1.0; };
    ClaimFamily claims;
    claims.mean_is("strip between wall and end",
                   estimates_on_floor(ending_floor({wall(0.5)}), AreaMode::Seen, Kernel::Disc, before), 1.0, 0.01,
                   1e-3);
}

}  // namespace
}  // namespace photonlab::test
