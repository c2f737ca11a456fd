// The packed list: what goes in comes out, whatever is shared and whatever is left out.

#include "transport/camera/hit_point_list.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

namespace photonlab {
namespace {

/// Some on one surface, some that differ from their neighbours in one thing each.
std::vector<HitPoint> assorted_points() {
    std::vector<HitPoint> points;
    for (std::uint32_t i = 0; i < 100; ++i) {
        HitPoint point{.position = Vector(static_cast<float>(i), 0.5f, 0.25f),
                       .normal = Vector(0, 1, 0),
                       .geometric_normal = Vector(0, 1, 0),
                       .outgoing = Vector(0.6f, 0.8f, 0.0f),
                       .weight = Color(0.25f),
                       .pixel = i / 3,
                       .material = static_cast<std::uint16_t>(i % 50 == 7 ? 65'535 : 2),
                       .camera_edges = static_cast<std::uint16_t>(i % 5 == 0 ? 10'000 : 1),
                       .texture_coordinate = Imath::V2f(static_cast<float>(i), 0.5f),
                       .turn = 0.01f * static_cast<float>(i)};
        if (i % 7 == 3) point.geometric_normal = Vector(0.0f, 0.6f, static_cast<float>(i));
        if (i % 11 == 4) point.normal = Vector(static_cast<float>(i), 0.6f, 0.8f);
        if (i % 13 == 6) point.weight = Color(0.25f, 0.25f, 0.125f);
        points.push_back(point);
    }
    return points;
}

TEST(HitPointList, GivesBackWhatItWasGiven) {
    const std::vector<HitPoint> points = assorted_points();
    for (const HitPointList::Kept kept :
         {HitPointList::Kept{false, false, false}, {false, true, false}, {true, false, true}, {true, true, true}}) {
        HitPointList first(0.25f, kept);
        HitPointList list(0.25f, kept);
        for (std::size_t i = 0; i < points.size(); ++i) {
            HitPointList& target = i < 40 ? list : first;
            target.push_back(points[i], i % 3 == 0 || !kept.outgoing);
        }
        list.append(first);
        ASSERT_EQ(list.size(), points.size());
        std::size_t i = 0;
        for (const HitPoint& point : list) {
            const HitPoint& given = points[i];
            const bool is_diffuse = i % 3 == 0 || !kept.outgoing;
            EXPECT_EQ(point.position, given.position);
            EXPECT_EQ(point.normal, given.normal);
            EXPECT_EQ(point.geometric_normal, given.geometric_normal);
            EXPECT_EQ(point.outgoing, is_diffuse ? given.normal : given.outgoing);
            EXPECT_EQ(point.weight, given.weight);
            EXPECT_EQ(point.pixel, given.pixel);
            EXPECT_EQ(point.material, given.material);
            EXPECT_EQ(point.camera_edges, given.camera_edges);
            EXPECT_EQ(point.turn, kept.turns ? given.turn : 0.0f);
            EXPECT_EQ(point.texture_coordinate, kept.texture_coordinates ? given.texture_coordinate : Imath::V2f(0.0f));
            ++i;
        }
    }
    EXPECT_THROW(HitPointList().at(0), std::out_of_range);
}

}  // namespace
}  // namespace photonlab
