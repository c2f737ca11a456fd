// Area lights whose radiance is a texture: their power against the integral of radiance, what photons and receivers
// draw of them, and that u runs to the right and v down on them as on any other surface.
//
// Statistical claims: means within 4.5 standard errors (7e-6 each), chi-squares with 1e-4; the file as a whole fails by
// chance with less than 1e-3. Seeds are fixed.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "image/exr.h"
#include "image/png.h"
#include "image/read_image.h"
#include "scene/emitter.h"
#include "scene/mitsuba/transform.h"
#include "tests/scene/described.h"
#include "tests/scene/scene_folder.h"
#include "tests/support/chi_square.h"

namespace photonlab {
namespace {

constexpr double standard_errors = 4.5;

using Pixels = std::vector<Color>;

Texture image_of(int width, int height, const Pixels& pixels, bool is_nearest = false, const Matrix& to_uv = Matrix()) {
    return Bitmap{.image = std::make_shared<const ColorImage>(ColorImage{width, height, pixels}),
                  .to_uv = to_uv,
                  .file = "a.exr",
                  .is_nearest = is_nearest};
}

/// Two by two, each colour with a channel of its own brightness, one above 1.
Texture four() {
    return image_of(2, 2, {{1, 0, 0}, {0, 7, 0}, {0.5f, 0, 3}, {2, 2, 2}});
}

Texture left_half(float value) {
    return image_of(2, 1, {Color(value), Color(0.0f)}, true);
}

Matrix turned(double angle, double scale) {
    Matrix matrix;
    matrix[0][0] = matrix[1][1] = scale * std::cos(angle);
    matrix[0][1] = scale * std::sin(angle);
    matrix[1][0] = -matrix[0][1];
    matrix[3][0] = 0.3;
    return matrix;
}

/// Two triangles whose u runs along half_x and v along half_y.
MeshDescription textured_square(const VectorD& centre, const VectorD& half_x, const VectorD& half_y) {
    MeshDescription mesh = square(centre, half_x, half_y);
    mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    return mesh;
}

/// 2 x 2 around (0, 0, 2), faces down; u along +y, v along +x.
MeshDescription square_above() {
    return textured_square({0, 0, 2}, {0, 1, 0}, {1, 0, 0});
}

ShapeDescription shining(Geometry geometry, const Texture& texture, const ColorD& factor = ColorD(1.0)) {
    ShapeDescription light = shape(std::move(geometry), factor);
    light.radiance_texture = std::make_shared<const Texture>(texture);
    return light;
}

Scene scene_of(Geometry geometry, const Texture& texture, const ColorD& factor = ColorD(1.0)) {
    return build_scene(describe({floor_of_eight(), shining(std::move(geometry), texture, factor)}));
}

/// Mean of the texture over [0, 1]^2 by the midpoint rule.
ColorD mean_over_square(const Texture& texture, int steps) {
    ColorD sum(0.0);
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j)
            sum += ColorD(color_at(texture, Imath::V2f(Imath::V2d((i + 0.5) / steps, (j + 0.5) / steps))));
    return sum / (static_cast<double>(steps) * steps);
}

ColorD power_of(const Scene& scene) {
    return scene.emitters.at(0).power * (scene.unit_length * scene.unit_length);
}

void expect_color(const ColorD& color, const ColorD& expected, double tolerance, const std::string& what) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c], expected[c], tolerance * max_channel(expected)) << what << c;
}

