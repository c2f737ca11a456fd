// Scenes of every size, anywhere, under any light; sheets of almost no thickness; meshes as bad as files hold them.
// Most answers are invariances: the same scene written well gives the same image.

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "core/error.h"
#include "scene/narrow_gaps.h"
#include "tests/extremes/foot_of_light.h"
#include "tests/statistical/rendering.h"

namespace photonlab::test {
namespace {

/// All lengths times `unit`, moved by `offset`; light times `light`, so that radiance is multiplied by it.
SceneDescription changed(SceneDescription scene, double unit, const VectorD& offset, double light) {
    for (ShapeDescription& shape : scene.shapes) {
        if (shape.radiance) *shape.radiance *= light;
        if (auto* mesh = std::get_if<MeshDescription>(&shape.geometry))
            for (VectorD& position : mesh->positions) position = position * unit + offset;
        if (auto* sphere = std::get_if<SphereDescription>(&shape.geometry)) {
            sphere->centre = sphere->centre * unit + offset;
            sphere->radius *= unit;
        }
        if (auto* disk = std::get_if<DiskDescription>(&shape.geometry)) {
            disk->centre = disk->centre * unit + offset;
            disk->radius *= unit;
        }
    }
    for (LightDescription& light_of_scene : scene.lights) {
        auto& lamp = std::get<PointLightDescription>(light_of_scene);
        lamp.position = lamp.position * unit + offset;
        lamp.intensity *= light * unit * unit;
    }
    Matrix& camera = scene.camera.to_world;
    for (int axis = 0; axis < 3; ++axis) camera[3][axis] = camera[3][axis] * unit + offset[axis];
    return scene;
}

/// Reflected radiance at one hit point, with direct light by shadow rays and by photons.
struct BothWays {
    ColorD sampled;
    ColorD photons;
};

BothWays radiance_both_ways(const SceneDescription& description, double radius, std::uint64_t photons = 4000) {
    const Scene scene = build_scene(description);
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    EXPECT_EQ(hit_points.points.size(), 1u);
    MethodSettings method{.radius = radius, .max_depth = 2, .photons_per_pass = photons};
    const ColorD sampled = mean_of(render(scene, hit_points, method, {.passes = 1}).image, direct_layer);
    method.direct = DirectMode::Photons;
    return {sampled, mean_of(render(scene, hit_points, method, {.passes = 4}).image, gathered_layer)};
}

void expect_same(const ColorD& actual, const ColorD& expected, double tolerance, const std::string& what) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(actual[c] / expected[c], 1.0, tolerance) << what << ", channel " << c;
}

constexpr double foot_radius = 0.1;

// Direct light of a point is exact in one sample. The photons are the same ones in every unit but for a rounding.
TEST(ScaleAndLight, OfAnySizeTogetherGiveTheSameRadianceTimesTheLight) {
    const FootOfLight light;
    const ColorD exact = light.radiance(1e-9);
    const BothWays base = radiance_both_ways(light.description(), foot_radius);
    expect_same(base.photons, light.radiance(foot_radius), 0.1, "the base itself");
    for (const double unit : {1e-6, 3e-4, 1.0, 7e3, 1e6})
        for (const double factor : {1e-30, 1e-11, 1.0, 1e13, 1e30}) {
            const BothWays found =
                radiance_both_ways(changed(light.description(), unit, VectorD(0.0), factor), foot_radius * unit);
            const std::string what = "unit " + std::to_string(unit) + ", light " + std::to_string(factor);
            expect_same(found.sampled / factor, exact, 1e-6, what);
            expect_same(found.photons / factor, base.photons, 1e-6, what);
        }
}

TEST(ScaleAndLight, AMillionSceneSizesFromTheOriginNothingChanges) {
    const FootOfLight light;
    const BothWays base = radiance_both_ways(light.description(), foot_radius);
    for (const double unit : {1e-6, 1.0, 1e6})
        for (const VectorD& direction : {VectorD(1, -0.7, 0.3), VectorD(-1e-3, 1, 1), VectorD(0, 0, 1)}) {
            const BothWays found = radiance_both_ways(changed(light.description(), unit, direction * (1e6 * unit), 1.0),
                                                      foot_radius * unit);
            expect_same(found.sampled, base.sampled, 1e-6, "sampled");
            expect_same(found.photons, base.photons, 1e-6, "photons");
        }
}

// Coordinates are doubles: farther out they no longer say where things are. In between, what is lost is noted.
TEST(ScaleAndLight, WhereDoublesNoLongerHoldTheSceneIsRefused) {
    const auto far_away = [](double unit, double sizes) {
        return changed(FootOfLight{}.description(), unit, VectorD(0.1, -sizes, 0.3) * unit, 1.0);
    };
    for (const double unit : {1e-6, 1.0, 1e6}) {
        for (const double sizes : {1.0, 1e6, 1e9})
            EXPECT_TRUE(build_scene(far_away(unit, sizes)).notes.empty()) << sizes;
        for (const double sizes : {1e10, 4e11}) {
            const std::vector<std::string> notes = build_scene(far_away(unit, sizes)).notes;
            ASSERT_EQ(notes.size(), 1u) << sizes;
            EXPECT_EQ(notes[0].rfind("so far from the origin coordinates are rounded to ", 0), 0u) << notes[0];
        }
        for (const double sizes : {5e11, 1e13, 1e30}) try {
                build_scene(far_away(unit, sizes));
                FAIL() << sizes;
            } catch (const InputError& error) {
                const std::string message = error.what();
                EXPECT_NE(message.find("move it closer to the origin"), std::string::npos) << message;
            }
    }
}

// ---------------------------------------------------------------------------------------------------------------------

/// A sheet of this thickness, its sides of different colour, with a light 1/4 above or below it.
SceneDescription lit_sheet(double thickness, bool lit_from_below, bool seen_from_below) {
    const double level = 0.25;  // far from the middle of the box, where floats are coarser
    const double lower = level - thickness;
    SceneDescription scene;
    scene.materials = {diffuse(Color(0.5f, 0.25f, 0.75f)), diffuse(Color(0.25f, 0.75f, 0.5f)), diffuse(Color(0.0f))};
    scene.shapes = {shape(parallelogram(VectorD(-0.5, level, -0.5), VectorD(0, 0, 1), VectorD(1, 0, 0)), 0),
                    shape(parallelogram(VectorD(-0.5, lower, -0.5), VectorD(1, 0, 0), VectorD(0, 0, 1)), 1),
                    disk(VectorD(0.0, -0.5, 0.0), VectorD(0, 1, 0), 0.01, 2),
                    disk(VectorD(0.0, 0.5, 0.0), VectorD(0, -1, 0), 0.01, 2)};
    scene.lights = {point_light(VectorD(0.0, lit_from_below ? lower - 0.25 : level + 0.25, 0.0), ColorD(1.0))};
    scene.camera = seen_from_below ? look_at(VectorD(0.2, lower - 0.2, 0.1), VectorD(0.0, lower, 0.0))
                                   : look_at(VectorD(0.2, level + 0.2, 0.1), VectorD(0.0, level, 0.0));
    return scene;
}

TEST(ThinSheet, OfAHundredThousandthOfTheSceneLetsNoLightThrough) {
    for (const bool from_below : {false, true}) {
        const BothWays dark = radiance_both_ways(lit_sheet(1e-5, !from_below, from_below), foot_radius);
        EXPECT_EQ(dark.sampled, ColorD(0.0));
        EXPECT_EQ(dark.photons, ColorD(0.0));
        const BothWays thin = radiance_both_ways(lit_sheet(1e-5, from_below, from_below), foot_radius);
        const BothWays thick = radiance_both_ways(lit_sheet(0.1, from_below, from_below), foot_radius);
        const ColorD reflectance = from_below ? ColorD(0.25, 0.75, 0.5) : ColorD(0.5, 0.25, 0.75);
        expect_same(thin.sampled, reflectance * (16.0 / pi), 1e-5, "sampled");
        expect_same(thin.photons, thick.photons, 2e-3, "photons");
    }
}

TEST(ThinSheet, OfGlassLetsThroughWhatAThickOneDoes) {
    // Photons of a point through a slab onto a floor: as many, and as strong, through either.
    const auto through = [](double thickness) {
        SceneDescription scene;
        scene.materials = {diffuse(Color(0.5f)), {.id = "glass", .bsdf = Dielectric{}}};
        scene.shapes = {
            shape(parallelogram(VectorD(-0.5, -0.5, -0.5), VectorD(0, 0, 1), VectorD(1, 0, 0)), 0),
            shape(parallelogram(VectorD(-0.5, 0.25, -0.5), VectorD(0, 0, 1), VectorD(1, 0, 0)), 1),
            shape(parallelogram(VectorD(-0.5, 0.25 - thickness, -0.5), VectorD(1, 0, 0), VectorD(0, 0, 1)), 1)};
        scene.lights = {point_light(VectorD(0.0, 0.5, 0.0), ColorD(1.0))};
        double power = 0.0;
        for (const Photon& photon : trace_photons(build_scene(scene), {.paths = 100'000}, 1, 1).photons)
            if (photon.edges >= 3) power += photon.power.x;
        return power;
    };
    const double thick = through(1e-3);
    ASSERT_GT(thick, 5000.0);
    EXPECT_NEAR(through(1e-5), thick, 3e-3 * thick);  // what leaves by the sides of the thick one differs
}

TEST(NarrowGaps, BelowAHundredThousandthOfTheSceneAreFound) {
    for (const double unit : {1.0, 1e-6, 1e6}) {
        const auto found = [&](double thickness) {
            return find_narrow_gaps(build_scene(changed(lit_sheet(thickness, false, false), unit, VectorD(3.0), 1.0)));
        };
        for (const double thickness : {0.1, 1e-3, 2e-5, 1e-5}) {
            EXPECT_EQ(found(thickness).found, 0u) << thickness;
            EXPECT_GT(found(thickness).tried, 10u);
        }
        for (const double thickness : {9.5e-6, 3e-6, 1e-7, 0.0}) {
            const NarrowGaps gaps = found(thickness);
            EXPECT_GE(gaps.found, 8u) << thickness;
            ASSERT_TRUE(gaps.first);
            EXPECT_EQ(gaps.first->shape + gaps.first->other, 1u) << "the sheet is shapes 0 and 1";
        }
    }
}

TEST(NarrowGaps, AreNoneInARoomOrWhereABallRestsOnAFloor) {
    EXPECT_EQ(find_narrow_gaps(build_scene(room())).found, 0u);
    EXPECT_EQ(find_narrow_gaps(build_scene(hollow_cube(Color(0.5f), std::nullopt))).found, 0u);
    SceneDescription resting = floor_seen_at_origin(Color(0.5f), 3.0);
    resting.shapes.push_back(sphere(VectorD(0.0, 1.0, 0.0), 1.0, false, 0));
    EXPECT_EQ(find_narrow_gaps(build_scene(resting)).found, 0u);
}

TEST(NarrowGaps, AreFoundBetweenBallsAndDisks) {
    SceneDescription scene = floor_seen_at_origin(Color(0.5f), 3.0);
    scene.shapes.push_back(disk(VectorD(0.0, 1e-6, 0.0), VectorD(0, 1, 0), 1.0, 0));
    EXPECT_GE(find_narrow_gaps(build_scene(scene)).found, 5u);
    scene = floor_seen_at_origin(Color(0.5f), 3.0);
    scene.shapes.push_back(sphere(VectorD(0.0, 1.5, 0.0), 1.0, false, 0));
    scene.shapes.push_back(sphere(VectorD(0.0, 1.5, 0.0), 1.00001, false, 0));
    EXPECT_GE(find_narrow_gaps(build_scene(scene)).found, 8u);
}

// ---------------------------------------------------------------------------------------------------------------------

/// A tilted floor, no coordinate of which is a float, under a point light and seen where the light is closest.
struct TiltedFloor {
    VectorD centre = VectorD(0.11, -0.23, 0.17);
    VectorD first = VectorD(0.6, 0.5, -0.3).normalized();
    VectorD normal = first.cross(VectorD(0.1, 0.7, 0.4)).normalized();
    VectorD second = normal.cross(first);
    double height = 0.3;

    MeshDescription plain() const {
        return parallelogram(centre - first * 0.3 - second * 0.3, first * 0.6, second * 0.6);
    }
    SceneDescription description(MeshDescription floor) const {
        SceneDescription scene;
        scene.materials = {diffuse(Color(0.5f))};
        scene.shapes = {shape(std::move(floor), 0)};
        scene.lights = {point_light(centre + normal * height, ColorD(1.0))};
        scene.camera = look_at(centre + normal * 0.2 + first * 0.1, centre);
        return scene;
    }
};

/// The tilted floor cut into strips of `width` around its middle line, each of two slivers from `bottom` to `top`.
MeshDescription strips(const TiltedFloor& tilted, int count, double width, double bottom, double top) {
    MeshDescription floor;
    for (std::uint32_t i = 0; i <= static_cast<std::uint32_t>(count); ++i) {
        for (const double along : {bottom, top})
            floor.positions.push_back(tilted.centre + tilted.first * ((i - 0.5 * count) * width) +
                                      tilted.second * along);
        if (i == 0) continue;
        floor.triangles.push_back({2 * i - 2, 2 * i, 2 * i - 1});
        floor.triangles.push_back({2 * i - 1, 2 * i, 2 * i + 1});
    }
    return floor;
}

// Ten thousand times as long as they are wide. Embree's barycentric coordinates are floats, so along a triangle a hit
// is known to 6e-8 of its length times that ratio: at 6e5 the same image is off by 0.7%.
TEST(BadMeshes, SliversGiveTheImageOfAPlainFloor) {
    const TiltedFloor tilted;
    const BothWays plain = radiance_both_ways(tilted.description(tilted.plain()), foot_radius);
    expect_same(plain.sampled, ColorD(0.5 / (pi * 0.09)), 1e-6, "plain, sampled");
    const BothWays slivers =
        radiance_both_ways(tilted.description(strips(tilted, 10'000, 6e-5, -0.3, 0.3)), foot_radius);
    expect_same(slivers.sampled, plain.sampled, 1e-5, "sampled");
    expect_same(slivers.photons, plain.photons, 2e-3, "photons");
}

// A millionth of the scene wide: their corners are rounded to floats 3e-8 apart, which tilts their planes by degrees.
// The normals are those of the triangles before rounding.
TEST(BadMeshes, TrianglesOfAMillionthOfTheSceneKeepTheirPlane) {
    const TiltedFloor tilted;
    SceneDescription description = tilted.description(tilted.plain());
    description.shapes.push_back(shape(strips(tilted, 4000, 1e-6, -2e-3, 2e-3), 0));
    description.shapes[0] =
        shape(parallelogram(tilted.centre - tilted.normal - tilted.first, tilted.first, tilted.second), 0);
    description.camera = look_at(tilted.centre + tilted.normal * 0.2, tilted.centre, 16, 16, 0.4);
    const Scene slivers = build_scene(description);
    const HitPoints hit_points = trace_hit_points(slivers, 1, 1);
    ASSERT_EQ(hit_points.points.size(), 256u);
    for (const HitPoint& point : hit_points.points)
        EXPECT_GT(VectorD(point.geometric_normal).dot(tilted.normal), 1.0 - 1e-6);
    const Image image = render(slivers, hit_points, {.max_depth = 2, .photons_per_pass = 1}, {.passes = 1}).image;
    // The light is 0.3 above, the patch 1e-3 wide: (1e-3 / 0.3)^2 at most from its middle's irradiance.
    for (const Color& pixel : *image.find(direct_layer)) EXPECT_NEAR(pixel.x * pi * 0.09 / 0.5, 1.0, 2e-5);
}

TEST(BadMeshes, TrianglesWithoutAreaChangeNoBit) {
    const TiltedFloor tilted;
    MeshDescription floor = tilted.plain();
    const BothWays plain = radiance_both_ways(tilted.description(floor), foot_radius);
    floor.positions.push_back(tilted.centre);
    floor.positions.push_back(tilted.centre + tilted.first * 0.1);
    floor.positions.push_back(tilted.centre + tilted.first * 0.2);
    floor.triangles.push_back({4, 4, 4});
    floor.triangles.push_back({0, 0, 1});
    floor.triangles.push_back({4, 5, 4});
    const BothWays degenerate = radiance_both_ways(tilted.description(floor), foot_radius);
    EXPECT_EQ(degenerate.sampled, plain.sampled);
    EXPECT_EQ(degenerate.photons, plain.photons);
    // On one line, but not in one point: rounding may give it an area of its own, of some 1e-8.
    floor.triangles.push_back({4, 5, 6});
    const BothWays line = radiance_both_ways(tilted.description(floor), foot_radius);
    expect_same(line.sampled, plain.sampled, 1e-5, "sampled");
    expect_same(line.photons, plain.photons, 2e-3, "photons");
}

TEST(BadMeshes, DuplicateTrianglesAndCoincidentSurfacesGiveTheImageOfOne) {
    const TiltedFloor tilted;
    const MeshDescription floor = tilted.plain();
    const BothWays once = radiance_both_ways(tilted.description(floor), foot_radius);
    MeshDescription twice = floor;
    twice.triangles.insert(twice.triangles.end(), floor.triangles.begin(), floor.triangles.end());
    const BothWays duplicate = radiance_both_ways(tilted.description(twice), foot_radius);
    EXPECT_EQ(duplicate.sampled, once.sampled);
    EXPECT_EQ(duplicate.photons, once.photons);
    SceneDescription surfaces = tilted.description(floor);
    surfaces.shapes.push_back(surfaces.shapes[0]);
    const BothWays coincident = radiance_both_ways(surfaces, foot_radius);
    EXPECT_EQ(coincident.sampled, once.sampled);
    EXPECT_EQ(coincident.photons, once.photons);
    EXPECT_GE(find_narrow_gaps(build_scene(surfaces)).found, 8u);
}

// A lamp whose triangles repeat, turn or have no area gives the light of a plain one: no more than there is surface to
// give it.
TEST(BadMeshes, ALampOfDuplicateTrianglesIsNoBrighter) {
    SceneDescription scene = floor_seen_at_origin(Color(0.5f), 3.0);
    MeshDescription lamp = parallelogram(VectorD(-0.5, 1.0, -0.5), VectorD(1, 0, 0), VectorD(0, 0, 1));
    scene.shapes.push_back(shape(lamp, 1, ColorD(2.0)));
    const Scene plain = build_scene(scene);
    lamp.triangles.push_back(lamp.triangles[0]);
    lamp.triangles.push_back({lamp.triangles[1].y, lamp.triangles[1].z, lamp.triangles[1].x});
    lamp.positions.push_back(lamp.positions[0]);
    lamp.triangles.push_back({4, lamp.triangles[0].y, lamp.triangles[0].z});  // the same corner by another number
    lamp.triangles.push_back({2, 2, 3});
    scene.shapes.back() = shape(lamp, 1, ColorD(2.0));
    const Scene repeated = build_scene(scene);
    EXPECT_EQ(repeated.total_power, plain.total_power);
    for (const MethodSettings& method :
         {MethodSettings{.integrator = "path", .max_depth = 2},
          MethodSettings{.radius = 0.3, .max_depth = 2, .photons_per_pass = 2000},
          MethodSettings{.radius = 0.3, .direct = DirectMode::Photons, .max_depth = 2, .photons_per_pass = 2000}})
        EXPECT_EQ(mean_total(render(repeated, method, {.passes = 4}).image),
                  mean_total(render(plain, method, {.passes = 4}).image));
}

TEST(BadMeshes, WithoutNormalsOrWithZeroNormalsAreFlat) {
    const TiltedFloor tilted;
    MeshDescription floor = tilted.plain();
    const BothWays flat = radiance_both_ways(tilted.description(floor), foot_radius);
    expect_same(flat.sampled, ColorD(0.5 / (pi * 0.09)), 1e-6, "flat");
    for (const VectorD& normal : {VectorD(0.0), VectorD(1e-300, 0.0, 0.0), VectorD(0.0, -1e-60, 0.0)}) {
        floor.normals.assign(4, normal);
        const BothWays zero = radiance_both_ways(tilted.description(floor), foot_radius);
        EXPECT_EQ(zero.sampled, flat.sampled) << normal.x;
        EXPECT_EQ(zero.photons, flat.photons) << normal.x;
    }
    // Where only some are zero, the others decide; all of these are right, whatever their length.
    floor.normals = {tilted.normal, VectorD(0.0), tilted.normal * 1e30, tilted.normal * 1e-30};
    expect_same(radiance_both_ways(tilted.description(floor), foot_radius).sampled, flat.sampled, 1e-6, "some");
}

TEST(BadMeshes, VerticesThatAreNotFiniteAreRefused) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
                             -std::numeric_limits<double>::infinity()})
        for (int axis = 0; axis < 3; ++axis) {
            MeshDescription floor = TiltedFloor{}.plain();
            floor.positions[2][axis] = bad;
            try {
                build_scene(TiltedFloor{}.description(floor));
                FAIL();
            } catch (const InputError& error) {
                EXPECT_STREQ(error.what(), "test: vertex 3 is not finite");
            }
        }
}

}  // namespace
}  // namespace photonlab::test
