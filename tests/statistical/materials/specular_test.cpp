// Mirrors and glass where the light is known: lossless glass is invisible in a uniform surround, what lies inside glass
// is as bright as thermal equilibrium says, mirrors continue a room; and where it is not known, photon methods against
// path tracing, meshes against the sphere that they stand for.
//
// Radiance in equilibrium is n^2 L in a medium of index n where it is L in air, for every surface that absorbs and
// emits alike; that is what the factor of refraction, 1 / eta^2, is tested by.

#include <gtest/gtest.h>

#include "scene/loader.h"
#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"
#include "tests/support/radius_rules.h"

namespace photonlab::test {
namespace {

constexpr double glass_index = 1.5;
constexpr double glass_over_air = glass_index * glass_index;  // of radiance in equilibrium

Material glass() {
    return {.id = "glass", .bsdf = Dielectric{}};
}

Material mirror(const Color& reflectance = Color(1.0f)) {
    return {.id = "mirror", .bsdf = Conductor{.reflectance = reflectance}, .two_sided = true};
}

struct Method {
    std::string name;
    MethodSettings settings;
    std::uint64_t passes;
};

/// Claims the mean of `value(image)` for each method and channel.
template <typename Value>
void expect_means(ClaimFamily& claims, const std::string& what, const Scene& scene, const std::vector<Method>& methods,
                  int seeds, const Value& value, const ColorD& expected, double share_found, double largest_error) {
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    for (const Method& method : methods) {
        std::vector<double> values[3];
        for (int seed = 1; seed <= seeds; ++seed) {
            const Image image = render(scene, hit_points, method.settings,
                                       {.passes = method.passes, .seed = static_cast<std::uint64_t>(seed)})
                                    .image;
            for (int c = 0; c < 3; ++c) values[c].push_back(value(image)[c]);
        }
        for (int c = 0; c < 3; ++c)
            claims.mean_is(what + ", " + method.name + ", channel " + std::to_string(c), values[c],
                           expected[c] * (method.settings.integrator == "path" ? 1.0 : share_found), largest_error);
    }
}

ColorD reflected(const Image& image) {
    return mean_of(image, direct_layer) + mean_of(image, gathered_layer);
}

/// The mean over pixels of the weights of the hit points on a material.
ColorD weight_on(const HitPoints& hit_points, std::uint16_t material) {
    ColorD sum(0.0);
    for (const HitPoint& point : hit_points.points)
        if (point.material == material) sum += ColorD(point.weight);
    return sum / static_cast<double>(pixel_count(hit_points));
}

std::vector<Method> all_methods(std::uint64_t path_passes, double radius, std::uint64_t photons,
                                std::uint64_t photon_passes) {
    return {
        {"path", {.integrator = "path"}, path_passes},
        {"ppm, direct sampled",
         {.alpha = 0.9, .radius = radius, .direct_samples = 16, .photons_per_pass = photons},
         photon_passes},
        {"ppm, direct by photons",
         {.alpha = 0.9, .radius = radius, .direct = DirectMode::Photons, .photons_per_pass = photons},
         photon_passes},
        {"photonmapper, direct by photons",
         {.integrator = "photonmapper", .radius = radius, .direct = DirectMode::Photons, .photons_per_pass = photons},
         photon_passes}};
}

// ---------------------------------------------------------------------------------------------------------------------
// Glass in a furnace: a hollow sphere that emits Le and reflects rho sends L = Le / (1 - rho) everywhere.

const Color furnace_colour(0.2f, 0.5f, 0.7f);
const ColorD furnace_radiance(1.0, 3.0, 2.0);
constexpr double furnace_gather_radius = 0.15;
/// Of photons on the hollow sphere: integrating_sphere_test.cpp says why.
constexpr double furnace_share_found =
    1.0 - furnace_gather_radius * furnace_gather_radius / (8.0 * sphere_radius * sphere_radius);

TEST(LosslessGlass, IsInvisibleInAUniformSurround) {
    SceneDescription description = hollow_sphere(furnace_colour, furnace_radiance, 10);
    description.materials.push_back(glass());
    description.shapes.push_back(sphere({0.4, 0.2, 0.9}, 0.9, false, 1));
    const Scene scene = build_scene(description);
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);

