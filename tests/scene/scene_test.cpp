// Building a scene, and what rays find in it, against geometry that can be worked out by hand. The unit box makes
// lengths of order one everywhere here, so tolerances are multiples of float32's epsilon and of the distances involved.

#include "scene/scene.h"

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/sampling.h"
#include "tests/scene/described.h"

namespace photonlab {
namespace {

constexpr float epsilon = std::numeric_limits<float>::epsilon();

Vector random_direction(RandomStream& random) {
    return sample_unit_sphere(random.next_2d()).normalized();
}

Vector towards(const Vector& from, const Vector& to) {
    return Vector((VectorD(to) - VectorD(from)).normalized());
}

void expect_unit(const Vector& normal) {
    EXPECT_NEAR(normal.length(), 1.0f, 8 * epsilon);
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(Intersect, FindsSpheresFromOutsideAndInside) {
    const Scene scene = build_scene(describe({shape(SphereDescription{{1, 2, 3}, 2.0, false})}));
    const Vector centre = to_box(scene, {1, 2, 3});
    const float radius = static_cast<float>(2.0 / scene.unit_length);
    for (const float distance : {2.0f, 100.0f, 0.0f}) {
        const auto hit = intersect(scene, {centre - Vector(distance * radius, 0, 0), {1, 0, 0}});
        ASSERT_TRUE(hit) << distance;
        const float side = distance > 1.0f ? -1.0f : 1.0f;
        EXPECT_LT((hit->position - (centre + Vector(side * radius, 0, 0))).length(), 1e-6f);
        EXPECT_LT((hit->geometric_normal - Vector(side, 0, 0)).length(), 1e-6f);
        EXPECT_NEAR(hit->distance, std::abs(distance - 1.0f) * radius, 100 * epsilon);
    }
}

TEST(Intersect, NormalsOfAFlippedSphereFaceItsCentre) {
    const Scene scene = build_scene(describe({shape(SphereDescription{{0, 0, 0}, 2.0, true})}));
    for (const float start : {-2.0f, 0.0f}) {
        const auto hit = intersect(scene, {{start, 0, 0}, {1, 0, 0}});
        ASSERT_TRUE(hit);
        EXPECT_GT(hit->geometric_normal.dot(-hit->position), 0.0f);
    }
}

TEST(Intersect, MeetsASphereWhereTheQuadraticSaysEvenFromFarAway) {
    const Scene scene = build_scene(describe({shape(SphereDescription{{0, 0, 0}, 1.0, false})}));
    const double radius = 0.5;
    RandomStream random = stream_of_scenes();
    for (const float distance : {0.2f, 1.0f, 10.0f, 1e3f, 1e6f})
        for (int i = 0; i < 5'000; ++i) {
            const Vector origin = random_direction(random) * distance;
            const Ray ray{origin, towards(origin, random_direction(random) * 0.6f)};
            const VectorD start(ray.origin), direction(ray.direction);
            const double middle = -start.dot(direction) / direction.length2();
            const double closest = (start + direction * middle).length();
            if (std::abs(closest - radius) < 1e-6) continue;  // at the rim either answer is right
            const auto hit = intersect(scene, ray);
            ASSERT_EQ(hit.has_value(), closest < radius) << distance << " " << closest;
            if (!hit) continue;
            const double half_chord = std::sqrt(radius * radius - closest * closest);
            const double t = distance < 0.5f ? middle + half_chord : middle - half_chord;
            EXPECT_LT((VectorD(hit->position) - (start + direction * t)).length(), 2.0 * epsilon * (1.0 + distance));
            EXPECT_NEAR(VectorD(hit->position).length(), radius, 1e-7);  // on the sphere, however far the origin
            expect_unit(hit->geometric_normal);
        }
}

TEST(Intersect, ATangentRayMissesOrFindsAFinitePerpendicularNormal) {
    const Scene scene = build_scene(describe({shape(SphereDescription{{0, 0, 0}, 1.0, false})}));
    EXPECT_FALSE(intersect(scene, {{-1, 0.5f * 1.00001f, 0}, {1, 0, 0}}));
    EXPECT_TRUE(intersect(scene, {{-1, 0.5f * 0.99999f, 0}, {1, 0, 0}}));
    for (int roundings = -20; roundings <= 20; ++roundings) {
        const auto hit = intersect(scene, {{-1, 0.5f + static_cast<float>(roundings) * epsilon, 0}, {1, 0, 0}});
        if (!hit) continue;
        expect_unit(hit->geometric_normal);
        EXPECT_NEAR(hit->geometric_normal.x, 0.0f, 4e-3f);
    }
}

TEST(Intersect, DisksEndAtTheirRim) {
    const Scene scene = build_scene(describe({shape(DiskDescription{{0, 0, 0}, {0, 0, 1}, 1.0})}));
    EXPECT_TRUE(intersect(scene, {{0.499f, 0, 1}, {0, 0, -1}}));
    EXPECT_FALSE(intersect(scene, {{0.501f, 0, 1}, {0, 0, -1}}));
    EXPECT_FALSE(intersect(scene, {{0.36f, 0.36f, 1}, {0, 0, -1}}));
    EXPECT_FALSE(intersect(scene, {{-1, 0, 0}, {1, 0, 0}}));  // in its own plane it has no width
}

TEST(Intersect, DisksOfEveryInclinationAreFoundFromBothSides) {
    RandomStream random = stream_of_scenes();
    for (int i = 0; i < 100; ++i) {
        const VectorD normal = i == 0   ? VectorD(0, 0, 1)
                               : i == 1 ? VectorD(0, 1, 0)
                                        : VectorD(random_direction(random)).normalized();
        const VectorD centre(random.next(), random.next(), random.next());
        const Scene scene = build_scene(describe({shape(DiskDescription{centre, normal, 0.1 + random.next()}),
                                                  shape(SphereDescription{{9, 9, 9}, 1.0, false})}));
        const Disk& disk = std::get<Disk>(scene.shapes[0].geometry);
        for (int k = 0; k < 200; ++k) {
            const Imath::V2f inside = sample_unit_disc(random.next_2d()) * (0.999f * disk.radius);
            const Vector point = disk.centre + disk.frame.to_world({inside.x, inside.y, 0});
            const Vector origin = point + random_direction(random) * (0.01f * disk.radius);
            if (std::abs((origin - point).dot(disk.frame.normal)) < 1e-3f * disk.radius) continue;
            const auto hit = intersect(scene, {origin, towards(origin, point)});
            ASSERT_TRUE(hit);
            ASSERT_EQ(hit->shape, 0u);
            EXPECT_LT((hit->position - point).length(), 20 * epsilon);
            EXPECT_EQ(hit->geometric_normal, disk.frame.normal);
        }
    }
}

TEST(Intersect, MeetsACubeOnItsFacesWithNormalsOutwards) {
    const Scene scene = build_scene(describe({shape(cube({5, 6, 7}, 2.0))}));
    RandomStream random = stream_of_scenes();
    for (int i = 0; i < 10'000; ++i) {
        const bool from_inside = i % 2 == 0;
        const Vector target(random.next() - 0.5f, random.next() - 0.5f, random.next() - 0.5f);
        const Vector origin = from_inside ? target * 0.9f : random_direction(random) * 3.0f;
        const Vector direction = from_inside ? random_direction(random) : towards(origin, target);
        const auto hit = intersect(scene, {origin, direction});
        ASSERT_TRUE(hit);
        int face = 0;
        for (int axis = 1; axis < 3; ++axis)
            if (std::abs(hit->position[axis]) > std::abs(hit->position[face])) face = axis;
        EXPECT_FLOAT_EQ(std::abs(hit->position[face]), 0.5f);
        EXPECT_FLOAT_EQ(hit->geometric_normal[face], std::copysign(1.0f, hit->position[face]));
        EXPECT_EQ(hit->geometric_normal.dot(direction) > 0.0f, from_inside);
        EXPECT_LT((hit->position - (origin + direction * hit->distance)).length(), 20 * epsilon);
    }
}

TEST(Intersect, ShadingNormalsAreInterpolatedAndStayOnTheGeometricSide) {
    MeshDescription mesh = square({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const VectorD left = VectorD(-1, 0, 1).normalized();
    const VectorD right = VectorD(1, 0, 1).normalized();
    mesh.normals = {left, right, right, left};
    const Scene smooth = build_scene(describe({shape(mesh)}));
    const auto middle = intersect(smooth, {{0, 0.1f, 1}, {0, 0, -1}});
    EXPECT_LT((middle->shading_normal - Vector(0, 0, 1)).length(), 4 * epsilon);
    const auto near_right = intersect(smooth, {{0.25f, 0.1f, 1}, {0, 0, -1}});
    EXPECT_LT((near_right->shading_normal - Vector(0.5f, 0, 1).normalized()).length(), 4 * epsilon);
    EXPECT_EQ(near_right->geometric_normal, Vector(0, 0, 1));

    for (VectorD& normal : mesh.normals) normal = -normal;
    const Scene turned = build_scene(describe({shape(mesh)}));
    EXPECT_EQ(intersect(turned, {{0.25f, 0.1f, 1}, {0, 0, -1}})->shading_normal, near_right->shading_normal);

    for (VectorD& normal : mesh.normals) normal = VectorD(0.0);
    const Scene without = build_scene(describe({shape(mesh)}));
    EXPECT_EQ(intersect(without, {{0.25f, 0.1f, 1}, {0, 0, -1}})->shading_normal, Vector(0, 0, 1));
}

TEST(Intersect, TextureCoordinatesAreInterpolated) {
    MeshDescription mesh = square({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const Scene scene = build_scene(describe({shape(mesh)}));
    const auto hit = intersect(scene, {{-0.25f, 0.375f, 1}, {0, 0, -1}});
    EXPECT_NEAR(hit->texture_coordinate.x, 0.25f, 4 * epsilon);
    EXPECT_NEAR(hit->texture_coordinate.y, 0.875f, 4 * epsilon);
}

TEST(Intersect, TrianglesWithoutAreaNeverGiveANormalThatIsNotANumber) {
    MeshDescription mesh = square({0, 0, 0}, {4, 0, 0}, {0, 4, 0});
    mesh.positions.insert(mesh.positions.end(), {{-1, 0, 1}, {1, 0, 1}, {3, 0, 1}});
    mesh.triangles.insert(mesh.triangles.end(), {{4, 5, 6}, {4, 4, 4}, {4, 5, 5}});
    const Scene scene = build_scene(describe({shape(mesh)}));
    RandomStream random = stream_of_scenes();
    for (int i = 0; i < 10'000; ++i) {
        const Vector origin(random.next() - 0.5f, random.next() - 0.5f, 0.5f);
        const Vector on_sliver = to_box(scene, {4.0 * random.next() - 1.0, 0, 1});
        const auto hit = intersect(scene, {origin, towards(origin, on_sliver)});
        if (!hit) continue;
        expect_unit(hit->geometric_normal);
        expect_unit(hit->shading_normal);
        EXPECT_TRUE(is_finite(hit->position));
    }
}

TEST(Intersect, NothingEscapesAClosedBoxOrSphere) {
    std::vector<ShapeDescription> walls;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0}) {
            VectorD centre(0.0), x(0.0), y(0.0);
            centre[axis] = side;
            x[(axis + 1) % 3] = -side;
            y[(axis + 2) % 3] = 1.0;
            walls.push_back(shape(square(centre, x, y)));
        }
    MeshDescription inside_out = cube({1, 2, 3}, 1.0 / 3.0);
    for (auto& triangle : inside_out.triangles) std::swap(triangle.y, triangle.z);
    const Scene box = build_scene(describe(walls));
    const Scene mesh = build_scene(describe({shape(inside_out)}));
    const Scene ball = build_scene(describe({shape(SphereDescription{{0, 0, 0}, 1.0, true})}));
    RandomStream random = stream_of_scenes();
    for (const Scene* scene : {&box, &mesh, &ball})
        for (int i = 0; i < 100'000; ++i) {
            const auto hit = intersect(*scene, {{0.1f, -0.2f, 0.05f}, random_direction(random)});
            ASSERT_TRUE(hit);
            const auto surface = orient(*scene, *hit, hit->geometric_normal);  // into the room
            ASSERT_TRUE(surface);
            const Vector direction = surface->frame.to_world(sample_cosine_hemisphere(random.next_2d()));
            ASSERT_TRUE(intersect(
                *scene, {offset_from_surface(surface->position, surface->geometric_normal, direction), direction}));
        }
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(IsOccluded, SeesWhatLiesBetweenAndNothingBeyond) {
    for (const Geometry& wall :
         {Geometry(square({0, 0, 0}, {1, 0, 0}, {0, 1, 0})), Geometry(DiskDescription{{0, 0, 0}, {0, 0, 1}, 1.0}),
          Geometry(SphereDescription{{0, 0, 0}, 1.0, false})}) {
        const Scene scene = build_scene(describe({shape(wall)}));
        EXPECT_TRUE(is_occluded(scene, {{0.1f, 0, 2}, {0.1f, 0, -2}}));
        EXPECT_FALSE(is_occluded(scene, {{0.1f, 0, 2}, {0.1f, 0, 0.6f}}));
        EXPECT_FALSE(is_occluded(scene, {{0.1f, 0, 2}, {2, 0, 2}}));
        EXPECT_FALSE(is_occluded(scene, {{0.1f, 0, 2}, {0.1f, 0, 2}}));
    }
}

TEST(IsOccluded, PointsMovedOffTwoWallsThatFaceEachOtherSeeEachOther) {
    const Scene scene = build_scene(
        describe({shape(square({0, 0, -1}, {1, 0, 0}, {0, 1, 0})), shape(square({0, 0, 1}, {-1, 0, 0}, {0, 1, 0}))}));
    RandomStream random = stream_of_scenes();
    for (int i = 0; i < 20'000; ++i) {
        const Vector below(random.next() - 0.5f, random.next() - 0.5f, -0.5f);
        const Vector above(random.next() - 0.5f, random.next() - 0.5f, 0.5f);
        EXPECT_FALSE(is_occluded(scene, {offset_from_surface(below, {0, 0, 1}, above - below),
                                         offset_from_surface(above, {0, 0, -1}, below - above)}));
    }
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(Orient, TheBackOfAOneSidedMaterialIsBlack) {
    SceneDescription description = describe({floor_of_eight()});
    description.materials[0].two_sided = false;
    const Scene scene = build_scene(description);
    const auto from_above = intersect(scene, {{0, 0, 1}, {0, 0, -1}});
    const auto from_below = intersect(scene, {{0, 0, -1}, {0, 0, 1}});
    EXPECT_TRUE(orient(scene, *from_above, {0, 0, 1}));
    EXPECT_FALSE(orient(scene, *from_below, {0, 0, -1}));
}

TEST(Orient, ATwoSidedMaterialFacesWhoeverLooks) {
    const Scene scene = build_scene(describe({floor_of_eight()}));
    for (const float side : {-1.0f, 1.0f}) {
        const auto hit = intersect(scene, {{0, 0, side}, {0, 0, -side}});
        EXPECT_EQ(hit->geometric_normal, Vector(0, 0, 1));
        const auto surface = orient(scene, *hit, {0, 0, side});
        ASSERT_TRUE(surface);
        EXPECT_EQ(surface->geometric_normal, Vector(0, 0, side));
        EXPECT_EQ(surface->frame.normal, Vector(0, 0, side));
        EXPECT_TRUE(sides_agree(*surface, {0.6f, 0, 0.8f * side}));
    }
}

TEST(Orient, ABlackMaterialReflectsNothing) {
    SceneDescription description = describe({floor_of_eight()});
    description.materials[0].bsdf = Diffuse{Color(0.0f)};
    const Scene scene = build_scene(description);
    EXPECT_FALSE(orient(scene, *intersect(scene, {{0, 0, 1}, {0, 0, -1}}), {0, 0, 1}));
}

TEST(Orient, DirectionsOnWhoseSideTheNormalsDisagreeAreRefused) {
    MeshDescription mesh = square({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    mesh.normals.assign(4, VectorD(0.8, 0, 0.6));
    const Scene scene = build_scene(describe({shape(mesh)}));
    const auto hit = intersect(scene, {{0, 0.1f, 1}, {0, 0, -1}});
    const Vector between = Vector(-0.9f, 0, 0.1f).normalized();  // above the triangle, below the shading normal's plane
    EXPECT_FALSE(orient(scene, *hit, between));
    const auto surface = orient(scene, *hit, {0, 0, 1});
    ASSERT_TRUE(surface);
    EXPECT_FALSE(sides_agree(*surface, between));
    EXPECT_FALSE(sides_agree(*surface, -between));
    EXPECT_TRUE(sides_agree(*surface, {0, 0, 1}));
}

// ---------------------------------------------------------------------------------------------------------------------

/// A scene with every kind of shape and light, `scale` times as large and moved by `shift` after that. A point light's
/// intensity grows with the square, so that it lights the same.
Scene make_variety(double scale, const VectorD& shift = VectorD(0.0)) {
    const auto at = [&](double x, double y, double z) { return VectorD(x, y, z) * scale + shift; };
    SceneDescription description = describe(
        {shape(square(at(0.1, 0.2, 0), VectorD(3, 0, 0) * scale, VectorD(0, 2.3, 0) * scale), ColorD(0.1, 0.2, 0.3)),
         shape(SphereDescription{at(1.3, 0, 0.7), 0.3 * scale, false}, ColorD(2.0)),
         shape(DiskDescription{at(-1.1, 0.4, 1.9), VectorD(0.6, 0, -0.8), 0.7 * scale}, ColorD(1.0, 0.5, 0.25))},
        {{at(0.3, 0.1, 2.5), ColorD(3.0) * scale * scale, "test:2"}});
    const VectorD eye = at(0.5, -7.7, 1.1);
    description.camera.to_world = Matrix(-1, 0, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, eye.x, eye.y, eye.z, 1);
    return build_scene(description);
}

/// Everything that rays and lights are computed from, one number after the other.
std::vector<double> numbers_of(const Scene& scene) {
    std::vector<double> numbers{scene.total_power, scene.bounding_radius, scene.camera.pixel_angle};
    const auto add = [&](const auto& v) { numbers.insert(numbers.end(), {v.x, v.y, v.z}); };
    for (const Vector& position : std::get<TriangleMesh>(scene.shapes[0].geometry).positions) add(position);
    const Sphere& sphere = std::get<Sphere>(scene.shapes[1].geometry);
    add(sphere.centre);
    const Disk& disk = std::get<Disk>(scene.shapes[2].geometry);
    add(disk.centre);
    add(disk.frame.tangent);
    add(scene.camera.position);
    add(scene.camera.forward);
    add(scene.camera.right);
    add(scene.camera.down);
    numbers.insert(numbers.end(), {sphere.radius, disk.radius});
    for (const Shape& each : scene.shapes) numbers.push_back(each.area);
    for (const Emitter& emitter : scene.emitters) {
        add(emitter.power);
        numbers.insert(numbers.end(), {emitter.choice_probability, emitter.choice_cdf});
    }
    return numbers;
}

TEST(BuildScene, ScalingByAPowerOfTwoChangesNoBit) {
    const Scene original = make_variety(1.0);
    for (const double scale : {0x1p-40, 0.5, 1024.0}) {
        const Scene scaled = make_variety(scale);
        EXPECT_EQ(numbers_of(scaled), numbers_of(original)) << scale;
        EXPECT_EQ(scaled.unit_length, scale * original.unit_length);
    }
}

TEST(BuildScene, AnotherUnitOfLengthOrAnotherPlaceChangesOnlyRoundings) {
    const Scene original = make_variety(1.0);
    const std::vector<double> expected = numbers_of(original);
    const std::vector<Scene> others = [] {
        std::vector<Scene> scenes;
        for (const double scale : {1e-4, 1e4, 1e-30, 1e30}) scenes.push_back(make_variety(scale));
        scenes.push_back(make_variety(1.0, {300, -200, 1000}));
        return scenes;
    }();
    for (const Scene& other : others) {
        const std::vector<double> numbers = numbers_of(other);
        ASSERT_EQ(numbers.size(), expected.size());
        for (std::size_t i = 0; i < numbers.size(); ++i)
            EXPECT_NEAR(numbers[i], expected[i], 4 * epsilon * std::max(1.0, std::abs(expected[i]))) << i;
    }
}

TEST(BuildScene, FillsTheUnitBoxAndKeepsAreasInIt) {
    const Scene scene =
        build_scene(describe({shape(SphereDescription{{3, 4, 5}, 2.0, false}), shape(cube({10, 4, 5}, 1.0))}));
    EXPECT_DOUBLE_EQ(scene.unit_length, 10.0);
    EXPECT_EQ(scene.centre, VectorD(6, 4, 5));
    EXPECT_NEAR(scene.shapes[0].area, 4.0 * pi * 0.04, 1e-7);
    EXPECT_NEAR(scene.shapes[1].area, 6.0 * 0.04, 1e-7);
    EXPECT_NEAR(scene.bounding_radius, 0.5 * std::sqrt(1.0 + 0.16 + 0.16), 1e-6);
}

TEST(BuildScene, WithoutSurfacesTheLightsMakeTheBoxAndWithoutLightsThereIsNone) {
    const Scene lights =
        build_scene(describe({}, {{{1, 0, 0}, ColorD(1.0), "test:2"}, {{5, 0, 0}, ColorD(1.0), "test:3"}}));
    EXPECT_EQ(lights.unit_length, 4.0);
    EXPECT_EQ(lights.bounding_radius, 0.0f);
    EXPECT_EQ(std::get<PointLight>(lights.emitters[1].kind).position, Vector(0.5f, 0, 0));
    const Scene nothing = build_scene(describe({}));
    EXPECT_EQ(nothing.unit_length, 1.0);
    EXPECT_FALSE(intersect(nothing, {{0, 0, 0}, {0, 0, 1}}));
    EXPECT_FALSE(is_occluded(nothing, {{0, 0, 0}, {0, 0, 1}}));
}

TEST(BuildScene, AMeshWithoutTrianglesIsHarmless) {
    const Scene scene = build_scene(describe({shape(MeshDescription{}, ColorD(1.0)), floor_of_eight()}));
    EXPECT_TRUE(scene.emitters.empty());
    const auto hit = intersect(scene, {{0, 0.1f, 1}, {0, 0, -1}});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->shape, 1u);
}

TEST(BuildScene, RefusesWhatCannotBeRendered) {
    const auto message = [](const SceneDescription& description,
                            std::optional<Resolution> resolution = std::nullopt) -> std::string {
        try {
            build_scene(description, resolution);
        } catch (const InputError& error) {
            return error.what();
        }
        return "no error";
    };
    const auto changed = [](const auto& change) {
        SceneDescription description = describe({floor_of_eight()}, {{{0, 0, 1}, ColorD(1.0), "test:2"}});
        change(description, std::get<MeshDescription>(description.shapes[0].geometry));
        return description;
    };
    const double nan = std::nan("");
    using Description = SceneDescription;
    EXPECT_EQ(message(changed([&](Description&, MeshDescription& mesh) { mesh.positions[2].y = nan; })),
              "test:1: vertex 3 is not finite");
    EXPECT_EQ(message(changed([&](Description&, MeshDescription& mesh) { mesh.triangles[1].z = 4; })),
              "test:1: triangle 2: expected vertices below 4, got 0 2 4");
    EXPECT_EQ(message(changed([&](Description&, MeshDescription& mesh) { mesh.normals.assign(3, VectorD(0, 0, 1)); })),
              "test:1: expected a normal for each of 4 vertices, got 3");
    EXPECT_EQ(message(changed([&](Description&, MeshDescription& mesh) { mesh.normals.assign(4, VectorD(nan)); })),
              "test:1: normal 1 is not finite");
    EXPECT_EQ(message(changed([&](Description&, MeshDescription& mesh) {
                  mesh.texture_coordinates.assign(4, Imath::V2d(0, nan));
              })),
              "test:1: texture coordinates 1 are not finite");
    EXPECT_EQ(message(changed([&](Description& d, MeshDescription&) { d.materials[0].bsdf = Diffuse{Color(1.5f)}; })),
              "material \"grey\": reflectance: expected values in [0, 1], got 1.5 1.5 1.5");
    EXPECT_EQ(message(changed([&](Description& d, MeshDescription&) { d.shapes[0].material = 1; })),
              "test:1: material 1 of 1");
    EXPECT_EQ(message(changed([&](Description& d, MeshDescription&) { d.shapes[0].radiance = ColorD(1, -1, 0); })),
              "test:1: radiance: expected finite values of at least 0, got 1 -1 0");
    EXPECT_EQ(message(changed([&](Description& d, MeshDescription&) {
                  std::get<PointLightDescription>(d.lights[0]).intensity.y = INFINITY;
              })),
              "test:2: intensity: expected finite values of at least 0, got 1 inf 1");
    EXPECT_EQ(message(changed([&](Description& d, MeshDescription&) {
                  std::get<PointLightDescription>(d.lights[0]).position.y = nan;
              })),
              "test:2: position is not finite");
    EXPECT_EQ(message(changed([&](Description& d, MeshDescription&) {
                  std::get<PointLightDescription>(d.lights[0]).position.y = 1e60;
              })),
              "test:2: position: expected one nearer to the scene, which is 8 scene units large, got 0 1e+60 1");
    // Floats hold it, but not its square, which Embree needs.
    EXPECT_EQ(message(changed([&](Description& d, MeshDescription&) {
                  std::get<PointLightDescription>(d.lights[0]).position.y = 1e20;
              })),
              "test:2: position: expected one nearer to the scene, which is 8 scene units large, got 0 1e+20 1");
    EXPECT_EQ(message(changed([&](Description& d, MeshDescription&) { d.camera.fov_x = 180.0; })),
              "camera: expected a field of view in (0, 180) degrees, got 180");
    EXPECT_EQ(message(changed([&](Description& d, MeshDescription&) { d.camera.to_world[0][1] = nan; })),
              "camera: to_world: expected an invertible transform with finite values");
    EXPECT_EQ(message(changed([&](Description& d, MeshDescription&) { d.camera.to_world[3][2] = -1e60; })),
              "camera: expected a position nearer to the scene, which is 8 scene units large, got 0 0 -1e+60");
    EXPECT_EQ(message(changed([&](Description& d, MeshDescription&) { d.camera.to_world[3][2] = -1e20; })),
              "camera: expected a position nearer to the scene, which is 8 scene units large, got 0 0 -1e+20");
    EXPECT_EQ(message(changed([](Description&, MeshDescription&) {}), Resolution{0, 5}),
              "resolution: expected at least 1 x 1, got 0 x 5");
    EXPECT_EQ(message(describe({shape(SphereDescription{{0, 0, 0}, -1.0, false})})),
              "test:1: expected a finite centre and a radius above 0, got radius -1");
    EXPECT_EQ(message(describe({shape(DiskDescription{{0, 0, 0}, VectorD(nan), 1.0})})),
              "test:1: expected a disk's normal of unit length");
    EXPECT_EQ(message(describe({shape(SphereDescription{{0, 0, 0}, 1e-200, false})})),
              "test:1: the scene is 2e-200 scene units large around (0 0 0): beyond double precision");
    EXPECT_EQ(message(describe({shape(SphereDescription{{0, 0, 0}, 1e200, false})})),
              "test:1: the scene is 2e+200 scene units large around (0 0 0): beyond double precision");
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(Camera, SeesItsTargetInTheMiddleAndItsXToTheLeft) {
    SceneDescription description = describe({floor_of_eight()});
    description.camera.to_world = Matrix();  // at the origin, z forward, x to the left
    description.camera.fov_x = 90.0;
    const Scene scene = build_scene(description, Resolution{200, 100});
    EXPECT_LT((scene.camera.ray(100, 50, Imath::V2f(0.0f)).direction - Vector(0, 0, 1)).length(), 1e-6f);
    EXPECT_LT((scene.camera.ray(0, 50, Imath::V2f(0.0f)).direction - Vector(1, 0, 1).normalized()).length(), 1e-6f);
    EXPECT_LT((scene.camera.ray(100, 0, Imath::V2f(0.0f)).direction - Vector(0, 0.5f, 1).normalized()).length(), 1e-6f);
}

TEST(Camera, LooksAtItsTargetFromAnywhereAndIgnoresTheScaleOfItsTransform) {
    const VectorD eye(3, -7, 2), target(0.5, 0.25, 0);
    const VectorD forward = (target - eye).normalized();
    const VectorD left = VectorD(0, 0, 1).cross(forward).normalized();
    const VectorD up = forward.cross(left);
    for (const double s : {1.0, 250.0}) {
        SceneDescription description = describe({floor_of_eight()});
        description.camera.to_world = Matrix(s * left.x, s * left.y, s * left.z, 0, s * up.x, s * up.y, s * up.z, 0,
                                             s * forward.x, s * forward.y, s * forward.z, 0, eye.x, eye.y, eye.z, 1);
        const Scene scene = build_scene(description, Resolution{101, 51});
        const auto hit =
            intersect(scene, {scene.camera.position, scene.camera.ray(50.5, 25.5, Imath::V2f(0.0f)).direction});
        ASSERT_TRUE(hit);
        EXPECT_LT((hit->position - to_box(scene, target)).length(), 1e-6f);
        EXPECT_GT(scene.camera.ray(0, 25.5, Imath::V2f(0.0f)).direction.dot(Vector(left)), 0.0f);
        EXPECT_GT(scene.camera.ray(50.5, 0, Imath::V2f(0.0f)).direction.dot(Vector(up)), 0.0f);
    }
}

TEST(Camera, AnotherResolutionKeepsTheHorizontalFieldOfViewAndSquarePixels) {
    SceneDescription description = describe({floor_of_eight()});
    description.camera.fov_x = 60.0;
    for (const Resolution& resolution : {Resolution{768, 576}, Resolution{100, 300}, Resolution{1, 1}}) {
        const Camera camera = build_scene(description, resolution).camera;
        const double half_width = std::tan(pi / 6.0);
        EXPECT_EQ(camera.width, resolution.width);
        EXPECT_EQ(camera.height, resolution.height);
        EXPECT_NEAR(camera.right.length(), 2.0 * half_width, 1e-12);
        EXPECT_NEAR(camera.down.length() / resolution.height, camera.right.length() / resolution.width, 1e-12);
        EXPECT_NEAR(camera.pixel_angle, 2.0 * half_width / resolution.width, 1e-12);
    }
}

}  // namespace
}  // namespace photonlab
