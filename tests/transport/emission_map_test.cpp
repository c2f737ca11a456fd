// The learnt density of emission: what holds of it whatever was learnt.

#include "transport/light/emission_map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "core/random.h"
#include "tests/statistical/scenes.h"

namespace photonlab::test {
namespace {

/// A lamp, a bright point, a faint one, and light from one direction.
Scene lit_room() {
    SceneDescription description = room();
    description.lights = {point_light(VectorD(0.2, 0.0, -0.3), ColorD(100.0)),
                          point_light(VectorD(-0.2, 0.0, -0.3), ColorD(0.01)),
                          DirectionalDescription{VectorD(0.0, 0.0, 1.0), ColorD(1.0), "test"}};
    return build_scene(description);
}

struct Found {
    std::vector<std::uint32_t> cell;
    std::vector<std::uint64_t> acceptances;
};

/// Paths in every cell, of which one in `rarity` was seen, by chance.
Found random_find(const EmissionMap& map, std::uint64_t seed, std::uint32_t rarity) {
    RandomStream random(seed, RandomPurpose::Test, 0, 0);
    Found found;
    for (std::uint32_t i = 0; i < 4 * map.cell_count(); ++i) {
        found.cell.push_back(random.next_bits() % static_cast<std::uint32_t>(map.cell_count()));
        found.acceptances.push_back(random.next_bits() % rarity == 0 ? random.next_bits() % 100'000 : 0);
    }
    return found;
}

TEST(EmissionMap, IsPlainEmissionBeforeItLearns) {
    const Scene scene = lit_room();
    const EmissionMap map(scene);
    ASSERT_EQ(map.cell_count(), scene.emitters.size() * 256);
    for (std::size_t cell = 0; cell < map.cell_count(); ++cell) {
        EXPECT_EQ(map.probability(cell), map.plain_probability(cell));
        EXPECT_NEAR(map.plain_probability(cell), scene.emitters[cell / 256].choice_probability / 256.0, 1e-15);
    }
}

TEST(EmissionMap, IsADensityOfAtLeastHalfOfPlainEmissionWhateverItLearns) {
    const Scene scene = lit_room();
    for (const std::uint32_t rarity : {1, 10, 1000, 1'000'000'000}) {
        EmissionMap map(scene);
        for (std::uint64_t pass = 1; pass <= 3; ++pass) {
            const Found found = random_find(map, pass, rarity);
            map.learn({found.cell, found.acceptances});
            double sum = 0.0;
            for (std::size_t cell = 0; cell < map.cell_count(); ++cell) {
                sum += map.probability(cell);
                EXPECT_GE(map.probability(cell), 0.5 * map.plain_probability(cell) * (1.0 - 1e-15));
            }
            EXPECT_NEAR(sum, 1.0, 1e-12) << rarity;
        }
    }
}

TEST(EmissionMap, DrawsEachCellByItsProbabilityAndWeighsItBack) {
    const Scene scene = lit_room();
    EmissionMap map(scene);
    const Found found = random_find(map, 7, 20);
    map.learn({found.cell, found.acceptances});
    constexpr int draws = 4'000'000;
    std::vector<double> drawn(map.cell_count(), 0.0);
    for (int i = 0; i < draws; ++i) {
        const EmissionMap::Choice choice = map.choose((i + 0.5) / draws);
        ASSERT_EQ(choice.emitter, choice.cell / 256);
        EXPECT_DOUBLE_EQ(choice.weight * map.probability(choice.cell), map.plain_probability(choice.cell));
        drawn[choice.cell] += 1.0 / draws;
    }
    for (std::size_t cell = 0; cell < drawn.size(); ++cell)
        EXPECT_NEAR(drawn[cell], map.probability(cell), 2.0 / draws);
    EXPECT_EQ(map.choose(0.0).cell, 0u);
    EXPECT_EQ(map.choose(std::nextafter(1.0, 0.0)).cell, map.cell_count() - 1);
}

// q_c ~ plain_c sqrt(s_c / m_c): a bright light and a faint one that are seen alike keep their shares of the paths.
TEST(EmissionMap, LearnsByTheSquareRootAndKeepsTheSharesOfLightsThatAreSeenAlike) {
    const Scene scene = lit_room();
    EmissionMap map(scene);
    std::vector<std::uint32_t> cells;
    std::vector<std::uint64_t> acceptances;
    for (std::uint32_t cell = 0; cell < map.cell_count(); ++cell) {
        cells.push_back(cell);
        acceptances.push_back(cell % 256 == 5 ? 4 : cell % 256 == 6 ? 9 : 0);
    }
    map.learn({cells, acceptances});
    for (std::uint32_t light = 0; light < scene.emitters.size(); ++light) {
        const double plain = scene.emitters[light].choice_probability;
        EXPECT_NEAR(map.probability(256 * light + 5), plain * (0.5 * 2.0 / 5.0 + 0.5 / 256.0), 1e-15);
        EXPECT_NEAR(map.probability(256 * light + 6), plain * (0.5 * 3.0 / 5.0 + 0.5 / 256.0), 1e-15);
        EXPECT_NEAR(map.probability(256 * light + 7), plain * 0.5 / 256.0, 1e-15);
    }
}

TEST(EmissionMap, PointsOfACellAreInItAndInTheSquare) {
    for (std::uint32_t cell = 0; cell < 256; ++cell)
        for (const float u : {0.0f, 0.5f, 0x1.fffffep-1f}) {
            const Imath::V2f point = EmissionMap::within(cell, {u, 0.5f});
            EXPECT_GE(point.x, static_cast<float>(cell % 16) / 16.0f);
            EXPECT_LE(point.x, static_cast<float>(cell % 16 + 1) / 16.0f);
            EXPECT_FLOAT_EQ(point.y, (static_cast<float>(cell / 16) + 0.5f) / 16.0f);
            EXPECT_LT(point.x, 1.0f);
        }
}

TEST(EmissionMap, OfLightFromOneDirectionLearnsWhereItEnters) {
    const Scene scene = lit_room();
    const EmissionMap map(scene);
    for (const double u : {0.1, 0.5, 0.9, 0.9999999}) {
        const EmissionMap::Choice choice = map.choose(u);
        const bool is_directional = std::holds_alternative<Directional>(scene.emitters[choice.emitter].kind);
        EXPECT_EQ(choice.square == EmissionMap::Square::Position, is_directional);
    }
}

TEST(EmissionMap, RestoredGoesOnAsItWas) {
    const Scene scene = lit_room();
    EmissionMap map(scene);
    const Found found = random_find(map, 3, 10);
    map.learn({found.cell, found.acceptances});
    std::ostringstream written;
    StateArchive out(written);
    map.exchange(out);
    EmissionMap restored(scene);
    std::istringstream stream(written.str());
    StateArchive in(stream, written.str().size());
    restored.exchange(in);
    for (std::size_t cell = 0; cell < map.cell_count(); ++cell)
        ASSERT_EQ(restored.probability(cell), map.probability(cell));
    EmissionMap of_one_light(build_scene(room()));
    std::istringstream again(written.str());
    StateArchive wrong(again, written.str().size());
    EXPECT_THROW(of_one_light.exchange(wrong), InputError);
}

}  // namespace
}  // namespace photonlab::test
