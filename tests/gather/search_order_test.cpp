// The order of search: a permutation of each block that keeps together what is together in space.

#include "gather/map/search_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "scene/loader.h"
#include "transport/camera/camera_pass.h"

namespace photonlab {
namespace {

// The image shows a floor and a wall behind it: where they meet, what is above each other in the image is not in space.
TEST(SearchOrder, TakesEachPointOfABlockOnceAndNeighboursAfterEachOther) {
    const Scene scene =
        build_scene(load_scene_file(PHOTONLAB_SOURCE_DIR "/scenes/cornell-spheres/scene.xml"), Resolution{64, 64});
    const HitPointList points = trace_hit_points(scene, 1, 1).points;
    const SearchOrder order(points);
    const std::size_t count = points.size();
    ASSERT_GT(count, 2 * hit_points_per_block);
    ASSERT_NE(count % hit_points_per_block, 0u);  // a last block that is not full
    double along_list = 0.0;
    double along_order = 0.0;
    for (std::size_t block = 0; block < block_count(count, hit_points_per_block); ++block) {
        const BlockRange range = block_range(block, count, hit_points_per_block);
        const std::span<const std::uint8_t> of_block = order.of_block(range);
        std::vector<std::uint8_t> places(of_block.begin(), of_block.end());
        ASSERT_EQ(places.size(), range.end - range.begin);
        const auto step = [&](std::size_t from, std::size_t to) {
            return (points[from].position - points[to].position).length();
        };
        for (std::size_t i = 1; i < places.size(); ++i) {
            along_list += step(range.begin + i - 1, range.begin + i);
            along_order += step(range.begin + places[i - 1], range.begin + places[i]);
        }
        std::sort(places.begin(), places.end());
        for (std::size_t i = 0; i < places.size(); ++i) ASSERT_EQ(places[i], i);
    }
    EXPECT_LT(along_order, 0.6 * along_list);
}

TEST(SearchOrder, OfNoPointsIsEmpty) {
    EXPECT_EQ(SearchOrder(HitPointList()).bytes(), 0u);
}

}  // namespace
}  // namespace photonlab