TEST(TexturedLights, HaveThePowerOfTheirRadianceOverTheirArea) {
    const Matrix turning = turned(0.4, 3.1);
    const auto nested = std::make_shared<const NestedTexture>(NestedTexture{four()});
    // Over whole repeats of an image the mean is that of its pixels, bilinear or not; what is turned is summed finely.
    const std::vector<std::tuple<std::string, Texture, ColorD, double>> cases{
        {"checkerboard ", Checkerboard{Color(3.0f), Color(0.5f, 0.0f, 9.0f)}, ColorD(1.75, 1.5, 6.0), 1e-6},
        {"image ", four(), ColorD(0.875, 2.25, 1.25), 1e-6},
        {"nearest ", image_of(3, 1, {{3, 0, 0}, {0, 0, 0}, {0, 6, 0}}, true), ColorD(1, 2, 0), 1e-6},
        {"scaled ", Scale{nested, Color(2.0f)}, ColorD(1.75, 4.5, 2.5), 1e-6},
        {"colour ", Scale{nullptr, Color(4, 5, 6)}, ColorD(4, 5, 6), 1e-6},
        {"turned image ", image_of(2, 2, {{1, 0, 0}, {0, 7, 0}, {0.5f, 0, 3}, {2, 2, 2}}, false, turning), ColorD(-1.0),
         1e-5},
        {"turned checkerboard ", Checkerboard{Color(3.0f), Color(0.5f, 0.0f, 9.0f), turning}, ColorD(-1.0), 1e-3}};
    for (const auto& [name, texture, given, tolerance] : cases) {
        const ColorD mean = given.x < 0.0 ? mean_over_square(texture, 1500) : given;
        const ColorD factor(1.0, 2.0, 0.5);
        expect_color(power_of(scene_of(square_above(), texture, factor)), mean * factor * (4.0 * pi), tolerance, name);
    }
}

TEST(TexturedLights, OfOneColourAreAsBrightAsPlainOnes) {
    const Texture plain = Scale{nullptr, Color(4, 5, 6)};
    MeshDescription bare = square_above();
    bare.texture_coordinates.clear();
    for (const Geometry& geometry :
         {Geometry(square_above()), Geometry(bare), Geometry(SphereDescription{{0, 0, 2}, 0.7}),
          Geometry(DiskDescription{{0, 0, 2}, {0, 0, -1}, 0.7}), Geometry(CylinderDescription{{0, 0, 2}, 0.4, 1.5})}) {
        const Scene flat = build_scene(describe({floor_of_eight(), shape(geometry, ColorD(4, 5, 6))}));
        expect_color(power_of(scene_of(geometry, plain)), power_of(flat), 1e-6, "");
    }
}

// Meshes without texture coordinates have the shares of the second and third corner: over a triangle u has mean 1/3.
TEST(TexturedLights, OfOtherShapesHaveThePowerOfTheirOwnCoordinates) {
    const Texture lower = image_of(1, 2, {Color(0.0f), Color(1.0f)}, true);  // where v is above 1/2
    MeshDescription bare = square_above();
    bare.texture_coordinates.clear();
    const std::vector<std::tuple<std::string, Geometry, Texture, double>> cases{
        {"barycentric ", bare, left_half(1.0f), 3.0},  // 3/4 of 4
        {"sphere ", SphereDescription{{0, 0, 2}, 0.7}, lower, 2.0 * pi * 0.49},
        {"sphere in quarters ", SphereDescription{{0, 0, 2}, 0.7}, Checkerboard{Color(1.0f), Color(0.0f)},
         2.0 * pi * 0.49},
        {"disk by radius ", DiskDescription{{0, 0, 2}, {0, 0, -1}, 0.8}, left_half(1.0f), pi * 0.16},
        {"cylinder ", CylinderDescription{{0, 0, 2}, 0.4, 1.5}, lower, pi * 0.4 * 1.5}};
    for (const auto& [name, geometry, texture, area] : cases)
        expect_color(power_of(scene_of(geometry, texture)), ColorD(pi * area), 2e-3, name);
}

// Of a large image only one pixel shines: it is found, whatever the parts that the shape is cut into, and to what
// floats resolve of its place.
TEST(TexturedLights, HaveThePowerOfTheirBrightestPixel) {
    Pixels pixels(640 * 480, Color(0.0f));
    pixels[333 * 640 + 77] = Color(1e6f, 0.0f, 3.0f);
    const ColorD expected = ColorD(1e6, 0.0, 3.0) * (4.0 * pi / (640.0 * 480.0));
    for (const bool is_nearest : {false, true})
        expect_color(power_of(scene_of(square_above(), image_of(640, 480, pixels, is_nearest))), expected, 1e-4, "");
}

