// Ten million photons in one pass and images of 4096 x 4096, against the light of a point over a plane: minutes, and
// gigabytes of memory.

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>

#include "image/exr.h"
#include "integrators/layers.h"
#include "tests/extremes/foot_of_light.h"
#include "tests/statistical/rendering.h"

namespace photonlab::test {
namespace {

// Five standard deviations of a binomial count: a significance of 6e-7 for each claim.
double tolerance_of(double share, double paths) {
    return 5.0 * std::sqrt((1.0 - share) / (share * paths));
}

TEST(LargePass, OfTenMillionPhotonsHasTheClosedForm) {
    const FootOfLight light{.height = 0.02};
    constexpr std::uint64_t paths = 24'500'000;
    constexpr auto n = static_cast<double>(paths);
    const Scene scene = build_scene(light.description());
    const HitPoints hit_points = trace_hit_points(scene, 1, 1);
    const PhotonPass pass = trace_photons(scene, {.paths = paths, .max_depth = 2, .store_direct = true}, 1, 2);
    EXPECT_EQ(pass.nonfinite, 0u);
    ASSERT_GT(pass.photons.size(), 10'000'000u);
    const double landing = light.share_found(light.floor_radius);
    EXPECT_NEAR(static_cast<double>(pass.photons.size()) / (n * landing), 1.0, tolerance_of(landing, n));

    const auto estimate = [&](const MethodSettings& method) {
        PassLoop run = loop_of(method, scene, hit_points);
        run.take(1, pass);
        return mean_of(run.image(), gathered_layer);
    };
    const auto expect_near = [](const ColorD& found, const ColorD& expected, double tolerance, const char* what) {
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(found[c] / expected[c], 1.0, tolerance) << what << ", channel " << c;
    };
    for (const double radius : {0.2, 0.05, 1e-3})  // all of them, 7.7 million, 7500
        for (const std::string integrator : {"ppm", "photonmapper"})
            expect_near(
                estimate({.integrator = integrator, .radius = radius, .direct = DirectMode::Photons, .max_depth = 2}),
                light.radiance(radius), tolerance_of(light.share_found(radius), n), integrator.c_str());

    // Of the k nearest the disc holds k / n of the photons, give or take 1 / sqrt(k): share_found() solved for it.
    constexpr int k = 1'000'000;
    const double share = k / n;
    const double q = light.height / (1.0 - 2.0 * share);
    expect_near(estimate({.integrator = "photonmapper",
                          .mode = GatherMode::Nearest,
                          .k = k,
                          .max_radius = 0.1,
                          .direct = DirectMode::Photons,
                          .max_depth = 2}),
                light.radiance(std::sqrt(q * q - light.height * light.height)), 5.0 / std::sqrt(k), "nearest");
}

TEST(LargeImage, Of4096SquaredHasTheClosedFormInEveryPixel) {
    constexpr int side = 4096;
    constexpr double camera_height = 0.1;
    constexpr double half_width = 0.04;  // of what is seen of the floor
    const FootOfLight light{.height = 0.05};
    SceneDescription description = light.description();
    const VectorD foot(0.0, light.floor_level, 0.0);
    description.camera = look_at(foot + VectorD(0.0, camera_height, 0.0), foot, side, side,
                                 std::atan(half_width / camera_height) * 360.0 / pi);
    const Scene scene = build_scene(description);
    const HitPoints hit_points = trace_hit_points(scene, 1, 2);
    ASSERT_EQ(hit_points.points.size(), std::size_t{side} * side);

    // By pixel; symmetric, so it is the same whichever way the camera is turned.
    const auto exact = [&](int x, int y) {
        const auto along = [](int i) { return ((i + 0.5) / side - 0.5) * 2.0 * half_width; };
        const double squared = light.height * light.height + along(x) * along(x) + along(y) * along(y);
        return light.intensity * light.height / (squared * std::sqrt(squared)) / pi;
    };

    MethodSettings method{.radius = 5e-4, .max_depth = 2, .photons_per_pass = 1};
    Image image = render(scene, hit_points, method, {.passes = 1, .threads = 2}).image;
    const std::vector<Color>& direct = *image.find(direct_layer);
    double worst = 0.0;
    double mean = 0.0;
    for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) {
            const Color& pixel = direct[static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x)];
            const double expected = exact(x, y);
            mean += expected / (static_cast<double>(side) * side);
            for (int c = 0; c < 3; ++c)
                worst = std::max(worst, std::abs(pixel[c] / (expected * light.reflectance[c]) - 1.0));
        }
    EXPECT_LT(worst, 2e-5);

    // It is stored and read to the bit, too.
    const auto file = std::filesystem::temp_directory_path() / "photonlab-LargeImage.exr";
    write_exr(file, image);
    const Image read = read_exr(file);
    std::filesystem::remove(file);
    const std::vector<Color>& read_direct = *read.find(direct_layer);
    ASSERT_EQ(read_direct.size(), direct.size());
    EXPECT_EQ(std::memcmp(read_direct.data(), direct.data(), direct.size() * sizeof(Color)), 0);

    // Photons in discs of an eightieth of the view: in the mean over the image, what lands in the view.
    method.direct = DirectMode::Photons;
    method.photons_per_pass = 1'000'000;
    image = {};
    image = render(scene, hit_points, method, {.passes = 1, .threads = 2}).image;
    const double in_view = 0.5 * half_width * half_width / std::hypot(light.height, half_width) /
                           (std::hypot(light.height, half_width) + light.height);  // of the disc in the square
    for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(mean_of(image, gathered_layer)[c] / (mean * light.reflectance[c]), 1.0,
                    tolerance_of(in_view, static_cast<double>(method.photons_per_pass)));
}

}  // namespace
}  // namespace photonlab::test