    // For the camera exactly, but for the branches cut: each stood for its weight, in glass for n^2 times as much.
    double missing = 0.0;
    int through_glass = 0;
    const std::vector<ColorD> emission = emission_image(hit_points, -1);
    for (const ColorD& pixel : emission) {
        const double share = pixel.y / furnace_radiance.y;
        EXPECT_LE(share, 1.0 + 1e-6);
        EXPECT_GE(share, 0.99);  // R = 0.99 sends (1 - R)^2 = 1e-4 outwards at each inner reflection: all cut
        missing += (1.0 - share) / static_cast<double>(emission.size());
    }
    for (const HitPoint& point : hit_points.points) through_glass += point.camera_edges > 1;
    EXPECT_GT(through_glass, 40);
    EXPECT_GE(missing, hit_points.weight_cut - 1e-6);
    EXPECT_LE(missing, hit_points.weight_cut * glass_over_air + 1e-6);
    EXPECT_LT(missing, 1e-3);

    ColorD expected;
    for (int c = 0; c < 3; ++c)
        expected[c] = (1.0 - missing) * furnace_radiance[c] * furnace_colour[c] / (1.0 - furnace_colour[c]);
    ClaimFamily claims;
    expect_means(claims, "reflected", scene, all_methods(16, furnace_gather_radius, 2500, 4), 16, reflected, expected,
                 furnace_share_found, 0.015);
}

// A diffuse ball inside a ball of glass, in the furnace. Where it reflects rho and emits (1 - rho) n^2 L, or reflects
// all and emits nothing, everything is in equilibrium: it has n^2 L in the glass, and the camera in air sees L wherever
// it looks. Without the factor of refraction it would be 2.25 times as bright. Its hit points are compared alone: their
// radiance is (what they emit and) n^2 L rho. On a convex ball r^2 / (8 R^2) of photons is refused
// (enclosures_test.cpp).
TEST(DiffuseBallInsideGlass, IsAsBrightAsItsSurround) {
    constexpr double ball_radius = 0.6;
    constexpr double gather_radius = 0.1;
    const double share_found = 1.0 - gather_radius * gather_radius / (8.0 * ball_radius * ball_radius);
    ClaimFamily claims;
    for (const Color& colour : {Color(0.4f, 0.6f, 0.8f), Color(1.0f)}) {
        SceneDescription description = hollow_sphere(furnace_colour, furnace_radiance);
        description.materials.push_back(glass());
        description.materials.push_back(diffuse(colour));
        ColorD surround;
        ColorD emitted;
        for (int c = 0; c < 3; ++c) {
            surround[c] = furnace_radiance[c] / (1.0 - furnace_colour[c]);
            emitted[c] = (1.0 - colour[c]) * glass_over_air * surround[c];
        }
        const VectorD centre(0.5, 0.3, 0.8);
        description.shapes.push_back(sphere(centre, 1.0, false, 1));
        description.shapes.push_back(sphere(centre, ball_radius, false, 2, emitted));
        description.camera = look_at({0.3, -0.4, -1.0}, centre, 6, 6, 25.0);
        const Scene scene = build_scene(description);

        const HitPoints hit_points = trace_hit_points(scene, 1, 1);
        const ColorD on_ball = weight_on(hit_points, 2);
        const ColorD on_wall = weight_on(hit_points, 0);
        EXPECT_GT(on_ball.x * glass_over_air, 0.9);
        // All that the camera sees, in equilibrium: L.
        EXPECT_NEAR(on_ball.x * glass_over_air + on_wall.x, 1.0, hit_points.weight_cut * glass_over_air + 1e-6);

        ColorD expected;
        for (int c = 0; c < 3; ++c)
            expected[c] = surround[c] * (on_ball[c] * glass_over_air * colour[c] + on_wall[c] * furnace_colour[c]);
        const ColorD seen = mean_of(render(scene, {.integrator = "path"}, {}).image, emission_layer);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(seen[c], on_ball[c] * emitted[c] + on_wall[c] * furnace_radiance[c], 1e-5 * surround[c]);
        expect_means(claims, "albedo " + std::to_string(colour.x), scene, all_methods(60, gather_radius, 3000, 6), 16,
                     reflected, expected, share_found, 0.03);
    }
}

// ---------------------------------------------------------------------------------------------------------------------

// Two plates, 2 x 2 and 0.5 apart, between perfect mirrors: as infinite planes, B1 = M / (1 - rho1 rho2) and B2 = rho2
// B1, exactly. Seen straight and in one of the mirrors.
TEST(MirrorWalls, MakePlatesInfinitePlanes) {
    const Color first_colour(0.5f, 0.3f, 0.7f);
    const Color second_colour(0.8f, 0.6f, 0.4f);
    const ColorD exitance(2.0, 5.0, 3.0);
    SceneDescription description;
    description.materials = {diffuse(first_colour), diffuse(second_colour), mirror()};
    const VectorD x(2, 0, 0), y(0, 0.5, 0), z(0, 0, 2), corner(-1, 0, -1);
    description.shapes = {shape(parallelogram(corner, z, x), 0, exitance / pi),
                          shape(parallelogram(corner + y, x, z), 1),
                          shape(parallelogram(corner, y, z), 2),
                          shape(parallelogram(corner + x, z, y), 2),
                          shape(parallelogram(corner, x, y), 2),
                          shape(parallelogram(corner + z, y, x), 2)};
    ColorD first;
    ColorD second;
    for (int c = 0; c < 3; ++c) {
        const double radiance = exitance[c] / (1.0 - static_cast<double>(first_colour[c]) * second_colour[c]) / pi;
        second[c] = second_colour[c] * radiance;
        first[c] = radiance - exitance[c] / pi;  // emission is in a layer of its own
    }
    constexpr double radius = 0.4;  // of discs inside the plates: light is uniform, there is no bias
    ClaimFamily claims;
    struct View {
        std::string name;
        VectorD target;
        ColorD radiance;
        int edges;
    };
    for (const View& view :
         {View{"the emitting plate", {0, 0, 0}, first, 1}, View{"the other plate", {0, 0.5, 0}, second, 1},
          // (1.55, 0, 0) is the image of (0.45, 0, 0) in the mirror at x = 1.
          View{"the emitting plate in a mirror", {1.55, 0, 0}, first, 2}}) {
        description.camera = look_at({0.5, 0.3, 0.2}, view.target);
        const Scene scene = build_scene(description);
        const HitPoints hit_points = trace_hit_points(scene, 1, 1);
        ASSERT_EQ(hit_points.points.size(), 1u);
        EXPECT_EQ(hit_points.points[0].camera_edges, view.edges);
        expect_means(claims, view.name, scene, all_methods(800, radius, 1500, 5), 16, reflected, view.radiance, 1.0,
                     0.03);
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// The repository's own scenes, small: photons against paths, layer by layer.

struct SmallScene {
    std::string name;
    double radius;  ///< scene units
    std::uint64_t path_passes;

    Scene build() const {
        return build_scene(load_scene_file(std::string(PHOTONLAB_SOURCE_DIR) + "/scenes/" + name + "/scene.xml"),
                           Resolution{24, 24});
    }
};

/// Image means of the layers, mean over channels, a value a seed.
struct LayerMeans {
    std::vector<double> direct, gathered, both;
    std::vector<Color> emission;  ///< pixels; they do not depend on the seed
};

LayerMeans layer_means(const Scene& scene, const HitPoints& hit_points, const MethodSettings& method,
                       std::uint64_t passes) {
    LayerMeans means;
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
        const Image image = render(scene, hit_points, method, {.passes = passes, .seed = seed}).image;
        means.direct.push_back(mean_channel(mean_of(image, direct_layer)));
        means.gathered.push_back(mean_channel(mean_of(image, gathered_layer)));
        means.both.push_back(means.direct.back() + means.gathered.back());
        if (seed == 1) means.emission = *image.find(emission_layer);
        EXPECT_EQ(*image.find(emission_layer), means.emission);
    }
    return means;
}

// Image means, so that the disc of the gather mostly moves light within the image; what is lost is 0.21 r of the light
// along the edges of surfaces (docs/theory.md, section 4, integrated over the distance). For walls of width w lit all
// over that is 4 x 0.21 r / w: 0.9% of the Cornell box (w = 550, r = 6), 0.6% of the others; 1% is allowed for.
TEST(ScenesOfMirrorsAndGlass, HaveTheSameMeansByPathsAndByPhotons) {
    constexpr double bias = 0.01;
    ClaimFamily claims;
    for (const SmallScene& small : {SmallScene{"cornell-spheres", 6.0, 100}, SmallScene{"glass-sphere", 0.4, 170},
                                    SmallScene{"water", 0.03, 320}}) {
        const Scene scene = small.build();
        const HitPoints hit_points = trace_hit_points(scene, 1, 1);
        const auto means_of = [&](const MethodSettings& method, std::uint64_t passes) {
            return layer_means(scene, hit_points, method, passes);
        };
        const LayerMeans path = means_of({.integrator = "path"}, small.path_passes);
        const LayerMeans ppm =
            means_of({.alpha = 0.9, .radius = small.radius, .direct_samples = 4, .photons_per_pass = 20'000}, 3);
        claims.means_agree(small.name + ", ppm, direct", ppm.direct, path.direct, 0.005);
        claims.means_agree(small.name + ", ppm, gathered", ppm.gathered, path.gathered, 0.045, bias);
        const LayerMeans photons = means_of(
            {.alpha = 0.9, .radius = small.radius, .direct = DirectMode::Photons, .photons_per_pass = 20'000}, 3);
        claims.means_agree(small.name + ", ppm, direct by photons", photons.gathered, path.both, 0.035, bias);
        const LayerMeans map =
            means_of({.integrator = "photonmapper", .radius = small.radius, .photons_per_pass = 40'000}, 1);
        claims.means_agree(small.name + ", photonmapper, gathered", map.gathered, path.gathered, 0.045, bias);
        for (const LayerMeans* means : {&ppm, &photons, &map}) EXPECT_EQ(means->emission, path.emission) << small.name;
    }
}

// Every radius rule, over points that stay and points that are new at the same places, from a disc of half the size or
// the tenth photon: direct and gathered light beside paths, and the gathered light beside that of the first rule, whose
// photons are the same, which sees more. Blurs that differ move little light out of the image.
TEST(ScenesOfMirrorsAndGlass, HaveTheMeansOfPathsByEveryRadiusRule) {
    constexpr double bias = 0.005;
    ClaimFamily claims;
    for (const SmallScene& small : {SmallScene{"cornell-spheres", 3.0, 200}, SmallScene{"glass-sphere", 0.2, 400}}) {
        const Scene scene = small.build();
        const HitPoints hit_points = trace_hit_points(scene, 1, 1);
        const LayerMeans path = layer_means(scene, hit_points, {.integrator = "path"}, small.path_passes);
        const MethodSettings base{.radius = small.radius, .direct_samples = 4, .photons_per_pass = 20'000};
        std::vector<NamedMethod> methods = methods_by_every_radius_rule(base);
        std::erase_if(methods, [](const NamedMethod& method) { return method.settings.positions != Positions::Grid; });
        methods.push_back({"sppm of one branch", base});
        methods.back().settings.integrator = "sppm";
        methods.back().settings.branches = Branches::One;
        std::vector<double> of_first;
        for (const NamedMethod& method : methods) {
            const LayerMeans means = layer_means(scene, hit_points, method.settings, 3);
            claims.means_agree(small.name + ", " + method.name + ", direct", means.direct, path.direct, 0.005);
            claims.means_agree(small.name + ", " + method.name + ", gathered", means.gathered, path.gathered, 0.06,
                               bias);
            if (of_first.empty()) of_first = means.gathered;
            claims.means_are(small.name + ", " + method.name + ", beside the first rule", means.gathered, of_first,
                             0.035, bias);
        }
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// Meshes for spheres.

/// A sphere of `rows` rows of `2 rows` quadrangles, its vertices on the sphere, with the sphere's normals or none.
MeshDescription sphere_mesh(const VectorD& centre, double radius, int rows, bool smooth) {
    MeshDescription mesh;
    const int columns = 2 * rows;
    for (int row = 0; row <= rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const double theta = pi * row / rows;
            const double phi = pi * (column + 0.5 * (row % 2)) * 2.0 / columns;
            const VectorD outward(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
            mesh.positions.push_back(centre + outward * radius);
            if (smooth) mesh.normals.push_back(outward);
        }
    const auto index = [&](int row, int column) {
        return static_cast<std::uint32_t>(row * columns + column % columns);
    };
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            const int shift = row % 2;
            // Rows are turned by half a column against each other.
            if (row > 0)
                mesh.triangles.emplace_back(index(row, column), index(row, column + 1), index(row + 1, column + shift));
            if (row < rows - 1)
                mesh.triangles.emplace_back(index(row, column + 1 - shift), index(row + 1, column + 1),
                                            index(row + 1, column));
        }
    return mesh;
}

SceneDescription ball_in_coloured_box(Geometry ball, const Material& material) {
    SceneDescription scene = hollow_cube(Color(1.0f), std::nullopt);
    scene.materials.push_back(diffuse(Color(0.5f, 0.2f, 0.0f)));
    scene.materials.push_back(material);
    scene.shapes[1].material = 1;  // x = 1
    scene.shapes[3].material = 1;  // y = 1
    scene.shapes.push_back({std::move(ball), 2, std::nullopt, "test"});
    scene.camera = look_at({-0.1, 0.2, -0.9}, {0.1, 0.0, 0.3}, 128, 128, 50.0);
    return scene;
}

ColorD mean_colour(const HitPoints& hit_points, const Scene& scene) {
    ColorD sum(0.0);
    for (const HitPoint& point : hit_points.points)
        sum += ColorD(point.weight * std::get<Diffuse>(scene.materials[point.material].bsdf).reflectance);
    return sum / static_cast<double>(pixel_count(hit_points));
}

// What the camera sees in a ball of n rows, as the mean of the walls' colours. With the sphere's normals its directions
// are right, and what is lost are directions for which the two normals disagree: those within about d = pi / (2 n) sqrt
// 2 of grazing, a share d^2 = 4.9 / n^2 of the ball, which fills half of the image; a part of it is met by the mirror
// (1 / n^2 is seen), for glass on both ways. Flat faces turn each ray by d and the errors cancel, but not where the
// reflectance of glass has its square roots, at the critical angle and at grazing: measured, below 0.5 / n^1.5.
TEST(SphereMeshes, LookMoreLikeTheSphereTheMoreTrianglesTheyHave) {
    const VectorD centre(0.1, 0.0, 0.3);
    for (const Material& material : {mirror(), glass()}) {
        const auto seen = [&](Geometry ball) {
            const Scene scene = build_scene(ball_in_coloured_box(std::move(ball), material));
            return mean_colour(trace_hit_points(scene, 1, 1), scene);
        };
        const ColorD exact = seen(SphereDescription{centre, 0.5, false});
        for (const bool smooth : {true, false})
            for (const int rows : {4, 8, 16, 32, 64}) {
                const ColorD mesh = seen(sphere_mesh(centre, 0.5, rows, smooth));
                const double bound = smooth ? 2.0 / (rows * rows) : 0.5 / std::pow(rows, 1.5);
                for (int c = 0; c < 3; ++c)
                    EXPECT_NEAR(mesh[c], exact[c], bound)
                        << material.id << (smooth ? ", smooth, " : ", flat, ") << rows;
            }
    }
}

/// Flux of the caustic of a ball under a lamp, relative to the lamp's power: within 0.3 of where it is brightest, and
/// all that reaches the floor. One value a seed.
struct CausticFlux {
    std::vector<double> bright;
    std::vector<double> all;
};

CausticFlux caustic_flux(Geometry ball, const Material& material) {
    SceneDescription description;
    description.materials = {diffuse(Color(0.5f)), material, diffuse(Color(0.0f))};
    description.shapes = {disk({0, 0, 0}, {0, 1, 0}, 5.0, 0),
                          {std::move(ball), 1, std::nullopt, "test"},
                          disk({0.5, 3, 0}, {0, -1, 0}, 0.3, 2, ColorD(1.0))};
    const Scene scene = build_scene(description);
    CausticFlux result;
    constexpr std::uint64_t paths = 40'000;
    for (std::uint64_t seed = 1; seed <= 16; ++seed) {
        double bright = 0.0;
        double all = 0.0;
        for (const Photon& photon : trace_photons(scene, {.paths = paths, .seed = seed}, 1, 1).photons) {
            if (!photon.caustic) continue;
            const VectorD position = VectorD(photon.position) * scene.unit_length + scene.centre;
            const double power = static_cast<double>(photon.power.x) / paths;
            all += power;
            if ((position - VectorD(-0.15, 0.0, 0.0)).length() < 0.3) bright += power;
        }
        result.bright.push_back(bright);
        result.all.push_back(all);
    }
    return result;
}

// The caustic of n rows lacks what the camera's view lacks, more strongly: the lamp lights the rim of the ball as much
// as its middle, at both surfaces. Measured at 4 to 32 rows: below 4 / n^2 with the sphere's normals, so 0.4% at 32
// rows; with flat faces below 6 / n^2 of all light, and of the bright disc, off which they throw some, below 10 / n^2.
TEST(SphereMeshes, ThrowTheSpheresCaustic) {
    const VectorD centre(0.0, 0.9, 0.0);
    const SphereDescription sphere{centre, 0.6, false};
    constexpr double squared_rows = 32.0 * 32.0;
    ClaimFamily claims;

    const CausticFlux exact = caustic_flux(sphere, glass());
    const CausticFlux smooth = caustic_flux(sphere_mesh(centre, 0.6, 32, true), glass());
    const CausticFlux flat = caustic_flux(sphere_mesh(centre, 0.6, 32, false), glass());
    claims.means_agree("glass, smooth, all", smooth.all, exact.all, 0.007, 4.0 / squared_rows);
    claims.means_agree("glass, smooth, bright", smooth.bright, exact.bright, 0.007, 4.0 / squared_rows);
    claims.means_agree("glass, flat, all", flat.all, exact.all, 0.007, 6.0 / squared_rows);
    claims.means_agree("glass, flat, bright", flat.bright, exact.bright, 0.007, 10.0 / squared_rows);

    // The loss falls with the number of triangles: the same paths were drawn, so most of the noise is common.
    const CausticFlux coarse = caustic_flux(sphere_mesh(centre, 0.6, 8, true), glass());
    const CausticFlux finer = caustic_flux(sphere_mesh(centre, 0.6, 16, true), glass());
    const auto loss = [&](const CausticFlux& mesh) {
        std::vector<double> difference(exact.all);
        for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= mesh.all[i];
        return difference;
    };
    std::vector<double> quarter = loss(coarse);
    for (double& value : quarter) value /= 4.0;
    claims.means_agree("glass, smooth: 4 times the triangles, a quarter of the loss", loss(finer), quarter, 0.2, 0.2);

    const CausticFlux mirrored = caustic_flux(sphere, mirror());
    claims.means_agree("mirror, smooth, all", caustic_flux(sphere_mesh(centre, 0.6, 32, true), mirror()).all,
                       mirrored.all, 0.03, 4.0 / squared_rows);
    claims.means_agree("mirror, flat, all", caustic_flux(sphere_mesh(centre, 0.6, 32, false), mirror()).all,
                       mirrored.all, 0.03, 6.0 / squared_rows);
}

/// Lets the mesh's normals lean from its own towards its first edge.
void lean_normals(ShapeDescription& shape, double angle) {
    auto& mesh = std::get<MeshDescription>(shape.geometry);
    const VectorD first = (mesh.positions[1] - mesh.positions[0]).normalized();
    const VectorD second = (mesh.positions[3] - mesh.positions[0]).normalized();
    mesh.normals.assign(4, first.cross(second) * std::cos(angle) + first * std::sin(angle));
}

// A mirror and a sheet of glass whose interpolated normals lean from their own by `lean`, each under a small lamp that
// shines straight at it, seen where its caustic falls. A photon's weight needs the adjoint's correction at specular
// surfaces as at diffuse ones, |wi.ns wo.ng| / |wi.ng wo.ns|. On the axis it is cos(2 lean) = 0.54 for the mirror and
// cos(lean) cos(lean - t) / cos(t) = 0.76 for the glass, sin(t) = sin(lean) / n. (Under wide light it would hide: over
// all directions the flux is the same.) The caustics have no edges here: their irradiance falls over lengths of about
// 1, and the gather's bias is below 10 r^2 / 8 = 2% at r = 0.12.
TEST(LeaningNormals, OfMirrorsAndGlassBringPathsAndPhotonsTheSameLight) {
    SceneDescription behind_glass = hollow_cube(Color(0.3f), std::nullopt);
    behind_glass.materials.push_back(glass());
    behind_glass.materials.push_back(diffuse(Color(0.0f)));
    // Glass below y = 0; its surface ends in the walls. Light that went down is bent by 0.30 towards -z.
    behind_glass.shapes.push_back(shape(parallelogram({-1.1, 0, -1.1}, {0, 0, 2.2}, {2.2, 0, 0}), 1));
    lean_normals(behind_glass.shapes.back(), 0.8);
    behind_glass.shapes.push_back(disk({0, 0.9, 0}, {0, -1, 0}, 0.3, 2, ColorD(1.0)));
    behind_glass.camera = look_at({0, -0.15, 0.6}, {0, -1, -0.31}, 6, 6, 15.0);

    SceneDescription by_mirror = hollow_cube(Color(0.3f), std::nullopt);
    by_mirror.materials.push_back(mirror());
    by_mirror.materials.push_back(diffuse(Color(0.0f)));
    by_mirror.shapes[0].material = 1;  // x = -1; its light goes on at 1 rad from +x towards +y
    lean_normals(by_mirror.shapes[0], 0.5);
    by_mirror.shapes.push_back(disk({0.6, 0, 0}, {-1, 0, 0}, 0.3, 2, ColorD(1.0)));
    by_mirror.camera = look_at({0, -0.6, 0.2}, {-0.36, 1, 0}, 6, 6, 15.0);

    ClaimFamily claims;
    for (const auto& [name, description] : {std::pair("glass", behind_glass), std::pair("mirror", by_mirror)}) {
        const Scene scene = build_scene(description);
        const HitPoints hit_points = trace_hit_points(scene, 1, 1);
        std::vector<double> paths;
        std::vector<double> photons;
        for (std::uint64_t seed = 1; seed <= 24; ++seed) {
            const auto gathered = [&](const MethodSettings& method, std::uint64_t passes) {
                return mean_of(render(scene, hit_points, method, {.passes = passes, .seed = seed}).image,
                               gathered_layer)
                    .x;
            };
            paths.push_back(gathered({.integrator = "path"}, 400));
            photons.push_back(gathered({.alpha = 1.0, .radius = 0.12, .photons_per_pass = 20'000}, 2));
        }
        claims.means_agree(name, photons, paths, 0.025, 0.02);
    }
}

}  // namespace
}  // namespace photonlab::test