TEST(TexturedLights, ThatAreBlackAreNone) {
    EXPECT_TRUE(scene_of(square_above(), image_of(1, 1, {Color(0.0f)})).emitters.empty());
    EXPECT_TRUE(scene_of(SphereDescription{{0, 0, 2}, 0.7}, image_of(1, 1, {Color(0.0f)})).emitters.empty());
    // Only the left half of the image is on the square.
    Matrix half;
    half.setScale(VectorD(0.5, 1.0, 1.0));
    EXPECT_TRUE(scene_of(square_above(), image_of(2, 1, {Color(0.0f), Color(1.0f)}, true, half)).emitters.empty());
}

// Too many repeats to be counted out: not exact, yet near, and no longer than a few seconds.
TEST(TexturedLights, WithMillionsOfRepeatsHaveNearlyTheirPower) {
    for (const double repeats : {1e5, 1e12}) {
        Matrix many;
        many.setScale(VectorD(repeats, repeats, 1.0));
        const Texture texture = Checkerboard{Color(3.0f), Color(1.0f), many};
        expect_color(power_of(scene_of(square_above(), texture)), ColorD(8.0 * pi), 0.02, "");
    }
}

// ---------------------------------------------------------------------------------------------------------------------

EmissionSample draw_emission(const Scene& scene, RandomStream& random) {
    const Imath::V2f u = random.next_2d();
    const double u_triangle = random.next_double();
    return sample_emission(scene, 0, u, u_triangle, random.next_2d());
}

// Flux that leaves the squares of a 4 x 4 division, and all of it, against the integral of radiance over them.
TEST(TexturedLights, SendPhotonsAsTheyShine) {
    const Texture texture = image_of(2, 2, {{1, 0, 0}, {0, 7, 0}, {0.5f, 0, 3}, {2, 2, 2}}, false, turned(0.4, 1.3));
    const Scene scene = scene_of(square_above(), texture);
    RandomStream random = stream_of_scenes();
    constexpr int paths = 400'000;
    constexpr int sides = 4;
    std::vector<ColorD> sums(sides * sides, ColorD(0.0)), squares(sides * sides, ColorD(0.0));
    for (int i = 0; i < paths; ++i) {
        const EmissionSample emission = draw_emission(scene, random);
        EXPECT_LE(emission.ray.direction.z, 0.0f);
        const VectorD start = VectorD(emission.ray.origin) * scene.unit_length + scene.centre;
        const auto place = [&](double x) {
            return std::clamp(static_cast<int>((x + 1.0) / 2.0 * sides), 0, sides - 1);
        };
        const auto cell = static_cast<std::size_t>(place(start.x) * sides + place(start.y));  // v, u
        const ColorD weight(emission.weight);
        sums[cell] += weight;
        squares[cell] += weight * weight;
    }
    const double scale = scene.total_power * scene.unit_length * scene.unit_length / paths;
    ColorD all(0.0);
    for (std::size_t cell = 0; cell < sums.size(); ++cell) {
        all += sums[cell] * scale;
        ColorD expected(0.0);
        constexpr int steps = 400;
        for (int i = 0; i < steps; ++i)
            for (int j = 0; j < steps; ++j) {
                const Imath::V2d within((i + 0.5) / steps, (j + 0.5) / steps);
                const Imath::V2d corner(static_cast<double>(cell % sides), static_cast<double>(cell / sides));
                expected += ColorD(color_at(texture, Imath::V2f((corner + within) / sides)));
            }
        expected *= pi * 4.0 / (sides * sides) / (static_cast<double>(steps) * steps);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(sums[cell][c] * scale, expected[c],
                        standard_errors * scale * std::sqrt(squares[cell][c]) + 1e-4 * expected[c])
                << cell << " " << c;
    }
    expect_color(all, power_of(scene), 0.01, "all ");
}

