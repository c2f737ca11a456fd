// A room where nothing is known in closed form: photon methods against the path tracer, layer by layer and place by
// place.
//
// Compared are blocks of 4 x 4 pixels whose hit points lie in one plane, further than the gather radius from every edge
// and from every other surface: there the only bias is that of a smooth irradiance, r^2 laplacian(E) / 8 of it.
// Indirect light varies over the room's half width 1, so the laplacian is of the order of 10 E at most; at r = 0.05
// this makes 0.3% of bias, which is allowed for. Direct light has shadows: with photons carrying it, only blocks that
// see the whole lamp are compared, whose laplacian is of the order of E / (distance to the lamp)^2 < 3 E: less than
// 0.1%.

#include <gtest/gtest.h>

#include <set>

#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/statistical/significance.h"

namespace photonlab::test {
namespace {

constexpr int room_resolution = 48;
constexpr int block_size = 4;
constexpr double gather_radius = 0.05;
constexpr double smooth_bias = 0.003;
constexpr std::uint64_t room_seeds = 24;

/// Distance of a point from a parallelogram with right angles.
double distance_to(const MeshDescription& rectangle, const VectorD& point) {
    const VectorD first = rectangle.positions[1] - rectangle.positions[0];
    const VectorD second = rectangle.positions[3] - rectangle.positions[0];
    const VectorD from_corner = point - rectangle.positions[0];
    const double u = std::clamp(from_corner.dot(first) / first.length2(), 0.0, 1.0);
    const double v = std::clamp(from_corner.dot(second) / second.length2(), 0.0, 1.0);
    return (from_corner - first * u - second * v).length();
}

/// Distance of a point on a rectangle from that rectangle's nearest edge.
double distance_to_edge(const MeshDescription& rectangle, const VectorD& point) {
    const VectorD first = rectangle.positions[1] - rectangle.positions[0];
    const VectorD second = rectangle.positions[3] - rectangle.positions[0];
    const VectorD from_corner = point - rectangle.positions[0];
    const double u = from_corner.dot(first) / first.length();
    const double v = from_corner.dot(second) / second.length();
    return std::min({u, first.length() - u, v, second.length() - v});
}

/// True when every point of the lamp, tried on a grid a little larger than it, is visible from all around the hit
/// point.
bool sees_whole_lamp(const Scene& scene, const HitPoint& point, const MeshDescription& lamp) {
    const Frame frame = make_frame(point.normal);
    const float margin = static_cast<float>(gather_radius / scene.unit_length);
    for (const float side : {-margin, 0.0f, margin})
        for (const float up : {-margin, 0.0f, margin}) {
            const Vector from = offset_from_surface(point.position + frame.tangent * side + frame.bitangent * up,
                                                    point.geometric_normal, point.geometric_normal);
            for (int i = 0; i <= 4; ++i)
                for (int j = 0; j <= 4; ++j) {
                    const VectorD on_lamp = lamp.positions[0] + (lamp.positions[1] - lamp.positions[0]) * (i / 4.0) +
                                            (lamp.positions[3] - lamp.positions[0]) * (j / 4.0) -
                                            VectorD(0.0, 1e-3, 0.0);
                    const Vector to((on_lamp - scene.centre) / scene.unit_length);
                    if (point.normal.dot(to - from) <= 0.0f || is_occluded(scene, {from, to})) return false;
                }
        }
    return true;
}

struct Block {
    std::vector<std::uint32_t> pixels;
    bool sees_lamp;
};

std::vector<Block> comparable_blocks(const SceneDescription& description, const Scene& scene,
                                     const HitPoints& hit_points) {
    const MeshDescription* lamp = nullptr;
    for (const ShapeDescription& shape : description.shapes)
        if (shape.radiance) lamp = &std::get<MeshDescription>(shape.geometry);

    // Of each pixel: the shape that it lies on and is clear of everything else, or none.
    std::vector<std::optional<std::size_t>> clear(static_cast<std::size_t>(room_resolution * room_resolution));
    std::vector<char> sees_lamp(clear.size(), 0);
    for (const HitPoint& point : hit_points.points) {
        const VectorD position = VectorD(point.position) * scene.unit_length + scene.centre;
        std::optional<std::size_t> on;
        bool is_clear = true;
        for (std::size_t i = 0; i < description.shapes.size(); ++i) {
            const auto& rectangle = std::get<MeshDescription>(description.shapes[i].geometry);
            const double distance = distance_to(rectangle, position);
            if (distance < 1e-5) {
                is_clear = is_clear && !on && distance_to_edge(rectangle, position) > 1.02 * gather_radius;
                on = i;
            } else if (distance < 1.02 * gather_radius) {
                is_clear = false;
            }
        }
        if (on && is_clear) clear[point.pixel] = on;
        sees_lamp[point.pixel] = sees_whole_lamp(scene, point, *lamp);
    }
    std::vector<Block> blocks;
    for (int top = 0; top < room_resolution; top += block_size)
        for (int left = 0; left < room_resolution; left += block_size) {
            Block block{{}, true};
            std::set<std::optional<std::size_t>> shapes;
            for (int y = top; y < top + block_size; ++y)
                for (int x = left; x < left + block_size; ++x) {
                    const auto pixel = static_cast<std::uint32_t>(y * room_resolution + x);
                    block.pixels.push_back(pixel);
                    block.sees_lamp = block.sees_lamp && sees_lamp[pixel];
                    shapes.insert(clear[pixel]);
                }
            if (shapes.size() == 1 && *shapes.begin()) blocks.push_back(std::move(block));
        }
    return blocks;
}

/// Means over each block of the sum of `layers` (its green channel: the lamp is coloured, the walls are, too), by seed.
using BlockValues = std::vector<std::vector<double>>;

void add_values(BlockValues& values, const std::vector<Block>& blocks, const Image& image,
                const std::vector<std::string_view>& layers) {
    values.resize(blocks.size() + 1);
    double all = 0.0;
    for (std::size_t i = 0; i < blocks.size(); ++i) {
        double sum = 0.0;
        for (const std::string_view layer : layers)
            for (const std::uint32_t pixel : blocks[i].pixels)
                sum += static_cast<double>((*image.find(layer))[pixel].y);
        values[i].push_back(sum / static_cast<double>(blocks[i].pixels.size()));
        all += values[i].back();
    }
    values.back().push_back(all / static_cast<double>(blocks.size()));  // last: the mean of all blocks
}

class Room : public testing::Test {
protected:
    /// Path tracing as references are made, half of the seeds in either half's streams: done once for all tests
    /// here.
    static void SetUpTestSuite() {
        description_ = new SceneDescription(room(room_resolution, room_resolution));
        scene_ = new Scene(build_scene(*description_));
        hit_points_ = new HitPoints(trace_hit_points(*scene_, 1, 1));
        references_ = new std::vector<Image>;
        for (std::uint64_t seed = 1; seed <= room_seeds; ++seed)
            for (const RandomPurpose half : {RandomPurpose::ReferenceHalfA, RandomPurpose::ReferenceHalfB})
                references_->push_back(render(*scene_, *hit_points_, {.integrator = "path"},
                                              {.passes = 12, .seed = seed, .path_purpose = half})
                                           .image);
    }
    static void TearDownTestSuite() {
        delete references_;
        delete hit_points_;
        delete scene_;
        delete description_;
    }

