// The seen area, by lines and in flat surroundings by their triangles, against areas in closed form (docs/theory.md,
// section 4), at points beside edges, in corners, on curved surfaces and beside what is out of reach. Each mean over
// independent sets of lines is a z-test at |z| < 4.5 (7e-6 each; about two hundred here), and is known to half a
// percent of the disc at least.

#include "gather/areas/seen_area.h"

#include <gtest/gtest.h>

#include <functional>

#include "gather/areas/flat_area.h"
#include "gather/areas/gather_areas.h"
#include "gather/areas/in_reach.h"
#include "gather/map/photon_map.h"
#include "tests/scene/described.h"

namespace photonlab {
namespace {

constexpr double seen_z_limit = 4.5;
constexpr double radius = 0.02;  // unit box

/// Where a line downwards meets the scene first, in scene units.
SurfaceEnd point_below(const Scene& scene, const VectorD& above, const VectorD& downwards = {0, 0, -1}) {
    const Vector direction(downwards.normalized());
    const Hit hit = intersect(scene, {to_box(scene, above), direction}).value();
    const Surface surface = orient(scene, hit, -direction).value();
    return {surface.position, surface.frame.normal, surface.geometric_normal};
}

/// Share of a disc that is beyond a chord at distance `t` radii from the centre.
double beyond_chord(double t) {
    return t >= 1.0 ? 0.0 : (std::acos(t) - t * std::sqrt(1.0 - t * t)) / pi;
}

/// Area, in shares of the disc, of a half-plane that meets the point's own at distance t radii and turns by `angle`
/// there.
double turned_half_plane(double t, double angle) {
    const double height = t * std::sin(angle);
    const double rest = 1.0 - height * height;
    return rest * beyond_chord(t * std::cos(angle) / std::sqrt(rest));
}

/// Integral of the kernel over the part of the disc where `is_there(u, v)`, both in radii; in shares of the disc's.
double kernel_share(Kernel kernel, const std::function<bool(double, double)>& is_there) {
    constexpr int steps = 600;
    double sum = 0.0;
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double distance = std::sqrt((i + 0.5) / steps);
            const double angle = 2.0 * pi * (j + 0.5) / steps;
            if (is_there(distance * std::cos(angle), distance * std::sin(angle)))
                sum += kernel_weight(kernel, distance * distance);
        }
    return sum / (steps * steps);
}

/// Mean over independent measures of what `value` takes from them is `expected`.
void expect_mean(const std::string& what, const Scene& scene, const SurfaceEnd& point, double expected,
                 const std::function<double(const SeenArea&)>& value, Kernel kernel = Kernel::Disc,
                 double top = radius) {
    for (const auto& [per_ring, series] : {std::pair(1, 6000u), std::pair(16, 600u), std::pair(200, 40u)}) {
        double sum = 0.0;
        double sum_of_squares = 0.0;
        for (unsigned i = 0; i < series; ++i) {
            const double x = value(measure_seen_area(scene, point, kernel, top, {per_ring, 0, i}));
            sum += x;
            sum_of_squares += x * x;
        }
        const double mean = sum / series;
        const double error = std::sqrt(std::max(0.0, sum_of_squares / series - mean * mean) / (series - 1));
        EXPECT_LT(error, 0.005) << what << ", " << per_ring << " lines: too noisy to say anything";
        EXPECT_NEAR(mean, expected, seen_z_limit * error + 2e-5) << what << ", " << per_ring << " lines";
    }
}

void expect_area(const std::string& what, const Scene& scene, const SurfaceEnd& point, double expected,
                 Kernel kernel = Kernel::Disc) {
    expect_mean(
        what, scene, point, expected, [](const SeenArea& area) { return area.within[0].area; }, kernel);
}

constexpr Kernel kernels[] = {Kernel::Disc, Kernel::Cone, Kernel::Epanechnikov, Kernel::Biweight};

// ---------------------------------------------------------------------------------------------------------------------

/// The floor of 8 x 8 ends at x = 4: a point on it at `distance` radii from that edge.
SurfaceEnd beside_edge(const Scene& scene, double distance) {
    return point_below(scene, {4.0 - distance * radius * scene.unit_length, 0.3, 1.0});
}

TEST(SeenArea, OnWholeFlatSurfaceIsTheDiscToTheBit) {
    const Scene scene = build_scene(describe({floor_of_eight()}));
    for (const Kernel kernel : kernels)
        for (const int lines : {1, 3, 16}) {
            const SeenArea area =
                measure_seen_area(scene, point_below(scene, {0.3, 0.4, 1.0}), kernel, radius, {lines});
            for (const AreaMoments& moments : area.within) EXPECT_EQ(moments.area, 1.0);
            EXPECT_EQ(area.moments(0.7 * radius).area, 1.0);
            EXPECT_FALSE(area.is_obstructed);
        }
}

TEST(SeenArea, BesideAStraightEdgeIsTheDiscLessItsSegment) {
    const Scene scene = build_scene(describe({floor_of_eight()}));
    for (const double t : {1e-4, 0.3, 0.8}) {
        const SurfaceEnd point = beside_edge(scene, t);
        expect_area("edge at " + std::to_string(t), scene, point, 1.0 - beyond_chord(t));
        for (const Kernel kernel : kernels)
            expect_area(std::string("edge, ") + name_of(kernel), scene, point,
                        kernel_share(kernel, [&](double u, double) { return u < t; }), kernel);
        expect_mean("at half the radius", scene, point, 1.0 - beyond_chord(2.0 * t),
                    [](const SeenArea& area) { return area.moments(0.5 * radius).area; });
    }
}

TEST(SeenArea, InterpolatesToHalfAPercent) {
    const Scene scene = build_scene(describe({floor_of_eight()}));
    const SurfaceEnd point = beside_edge(scene, 0.6);
    const SeenArea area = measure_seen_area(scene, point, Kernel::Disc, radius, {20'000});
    for (const double share : {1.0, 0.93, 0.84, 0.77, 0.65, 0.6, 0.55, 0.4, 0.25})
        EXPECT_NEAR(area.moments(share * radius).area, 1.0 - beyond_chord(0.6 / share), 0.005) << share;
}

TEST(SeenArea, InASquareCornerIsAQuarterAndBesideItTheRest) {
    const Scene scene = build_scene(describe({floor_of_eight()}));
    for (const auto& [t, s] : {std::pair(1e-4, 1e-4), std::pair(0.2, 0.5)}) {
        const double to_edge = radius * scene.unit_length;
        const SurfaceEnd point = point_below(scene, {4.0 - t * to_edge, 4.0 - s * to_edge, 1.0});
        for (const Kernel kernel : kernels)
            expect_area(std::string("corner, ") + name_of(kernel), scene, point,
                        kernel_share(kernel, [&](double u, double v) { return u < t && v < s; }), kernel);
    }
}

/// Two half-planes that meet at x = 0, the second turned by `angle` (upwards: positive) against the first, which is the
/// floor at x < 0; and a point on that at `distance` radii.
struct Ridge {
    Scene scene;
    SurfaceEnd point;

    Ridge(double angle, double distance)
        : scene(build_scene(describe({shape(square({-2, 0, 0}, {2, 0, 0}, {0, 4, 0})),
                                      shape(square(VectorD(std::cos(angle), 0, std::sin(angle)) * 2.0,
                                                   VectorD(std::cos(angle), 0, std::sin(angle)) * 2.0, {0, 4, 0}))}))),
          point(point_below(scene, {-distance * radius * scene.unit_length, 0.3, 0.1})) {}
};

TEST(SeenArea, HoldsWhatTurnsAwayByLessThanSixtyDegreesAndNothingElse) {
    for (const double t : {0.1, 0.5})
        for (const double degrees : {-20.0, -10.0, 10.0, 30.0, 50.0, 70.0, 90.0, -90.0}) {
            const double angle = degrees * pi / 180.0;
            const Ridge ridge(angle, t);
            expect_area(std::to_string(degrees) + " degrees at " + std::to_string(t), ridge.scene, ridge.point,
                        1.0 - beyond_chord(t) + (std::abs(degrees) < 60.0 ? turned_half_plane(t, angle) : 0.0));
        }
}

TEST(SeenArea, OnASphereIsTheDiscFromWithinAndWithout) {
    for (const bool inside : {false, true}) {
        const Scene scene = build_scene(describe({floor_of_eight(), shape(SphereDescription{{0, 0, 2}, 1.0, inside})}));
        const SurfaceEnd point = inside ? point_below(scene, {0.1, 0.2, 2.0}) : point_below(scene, {0.1, 0.2, 3.5});
        for (const double chord : {0.2, 0.9})
            expect_mean(
                inside ? "sphere from inside" : "sphere from outside", scene, point, 1.0,
                [](const SeenArea& area) { return area.within[0].area; }, Kernel::Disc, chord / scene.unit_length);
    }
}

TEST(SeenArea, HoldsNothingOfTheFloorUnderABlockOrBeyondAThinWall) {
    const double to_wall = 0.4;
    const auto share_beside = [&](ShapeDescription standing) {
        const Scene scene = build_scene(describe({floor_of_eight(), std::move(standing)}));
        const SurfaceEnd point = point_below(scene, {0.5 + to_wall * radius * scene.unit_length, 0.05, 0.3});
        EXPECT_TRUE(measure_seen_area(scene, point, Kernel::Disc, radius, {}).is_obstructed);
        expect_area("beside what stands on the floor", scene, point, 1.0 - beyond_chord(to_wall));
    };
    share_beside(shape(cube({0, 0, 0.5}, 0.5)));
    share_beside(shape(square({0.5, 0, 0.5}, {0, 3, 0}, {0, 0, 0.5})));
}

TEST(SeenArea, LeavesOutWhatTakesNoPhotons) {
    SceneDescription description =
        describe({shape(square({-2, 0, 0}, {2, 0, 0}, {0, 4, 0})), shape(square({2, 0, 0}, {2, 0, 0}, {0, 4, 0}))});
    description.materials.push_back({.id = "black", .bsdf = Diffuse{Color(0.0f)}, .two_sided = true});
    description.materials.push_back({.id = "one-sided", .bsdf = Diffuse{Color(0.5f)}});
    const auto point = [&](const Scene& scene) {
        return point_below(scene, {-0.3 * radius * scene.unit_length, 0.3, 1.0});
    };
    for (const auto& [material, expected] : {std::pair(1, 1.0 - beyond_chord(0.3)), std::pair(2, 1.0)}) {
        description.shapes[1].material = static_cast<std::size_t>(material);
        const Scene scene = build_scene(description);
        expect_area("next to material " + std::to_string(material), scene, point(scene), expected);
    }
    description.shapes[1].geometry = square({2, 0, 0}, {0, 4, 0}, {2, 0, 0});  // turned over
    const Scene scene = build_scene(description);
    expect_area("next to a back", scene, point(scene), 1.0 - beyond_chord(0.3));
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(SeenAreaMoments, OnAnEdgeAreThoseOfHalfADisc) {
    const Scene scene = build_scene(describe({floor_of_eight()}));
    const SurfaceEnd point = beside_edge(scene, 1e-5);
    const auto along = [&](const VectorD& direction) {  // in the axes of the moments
        const Frame frame = make_frame(point.normal);
        return Imath::V2d(direction.dot(VectorD(frame.tangent)), direction.dot(VectorD(frame.bitangent)));
    };
    const Imath::V2d inwards = along({-1, 0, 0});
    const auto first = [&](const SeenArea& area) {
        return area.within[0].u * inwards.x + area.within[0].v * inwards.y;
    };
    const auto second = [&](const SeenArea& area) {
        const AreaMoments& m = area.within[0];
        return m.uu * inwards.x * inwards.x + 2.0 * m.uv * inwards.x * inwards.y + m.vv * inwards.y * inwards.y;
    };
    expect_mean("first moment", scene, point, 2.0 / (3.0 * pi), first);
    expect_mean("second moment", scene, point, 1.0 / 8.0, second);
    expect_mean("trace", scene, point, 1.0 / 4.0,
                [](const SeenArea& area) { return area.within[0].uu + area.within[0].vv; });
}

TEST(AreaWeights, SeenDividesByTheShareThatIsThere) {
    EXPECT_EQ(seen_weights({.area = 1.0}).constant, 1.0);
    EXPECT_EQ(seen_weights({.area = 0.5}).constant, 2.0);
    EXPECT_EQ(seen_weights({.area = 0.0}).constant, 1.0);
}

TEST(AreaWeights, LinearTakesTheGradientOutAndKeepsTheConstant) {
    const AreaMoments half{.area = 0.5, .u = -2.0 / (3.0 * pi), .v = 0.0, .uu = 0.125, .uv = 0.0, .vv = 0.125};
    const AreaMoments corner{.area = 0.25, .u = 0.11, .v = 0.1, .uu = 0.0625, .uv = 0.04, .vv = 0.06};
    for (const AreaMoments& m : {half, corner}) {
        const AreaWeights w = linear_weights(m);
        EXPECT_NEAR(w.constant * m.area + w.slope_u * m.u + w.slope_v * m.v, 1.0, 1e-12);
        EXPECT_NEAR(w.constant * m.u + w.slope_u * m.uu + w.slope_v * m.uv, 0.0, 1e-12);
        EXPECT_NEAR(w.constant * m.v + w.slope_u * m.uv + w.slope_v * m.vv, 0.0, 1e-12);
        EXPECT_NE(w.slope_u, 0.0);
    }
    const AreaWeights seen = linear_weights(half, 2.0);  // 3.6 is more than that
    EXPECT_EQ(seen.constant, 2.0);
    EXPECT_EQ(seen.slope_u, 0.0);
}

// ---------------------------------------------------------------------------------------------------------------------

FlatArea flat_at(const Scene& scene, const SurfaceEnd& point, Kernel kernel = Kernel::Disc) {
    const auto surroundings = flat_surroundings(scene, point, radius);
    EXPECT_TRUE(surroundings);
    const FlatArea area = flat_area(surroundings.value_or(FlatSurroundings{}), kernel, radius);
    EXPECT_TRUE(area.is_valid);
    return area;
}

TEST(FlatArea, IsTheDiscLessWhatEdgesAndCornersCutOff) {
    const Scene scene = build_scene(describe({floor_of_eight()}));
    const double to_edge = radius * scene.unit_length;
    for (const double t : {0.0, 1e-4, 0.3, 0.8, 0.99, 1.5}) {
        const FlatArea area = flat_at(scene, point_below(scene, {4.0 - (t + 1e-6) * to_edge, 0.3, 1.0}));
        EXPECT_NEAR(area.moments.area, 1.0 - beyond_chord(t), 5e-5) << t;
        EXPECT_FALSE(area.is_obstructed);
    }
    for (const Kernel kernel : kernels)
        for (const auto& [t, s] : {std::pair(1e-4, 1e-4), std::pair(0.2, 0.5), std::pair(0.7, 2.0)}) {
            const SurfaceEnd point = point_below(scene, {4.0 - t * to_edge, 4.0 - s * to_edge, 1.0});
            EXPECT_NEAR(flat_at(scene, point, kernel).moments.area,
                        kernel_share(kernel, [&](double u, double v) { return u < t && v < s; }), 1e-3)
                << name_of(kernel) << t;
        }
}

TEST(FlatArea, HasTheMomentsThatLinesFind) {
    const Scene scene = build_scene(describe({floor_of_eight(), shape(cube({0, 0, 0.5}, 0.5))}));
    const double to_edge = radius * scene.unit_length;
    for (const VectorD& above : {VectorD(4.0 - 0.2 * to_edge, 4.0 - 0.6 * to_edge, 1.0),
                                 VectorD(0.5 + 0.4 * to_edge, 0.5 - 0.3 * to_edge, 1.0),
                                 VectorD(0.5 + 0.2 * to_edge, 0.5 + 0.1 * to_edge, 1.0)}) {
        const SurfaceEnd point = point_below(scene, above);
        for (const Kernel kernel : kernels) {
            const FlatArea flat = flat_at(scene, point, kernel);
            const SeenArea by_lines = measure_seen_area(scene, point, kernel, radius, {20'000});
            const AreaMoments& lines = by_lines.within[0];
            for (const auto moment : {&AreaMoments::area, &AreaMoments::u, &AreaMoments::v, &AreaMoments::uu,
                                      &AreaMoments::uv, &AreaMoments::vv})
                EXPECT_NEAR(flat.moments.*moment, lines.*moment, 2e-3);
            EXPECT_EQ(flat.is_obstructed, by_lines.is_obstructed);
        }
    }
}

TEST(FlatArea, EndsAtABlockAndAtAThinWall) {
    const double t = 0.4;
    for (const bool is_wall : {false, true}) {
        const Scene scene =
            build_scene(describe({floor_of_eight(), is_wall ? shape(square({0.5, 0, 0.5}, {0, 3, 0}, {0, 0, 0.5}))
                                                            : shape(cube({0, 0, 0.5}, 0.5))}));
        const FlatArea area = flat_at(scene, point_below(scene, {0.5 + t * radius * scene.unit_length, 0.05, 0.3}));
        EXPECT_NEAR(area.moments.area, 1.0 - beyond_chord(t), 1e-4);
        EXPECT_TRUE(area.is_obstructed);
    }
}

TEST(FlatArea, IsNotKnownBesideWhatIsTiltedCurvedOrTextured) {
    const Ridge ridge(0.3, 0.5);
    EXPECT_FALSE(flat_surroundings(ridge.scene, ridge.point, radius));
    const Scene scene = build_scene(describe({floor_of_eight(), shape(SphereDescription{{0, 0, 0.5}, 0.5, false})}));
    EXPECT_FALSE(flat_surroundings(scene, point_below(scene, {0.01, 0.0, 0.001}, {0, 0, -1}), radius));
}

TEST(FlatArea, OfTwoFloorsInOnePlaceIsNotValid) {
    const Scene scene = build_scene(describe({floor_of_eight(), floor_of_eight()}));
    const SurfaceEnd point{{0.0f, 0.0f, 0.0f}, {0, 0, 1}, {0, 0, 1}};
    EXPECT_FALSE(flat_area(flat_surroundings(scene, point, radius).value(), Kernel::Disc, radius).is_valid);
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(GatherAreas, AreTheSameWhateverWasAskedBefore) {
    const Scene scene = build_scene(
        describe({floor_of_eight(), shape(cube({0, 0, 0.5}, 0.5)), shape(SphereDescription{{2, 0, 0.2}, 1.0, false})}));
    const SurfaceEnd points[] = {point_below(scene, {3.9, 0.3, 1.0}), point_below(scene, {0.6, 0.3, 1.0}),
                                 point_below(scene, {2.0, 0.9, 3.0}), point_below(scene, {2.0, 1.1, 3.0})};
    const Photon photon{.position = points[0].position,
                        .power = Color(1.0f),
                        .incoming = PackedDirection(Vector(0, 0, 1)),
                        .normal = CoarseDirection(Vector(0, 0, 1)),
                        .edges = 1};
    const auto weight = [&](const GatherArea& area) {
        return area.is_whole() ? -1.0 : area.weight(scene, photon).value_or(-2.0);
    };
    const GatherAreaSettings settings{.mode = AreaMode::Linear, .kernel = Kernel::Cone, .lines = 4};
    GatherAreas used(scene, settings, std::size(points));
    for (const double asked : {0.1, 0.07, 0.03, 0.01, 0.002, 1e-4, 1e-6, 1e-12, 0.05, 0.5, 3.0})
        for (std::size_t i = 0; i < std::size(points); ++i) {
            GatherAreas fresh(scene, settings, std::size(points));
            EXPECT_EQ(weight(used.at(points[i], i, asked)), weight(fresh.at(points[i], i, asked))) << asked;
        }
    EXPECT_GT(used.bytes(), std::size(points) * 8);
}

TEST(GatherAreas, InterpolateFlatAreasToATenthOfAPercent) {
    const Scene scene = build_scene(describe({floor_of_eight()}));
    const SurfaceEnd point = beside_edge(scene, 0.6);
    GatherAreas areas(scene, {.mode = AreaMode::Seen}, 1);
    const Photon photon{.position = point.position,
                        .power = Color(1.0f),
                        .incoming = PackedDirection(point.normal),
                        .normal = CoarseDirection(point.normal),
                        .edges = 1};
    for (double share = 1.0; share > 0.3; share *= 0.993) {
        const GatherArea area = areas.at(point, 0, share * radius);
        EXPECT_NEAR(area.weight(scene, photon).value(), 1.0 / (1.0 - beyond_chord(0.6 / share)), 1e-3) << share;
    }
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(IsWholeAround, UpToTheNearestEdgeWallOrShape) {
    const Scene scene =
        build_scene(describe({floor_of_eight(), shape(square({1, 0, 1}, {0, 1, 0}, {0, 0, 1})),
                              shape(SphereDescription{{0, 2, 2}, 1.0, false}), shape(cube({-2, -2, 0.5}, 0.5))}));
    const auto is_whole = [&](const VectorD& above, double reach) {
        return is_whole_around(scene, point_below(scene, above), reach / scene.unit_length);
    };
    EXPECT_TRUE(is_whole({-2, 2, 1}, 1.5));
    EXPECT_TRUE(is_whole({0.5, 0, 1}, 0.49));
    EXPECT_FALSE(is_whole({0.5, 0, 1}, 0.51)) << "the wall";
    EXPECT_TRUE(is_whole({3.5, 2.5, 1}, 0.49));
    EXPECT_FALSE(is_whole({3.5, 2.5, 1}, 0.51)) << "the edge of the floor";
    EXPECT_TRUE(is_whole({-2, -2, 2}, 0.49)) << "the top of the block";
    EXPECT_FALSE(is_whole({-2, -2, 2}, 0.51)) << "its edge";
    EXPECT_FALSE(is_whole({-2, -1.4, 2}, 0.15)) << "floor beside the block";
    EXPECT_TRUE(is_whole({0, 2, 4}, 0.9)) << "the sphere";
    EXPECT_FALSE(is_whole({0, 2, 4}, 1.0)) << "normals turn by more than 60 degrees";
}

TEST(IsWholeAround, NotWhereNothingIsKnown) {
    SceneDescription description = describe({floor_of_eight()});
    description.materials[0].bsdf = Diffuse{Color(0.0f)};
    Scene scene = build_scene(description);
    const SurfaceEnd point{{0.0f, 0.0f, 0.0f}, {0, 0, 1}, {0, 0, 1}};
    EXPECT_FALSE(is_whole_around(scene, point, 0.1)) << "a black floor";
    scene = build_scene(describe({floor_of_eight(), floor_of_eight()}));
    EXPECT_FALSE(is_whole_around(scene, point, 0.1)) << "a floor that is there twice";
    scene = build_scene(describe({floor_of_eight()}));
    EXPECT_TRUE(is_whole_around(scene, point, 0.1));
}

TEST(IsWholeAround, OnATextureThatIsNowhereBlack) {
    SceneDescription description = describe({floor_of_eight()});
    const SurfaceEnd point{{0.0f, 0.0f, 0.0f}, {0, 0, 1}, {0, 0, 1}};
    const auto is_whole_on = [&](const Texture& texture) {
        description.materials[0].textures = {textured(&Diffuse::reflectance, std::make_shared<const Texture>(texture))};
        return is_whole_around(build_scene(description), point, 0.1);
    };
    const Checkerboard tiles{.first = Color(0.0f, 0.0f, 0.4f), .second = Color(0.1f)};
    EXPECT_TRUE(is_whole_on(tiles)) << "in no channel both, but nowhere black";
    EXPECT_FALSE(is_whole_on(Checkerboard{.first = Color(0.0f), .second = Color(0.1f)}));
    const auto nested = std::make_shared<const NestedTexture>(NestedTexture{tiles});
    EXPECT_TRUE(is_whole_on(Scale{.nested = nested, .factor = Color(0.5f)}));
    EXPECT_FALSE(is_whole_on(Scale{.nested = nested, .factor = Color(0.5f, 0.5f, 0.0f)})) << "black in its blue tiles";
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(Reach, EightAtOnceAreAsOneByOne) {
    const Scene scene = build_scene(describe({floor_of_eight(), shape(square({0.5, 0, 0.5}, {0, 3, 0}, {0, 0, 0.5})),
                                              shape(SphereDescription{{2, 0, 0}, 1.0, false})}));
    const SurfaceEnd point = point_below(scene, {0.8, 0.0, 0.3});
    RandomStream random(1, RandomPurpose::Test, 0, 0);
    std::size_t in_reach = 0;
    for (int round = 0; round < 100; ++round) {
        std::vector<Photon> photons;
        for (int i = 0; i < 1 + round % 8; ++i) {
            const SurfaceEnd at = point_below(scene, {3.0 * random.next(), random.next() - 0.5, 2.0});
            photons.push_back({.position = at.position,
                               .power = Color(1.0f),
                               .incoming = PackedDirection(at.normal),
                               .normal = CoarseDirection(at.normal),
                               .edges = 1});
        }
        const unsigned together = in_reach_of_eight(scene, point, photons);
        for (std::size_t i = 0; i < photons.size(); ++i) {
            EXPECT_EQ(together >> i & 1u, is_in_reach(scene, point, photons[i]) ? 1u : 0u);
            in_reach += together >> i & 1u;
        }
        EXPECT_EQ(together >> photons.size(), 0u);
    }
    EXPECT_GT(in_reach, 100u);
    EXPECT_LT(in_reach, 400u);
}

}  // namespace
}  // namespace photonlab