TEST(TexturedLights, SendHardlyAnyPhotonsFromWhereTheyAreBlack) {
    const Scene scene = scene_of(square_above(), left_half(5.0f));
    RandomStream random = stream_of_scenes();
    constexpr int paths = 20'000;
    int black = 0;  // of the few parts that the edge crosses
    double sum = 0.0;
    for (int i = 0; i < paths; ++i) {
        const EmissionSample emission = draw_emission(scene, random);
        sum += emission.weight.x;
        black += emission.weight.x == 0.0f;
        EXPECT_TRUE(emission.weight.x == 0.0f || emission.ray.origin.y < 1e-5f) << "u below 1/2 is y below 0";
    }
    EXPECT_LT(black, paths / 50);
    EXPECT_NEAR(sum / paths, 1.0, 0.01);
}

// Round shapes are measured by points, so that their power is near and not exact; what photons carry is divided by it.
TEST(TexturedLights, OfRoundShapesSendAllTheirPower) {
    for (const Geometry& geometry :
         {Geometry(SphereDescription{{0, 0, 2}, 0.7}), Geometry(DiskDescription{{0, 0, 2}, {0, 0, -1}, 0.7}),
          Geometry(CylinderDescription{{0, 0, 2}, 0.4, 1.5})}) {
        const Scene scene = scene_of(geometry, four());
        RandomStream random = stream_of_scenes();
        constexpr int paths = 100'000;
        ColorD sum(0.0), squares(0.0);
        for (int i = 0; i < paths; ++i) {
            const ColorD weight(draw_emission(scene, random).weight);
            sum += weight;
            squares += weight * weight;
        }
        const ColorD share = scene.emitters[0].power / scene.total_power;
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(sum[c] / paths, share[c], standard_errors * std::sqrt(squares[c]) / paths + 1e-3 * share[c]);
    }
}

// ---------------------------------------------------------------------------------------------------------------------

std::optional<DirectSample> draw_direct(const Scene& scene, const Vector& receiver, RandomStream& random) {
    const Imath::V2f u = random.next_2d();
    return sample_direct(scene, 0, receiver, u, random.next_double());
}

/// Irradiance at the origin, normal +z, of the square above by the midpoint rule over its texture coordinates.
ColorD irradiance_of_square(const Texture& texture) {
    constexpr int steps = 1200;
    ColorD sum(0.0);
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const Imath::V2d uv((i + 0.5) / steps, (j + 0.5) / steps);
            const VectorD point(2.0 * uv.y - 1.0, 2.0 * uv.x - 1.0, 2.0);
            const double squared_distance = point.length2();
            const double cosine = point.z / std::sqrt(squared_distance);
            sum += ColorD(color_at(texture, Imath::V2f(uv))) * (cosine * cosine / squared_distance);
        }
    return sum * (4.0 / (static_cast<double>(steps) * steps));
}

TEST(TexturedLights, LightAPointAsTheIntegralOverThem) {
    const Matrix turning = turned(0.4, 1.3);
    for (const Texture& texture : {Texture(Checkerboard{Color(3.0f), Color(0.5f, 0.0f, 9.0f)}), four(), left_half(5.0f),
                                   image_of(2, 2, {{1, 0, 0}, {0, 7, 0}, {0.5f, 0, 3}, {2, 2, 2}}, true, turning)}) {
        const Scene scene = scene_of(square_above(), texture);
        const Vector receiver = to_box(scene, {0, 0, 0});
        RandomStream random = stream_of_scenes();
        constexpr int samples = 200'000;
        ColorD sum(0.0), squares(0.0);
        for (int i = 0; i < samples; ++i) {
            const auto light = draw_direct(scene, receiver, random);
            if (!light) continue;
            const ColorD value = light->radiance * (light->direction.z / light->density);
            sum += value;
            squares += value * value;
        }
        const ColorD expected = irradiance_of_square(texture);
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(sum[c] / samples, expected[c],
                        standard_errors * std::sqrt(squares[c]) / samples + 1e-3 * expected[c]);
    }
}