    static void expect_agreement(ClaimFamily& claims, const std::string& what, const std::vector<Image>& images,
                                 const std::vector<std::string_view>& layers, bool with_whole_lamp_only, double bias) {
        std::vector<Block> blocks = comparable_blocks(*description_, *scene_, *hit_points_);
        if (with_whole_lamp_only) std::erase_if(blocks, [](const Block& block) { return !block.sees_lamp; });
        ASSERT_GE(blocks.size(), with_whole_lamp_only ? 15u : 40u);
        BlockValues reference;
        BlockValues values;
        for (const Image& image : *references_)
            add_values(reference, blocks, image,
                       with_whole_lamp_only ? std::vector{direct_layer, gathered_layer} : layers);
        for (const Image& image : images) add_values(values, blocks, image, layers);
        for (std::size_t i = 0; i < blocks.size(); ++i)
            claims.means_agree(what + ", block at pixel " + std::to_string(blocks[i].pixels[0]), values[i],
                               reference[i], 0.07, bias);
        claims.means_agree(what + ", all blocks", values.back(), reference.back(), 0.01, bias);
    }

    static std::vector<Image> images_of(const MethodSettings& method, std::uint64_t passes) {
        std::vector<Image> images;
        for (std::uint64_t seed = 1; seed <= room_seeds; ++seed)
            images.push_back(render(*scene_, *hit_points_, method, {.passes = passes, .seed = seed}).image);
        return images;
    }

