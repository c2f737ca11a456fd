// Spots: their power by integration, their falloff, and that photons leave as they shine.

#include <gtest/gtest.h>

#include <limits>

#include "core/error.h"
#include "image/read_image.h"
#include "scene/emitter.h"
#include "tests/scene/described.h"
#include "tests/scene/scene_folder.h"

namespace photonlab {
namespace {

SpotDescription spot(double cutoff_degrees, double beam_degrees) {
    return {.position = VectorD(0, 0, 3),
            .axes = {VectorD(1, 0, 0), VectorD(0, -1, 0), VectorD(0, 0, -1)},
            .intensity = ColorD(2.0, 3.0, 5.0),
            .cutoff_angle = cutoff_degrees * pi / 180.0,
            .beam_angle = beam_degrees * pi / 180.0,
            .place = "test:1"};
}

Scene scene_of(const SpotDescription& description) {
    SceneDescription scene = describe({floor_of_eight()});
    scene.lights = {description};
    return build_scene(scene);
}

const Spot& spot_of(const Scene& scene) {
    return std::get<Spot>(scene.emitters.at(0).kind);
}

TEST(Spots, HaveThePowerOfTheirCone) {
    for (const auto& [cutoff, beam] : {std::pair(20.0, 15.0), std::pair(60.0, 0.0), std::pair(120.0, 60.0),
                                       std::pair(30.0, 30.0), std::pair(0.5, 0.2)}) {
        const Scene scene = scene_of(spot(cutoff, beam));
        const Spot& light = spot_of(scene);
        constexpr int steps = 200'000;
        double sum = 0.0;
        for (int i = 0; i < steps; ++i) {
            const double angle = light.cutoff_angle * (i + 0.5) / steps;
            sum += light.intensity_along(VectorD(std::sin(angle), 0.0, -std::cos(angle))).y * std::sin(angle);
        }
        sum *= 2.0 * pi * light.cutoff_angle / steps;
        EXPECT_NEAR(scene.emitters[0].power.y / sum, 1.0, 1e-6) << cutoff << " " << beam;
        EXPECT_NEAR(scene.emitters[0].power.x / scene.emitters[0].power.z, 0.4, 1e-9);
    }
}

TEST(Spots, FallOffLinearlyInTheAngle) {
    const Scene scene = scene_of(spot(40.0, 20.0));
    const double area = scene.unit_length * scene.unit_length;
    const auto at = [&](double degrees) {
        const double angle = degrees * pi / 180.0;
        return spot_of(scene).intensity_along(VectorD(0.0, std::sin(angle), -std::cos(angle))).y * area;
    };
    EXPECT_NEAR(at(0.0), 3.0, 1e-9);
    EXPECT_NEAR(at(19.9), 3.0, 1e-9);
    EXPECT_NEAR(at(30.0), 1.5, 1e-9);
    EXPECT_NEAR(at(39.0), 0.15, 1e-9);
    EXPECT_EQ(at(40.1), 0.0);
    EXPECT_EQ(at(170.0), 0.0);
}

// Flux through the floor between two angles, by photons and by integration.
TEST(Spots, SendPhotonsAsTheyShine) {
    const Scene scene = scene_of(spot(40.0, 20.0));
    RandomStream random = stream_of_scenes();
    constexpr int paths = 200'000;
    double inner = 0.0, all = 0.0, squares = 0.0;
    for (int i = 0; i < paths; ++i) {
        const Imath::V2f u = random.next_2d();
        const double u_triangle = random.next_double();
        const EmissionSample emission = sample_emission(scene, 0, u, u_triangle, random.next_2d());
        all += emission.weight.y;
        const double value = -emission.ray.direction.z > std::cos(25.0 * pi / 180.0) ? emission.weight.y : 0.0;
        inner += value;
        squares += value * value;
    }
    const double scale = scene.total_power / paths;
    double expected = 0.0;
    constexpr int steps = 10'000;
    for (int i = 0; i < steps; ++i) {
        const double angle = 25.0 * pi / 180.0 * (i + 0.5) / steps;
        expected += spot_of(scene).intensity_along(VectorD(std::sin(angle), 0.0, -std::cos(angle))).y *
                    std::sin(angle) * 2.0 * pi * (25.0 * pi / 180.0) / steps;
    }
    EXPECT_NEAR(all * scale / scene.emitters[0].power.y, 1.0, 0.01);
    EXPECT_NEAR(inner * scale, expected, 4.5 * scale * std::sqrt(squares));
}

// A texture is a factor on light: it may be above 1, but not below 0, and it must be finite.
TEST(Spots, AreRefusedWithATextureThatIsNoLight) {
    const auto textured = [](float value) {
        SpotDescription description = spot(30.0, 20.0);
        ColorImage image{2, 2, std::vector<Color>(4, Color(0.5f))};
        image.pixels[3] = Color(0.5f, value, 0.5f);
        description.texture = std::make_shared<const Texture>(
            Bitmap{.image = std::make_shared<const ColorImage>(image), .to_uv = Matrix(), .file = "a.exr"});
        return description;
    };
    EXPECT_GT(scene_of(textured(1.0f)).emitters.at(0).power.x, 0.0);
    EXPECT_GT(scene_of(textured(7.0f)).emitters.at(0).power.y, 0.0);
    for (const float value : {-1.0f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()})
        EXPECT_THROW(scene_of(textured(value)), InputError) << value;
}

class SpotsInFiles : public SceneFolderTest {};

TEST_F(SpotsInFiles, ShineAlongZAndHaveMitsubasDefaults) {
    const auto scene = load_as("3.0.0",
                               "<emitter type='spot'><transform name='to_world'><lookat origin='1 2 3' target='1 2 0' "
                               "up='0 1 0'/></transform><float name='cutoff_angle' value='40'/></emitter>"
                               "<emitter type='spot'/>");
    const auto& turned = std::get<SpotDescription>(scene.lights.at(0));
    EXPECT_EQ(turned.position, VectorD(1, 2, 3));
    EXPECT_NEAR((turned.axes[2] - VectorD(0, 0, -1)).length(), 0.0, 1e-12);
    EXPECT_NEAR(turned.beam_angle, 30.0 * pi / 180.0, 1e-12);
    const auto& plain = std::get<SpotDescription>(scene.lights.at(1));
    EXPECT_NEAR(plain.cutoff_angle, 20.0 * pi / 180.0, 1e-12);
    EXPECT_NEAR(plain.beam_angle, 15.0 * pi / 180.0, 1e-12);
}

TEST_F(SpotsInFiles, HaveTexturesOfLight) {
    const auto refusal = [&](const std::string& inside) {
        write("scene.xml",
              "<scene version='0.6.0'><sensor type='perspective'/><shape type='rectangle'/>\n<emitter type='spot'>"
              "<texture name='texture' type='scale'>" +
                  inside + "</texture></emitter></scene>");
        try {
            build_scene(load_scene_file(folder_ / "scene.xml"));
        } catch (const InputError& error) {
            return std::string(error.what()).substr(folder_.string().size() + 1);
        }
        return std::string("no error");
    };
    EXPECT_EQ(refusal("<spectrum name='value' value='3'/>"), "no error");
    EXPECT_EQ(refusal("<spectrum name='value' value='-1'/>"),
              "scene.xml:2: texture: expected finite values of at least 0, got -1");
    EXPECT_EQ(refusal("<float name='scale' value='1e30'/><spectrum name='value' value='1e30'/>").substr(0, 12),
              "scene.xml:2:");
}

}  // namespace
}  // namespace photonlab