// What a receiver draws and what a ray finds there are the same light. Off the edges of an image, where rounding may
// fall to either side of a step, values are smooth.
TEST(TexturedLights, AreTheSameToReceiversAndToRays) {
    const TextureAxes axes{VectorD(0, 0.6, 0.8), VectorD(1, 0, 0), VectorD(0, 0.8, -0.6)};
    MeshDescription bare = square_above();
    bare.texture_coordinates.clear();
    for (const Geometry& geometry :
         {Geometry(square_above()), Geometry(bare), Geometry(SphereDescription{{0, 0, 2}, 0.7, false, axes}),
          Geometry(SphereDescription{{0, 0, 0}, 3.0, true, axes}),
          Geometry(DiskDescription{{0, 0, 2}, {0, 0, -1}, 0.7, {VectorD(0.6, 0.8, 0), VectorD(-0.8, 0.6, 0), axes[0]}}),
          Geometry(CylinderDescription{{0, 0, 2}, 0.4, 1.5, axes})}) {
        const Scene scene = scene_of(geometry, four());
        const Vector receiver = to_box(scene, {0.1, 0.2, 0.3});
        RandomStream random = stream_of_scenes();
        int compared = 0;
        for (int i = 0; i < 1000; ++i) {
            const auto light = draw_direct(scene, receiver, random);
            if (!light) continue;
            const auto hit = intersect(scene, {receiver, light->direction});
            ASSERT_TRUE(hit);
            if ((hit->position - light->position).length() > 1e-4f) continue;  // something is in front of it
            const ColorD found = emitted_radiance(scene, *hit, -light->direction);
            const Imath::V2f& uv = hit->texture_coordinate;
            if (std::min({uv.x, uv.y, 1.0f - uv.x, 1.0f - uv.y}) < 2e-2f)
                continue;  // a seam or a pole of a round shape
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(light->radiance[c], found[c], 2e-4);
            ++compared;
        }
        EXPECT_GT(compared, 300);
    }
}

// ---------------------------------------------------------------------------------------------------------------------

class TexturedLightsInFiles : public SceneFolderTest {
protected:
    /// A rectangle that faces a camera at (0, 0, 5), as files have it; `radiance` is what its emitter holds.
    static std::string facing_camera(const std::string& radiance, const std::string& version = "3.0.0") {
        return "<scene version='" + version +
               "'><sensor type='perspective'><transform name='to_world'><lookat origin='0 0 5' target='0 0 0' up='0 1 "
               "0'/></transform></sensor>\n<shape type='rectangle'><emitter type='area'>\n" +
               radiance + "</emitter></shape></scene>";
    }

    ColorD seen_at(const std::string& radiance, const VectorD& point) const {
        const Scene scene = build_scene(load(facing_camera(radiance)));
        const auto hit = intersect(scene, {to_box(scene, point + VectorD(0, 0, 1)), Vector(0, 0, -1)});
        return emitted_radiance(scene, *hit, Vector(0, 0, 1));
    }

    static std::string bitmap(const std::string& file, const std::string& inside = "") {
        return "<texture type='bitmap' name='radiance'><string name='filename' value='" + file + "'/>" + inside +
               "</texture>";
    }
};

// u runs along x and v along y, whose first row is at v = 0: the image's left edge is where x is -1.
TEST_F(TexturedLightsInFiles, AreNotMirrored) {
    write_png(folder_ / "four.png", 2, 2, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}});
    const std::string radiance = bitmap("four.png", "<string name='filter_type' value='nearest'/>");
    EXPECT_EQ(seen_at(radiance, {-0.5, -0.5, 0}), ColorD(1, 0, 0));
    EXPECT_EQ(seen_at(radiance, {0.5, -0.5, 0}), ColorD(0, 1, 0));
    EXPECT_EQ(seen_at(radiance, {-0.5, 0.5, 0}), ColorD(0, 0, 1));
    EXPECT_EQ(seen_at(radiance, {0.5, 0.5, 0}), ColorD(1, 1, 1));
}