    static SceneDescription* description_;
    static Scene* scene_;
    static HitPoints* hit_points_;
    static std::vector<Image>* references_;
};

SceneDescription* Room::description_ = nullptr;
Scene* Room::scene_ = nullptr;
HitPoints* Room::hit_points_ = nullptr;
std::vector<Image>* Room::references_ = nullptr;

TEST_F(Room, EveryMethodHasTheSameEmissionToTheBit) {
    const std::vector<Color>& reference = *references_->front().find(emission_layer);
    for (const char* integrator : {"ppm", "photonmapper"}) {
        const Rendering result = render(*scene_, *hit_points_, {.integrator = integrator, .photons_per_pass = 10}, {});
        EXPECT_EQ(*result.image.find(emission_layer), reference) << integrator;
    }
}

TEST_F(Room, HalvesOfAReferenceShareNoRandomNumbers) {
    EXPECT_NE(*references_->at(0).find(gathered_layer), *references_->at(1).find(gathered_layer));
}

TEST_F(Room, ProgressivePhotonMappingAgreesWithPathTracingLayerByLayer) {
    ClaimFamily claims;
    const auto images =
        images_of({.alpha = 0.7, .radius = gather_radius, .direct_samples = 4, .photons_per_pass = 10'000}, 4);
    expect_agreement(claims, "direct", images, {direct_layer}, false, 0.0);
    expect_agreement(claims, "gathered", images, {gathered_layer}, false, smooth_bias);
}

TEST_F(Room, PhotonMappingAgreesWithPathTracing) {
    ClaimFamily claims;
    const auto images =
        images_of({.integrator = "photonmapper", .radius = gather_radius, .photons_per_pass = 30'000}, 1);
    expect_agreement(claims, "gathered", images, {gathered_layer}, false, smooth_bias);
}

// With 120,000 paths some 7000 indirect photons lie on a unit of area, so the nearest 12 are within 0.025: the maximum
// radius, which keeps the search inside the block's clear disc, is seldom reached, and counting the k-th photon would
// add 9%.
TEST_F(Room, NearestPhotonsAgreeWithPathTracing) {
    ClaimFamily claims;
    const auto images = images_of({.integrator = "photonmapper",
                                   .mode = GatherMode::Nearest,
                                   .k = 12,
                                   .max_radius = gather_radius,
                                   .photons_per_pass = 120'000},
                                  1);
    expect_agreement(claims, "gathered", images, {gathered_layer}, false, smooth_bias);
}

TEST_F(Room, PhotonsCarryDirectLightAsShadowRaysDo) {
    ClaimFamily claims;
    const auto images = images_of(
        {.alpha = 0.7, .radius = gather_radius, .direct = DirectMode::Photons, .photons_per_pass = 10'000}, 3);
    expect_agreement(claims, "gathered", images, {gathered_layer}, true, smooth_bias);
    for (const Image& image : images) EXPECT_EQ(mean_of(image, direct_layer), ColorD(0.0));
}

}  // namespace
}  // namespace photonlab::test