TEST_F(TexturedLightsInFiles, AreDecodedAsOtherTexturesAndNotClamped) {
    write_png(folder_ / "grey.png", 1, 1, {ColorD(0.2)});
    const double stored = std::round(255.0 * (1.055 * std::pow(0.2, 1.0 / 2.4) - 0.055)) / 255.0;
    EXPECT_NEAR(seen_at(bitmap("grey.png"), VectorD(0.0)).x, srgb_to_linear(stored), 1e-6);
    EXPECT_NEAR(seen_at(bitmap("grey.png", "<boolean name='raw' value='true'/>"), VectorD(0.0)).x, stored, 1e-6);
    write_exr(folder_ / "bright.exr", {.width = 1, .height = 1, .layers = {{"total", {Color(70.0f, 0.5f, 1000.0f)}}}});
    EXPECT_EQ(seen_at(bitmap("bright.exr"), VectorD(0.0)), ColorD(70.0, 0.5, 1000.0));
}

TEST_F(TexturedLightsInFiles, AreCheckerboardsAndScalesOfLight) {
    const std::string board =
        "<texture type='checkerboard' name='radiance'><rgb name='color0' value='30 0 2'/><spectrum name='color1' "
        "value='2'/></texture>";
    EXPECT_EQ(seen_at(board, {-0.5, -0.5, 0}), ColorD(30, 0, 2));
    // A spectrum of one value is what it is for a light: equal-energy white in version 3.
    const auto plain = load(facing_camera("<spectrum name='radiance' value='2'/>"));
    const ColorD white = *plain.shapes.at(0).radiance;
    EXPECT_GT(white.x, white.z);
    expect_color(seen_at(board, {0.5, -0.5, 0}), white, 1e-6, "");
    const std::string scaled =
        "<texture type='scale' name='radiance'><float name='scale' value='3'/>" + board + "</texture>";
    EXPECT_EQ(seen_at(scaled, {-0.5, -0.5, 0}), ColorD(90, 0, 6));
}

TEST_F(TexturedLightsInFiles, MayBeSharedByAReference) {
    const auto scene = load(
        "<scene version='3.0.0'><sensor type='perspective'/><texture type='checkerboard' id='board'><rgb name='color0' "
        "value='30'/></texture><emitter type='area' id='lamp'><ref name='radiance' id='board'/></emitter><shape "
        "type='rectangle'><ref id='lamp'/></shape><shape type='disk'><ref id='lamp'/></shape></scene>");
    for (const ShapeDescription& shape : scene.shapes) {
        ASSERT_TRUE(shape.radiance && shape.radiance_texture);
        EXPECT_EQ(color_at(*shape.radiance_texture, {0.1f, 0.1f}), Color(30.0f));
    }
}

TEST_F(TexturedLightsInFiles, AreRefusedWithAPixelThatIsNoLight) {
    for (const float value : {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        const Pixels pixels{Color(0.5f), Color(1.0f, value, 1.0f)};
        write_exr(folder_ / "bad.exr", {.width = 2, .height = 1, .layers = {{"total", pixels}}});
        EXPECT_EQ(message_of(facing_camera(bitmap("bad.exr"))),
                  "scene.xml:3: radiance: expected finite values of at least 0, got " +
                      std::string(value == -1.0f ? "-1" : "nan"));
        const ShapeDescription light = shining(square_above(), image_of(2, 1, pixels));
        EXPECT_THROW(build_scene(describe({floor_of_eight(), light})), InputError);
    }
}

}  // namespace
}  // namespace photonlab
