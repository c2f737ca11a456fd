// What the loop over passes makes for a method, as its Needs say: hit points, photons, direct light.

#include "render/pass_loop.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "integrators/layers.h"
#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"

namespace photonlab::test {
namespace {

/// Gathers nothing; its image says how many hit points each pixel had over all passes, in the red channel.
class PointCount : public Integrator {
public:
    PointCount(const MethodSettings&, const IntegratorContext& context)
        : grid_(context.hit_points), sums_(pixel_count(context.hit_points), Color(0.0f)) {}

    void take(const Pass& pass) override {
        EXPECT_EQ(pass.photons, nullptr);
        is_given_the_grid_ = &pass.points == &grid_;
        for (const HitPoint& point : pass.points.points) sums_[point.pixel] += Color(1.0f, 0.0f, 0.0f);
    }
    MethodLayers image(const PhotonsOfAllPasses* photons) override {
        EXPECT_EQ(photons, nullptr);
        return {.gathered = sums_, .direct = {}};
    }
    void exchange(StateArchive& archive) override { archive.exchange_as_many(sums_); }
    IntegratorReport report() const override { return {}; }
    std::optional<GatherState> gather_state(std::size_t) const override {
        return GatherState{.photons = is_given_the_grid_ ? 1.0 : 0.0, .density = {}, .radiance = ColorD(0.0)};
    }

private:
    const HitPoints& grid_;
    std::vector<Color> sums_;
    bool is_given_the_grid_ = false;
};

template <bool are_new>
IntegratorKind point_count() {
    return {.name = "point-count",
            .label = "",
            .paper = "",
            .needs =
                [](const MethodSettings&) {
                    return Needs{.new_points = are_new ? std::optional(NewPoints{}) : std::nullopt};
                },
            .settings = {"direct", "direct_samples", "max_depth", "branch_cutoff"},
            .make = make_integrator_of<PointCount>};
}

class Loop : public ::testing::Test {
protected:
    Loop() : scene_(build_scene(room(12, 8))), hit_points_(trace_hit_points(scene_, 1, 1)) {}

    PassLoop loop(const IntegratorKind& kind) const {
        return PassLoop(scene_, hit_points_, {{.method = {.integrator = "point-count"}, .seed = 3}}, {}, {kind});
    }

    Scene scene_;
    HitPoints hit_points_;
};

TEST_F(Loop, MakesNewHitPointsForAMethodThatWantsThemAndChargesThem) {
    PassLoop fixed = loop(point_count<false>());
    PassLoop anew = loop(point_count<true>());
    for (std::uint64_t pass = 1; pass <= 3; ++pass) {
        fixed.take(pass);
        anew.take(pass);
        EXPECT_EQ(fixed.integrator(0).gather_state(0)->photons, 1.0);
        EXPECT_EQ(anew.integrator(0).gather_state(0)->photons, 0.0);
    }
    EXPECT_EQ(fixed.state(0).times.of(Stage::Points), 0.0);
    EXPECT_GT(anew.state(0).times.of(Stage::Points), 0.0);
    EXPECT_EQ(anew.image().find(gathered_layer)->at(40), Color(3.0f, 0.0f, 0.0f));
}

// Today's new points are those of the grid, so that what is summed in pixels must be what is summed at points, to the
// rounding of one pass to float.
TEST_F(Loop, SumsEmissionAndDirectLightInPixelsWherePointsAreNew) {
    PassLoop fixed = loop(point_count<false>());
    PassLoop anew = loop(point_count<true>());
    for (const std::uint64_t passes : {0, 1, 4}) {
        for (std::uint64_t pass = fixed.state(0).pass + 1; pass <= passes; ++pass) {
            fixed.take(pass);
            anew.take(pass);
        }
        const Image expected = fixed.image();
        const Image found = anew.image();
        EXPECT_GT(mean_of(expected, direct_layer).x, 0.0);
        for (const std::string_view layer : {emission_layer, direct_layer})
            for (std::size_t i = 0; i < pixel_count(hit_points_); ++i)
                for (int c = 0; c < 3; ++c) {
                    const float value = expected.find(layer)->at(i)[c];
                    EXPECT_NEAR(found.find(layer)->at(i)[c], value, 1e-6f * value) << layer << ' ' << i;
                }
    }
}

// Of each pixel's hit points; of pixels that see nothing, and of methods that gather nothing, there is none.
TEST_F(Loop, GivesTheRadiusOfEachPixelWithTheImage) {
    for (const std::string name : {"ppm", "sppm", "photonmapper"}) {
        PassLoop method = loop_of({.integrator = name, .photons_per_pass = 2000}, scene_, hit_points_);
        for (std::uint64_t pass = 1; pass <= 4; ++pass) method.take(pass);
        const Image image = method.image();
        ASSERT_EQ(image.radius.size(), pixel_count(hit_points_)) << name;
        std::vector<double> radii(image.radius.size(), 0.0);
        for (std::size_t i = 0; i < hit_points_.points.size(); ++i)
            radii[hit_points_.points[i].pixel] = method.integrator(0).gather_state(i)->radius;
        for (std::size_t i = 0; i < radii.size(); ++i)
            EXPECT_FLOAT_EQ(image.radius[i], static_cast<float>(radii[i])) << name << ' ' << i;
        EXPECT_GT(*std::max_element(image.radius.begin(), image.radius.end()), 0.0f) << name;
        EXPECT_TRUE(image.count.empty() && image.density.empty()) << "nobody asked";
    }
    PassLoop path = loop_of({.integrator = "path"}, scene_, hit_points_);
    path.take(1);
    EXPECT_TRUE(path.image().radius.empty());
}

TEST_F(Loop, GivesWhatPixelsHoldWhereItIsAskedFor) {
    for (const ScheduleName schedule : {ScheduleName::Hachisuka, ScheduleName::KnausZwicker}) {
        MethodSettings settings{.integrator = "ppm", .photons_per_pass = 2000};
        settings.schedule = schedule;
        PassLoop method(scene_, hit_points_, {{.method = settings, .shows_counts = true}});
        for (std::uint64_t pass = 1; pass <= 4; ++pass) method.take(pass);
        const Image image = method.image();
        ASSERT_EQ(image.count.size(), pixel_count(hit_points_));
        const bool has_density = schedule == ScheduleName::Hachisuka;  // whose photons are those of the disc
        ASSERT_EQ(image.density.size(), has_density ? image.count.size() : 0u);
        EXPECT_GT(*std::max_element(image.count.begin(), image.count.end()), 0.0f);
        for (std::size_t i = 0; has_density && i < image.count.size(); ++i) {
            const double area = pi * image.radius[i] * image.radius[i];
            EXPECT_NEAR(image.density[i] * area, image.count[i], 1e-4 * image.count[i]) << i;
        }
    }
}

TEST_F(Loop, BeginsAtAnyPassOfAMethodWhosePassesAreIndependent) {
    PassLoop path = loop_of({.integrator = "path"}, scene_, hit_points_);
    path.take(7);
    EXPECT_EQ(path.state(0).pass, 7u);
    PassLoop ordered = loop_of({.photons_per_pass = 100}, scene_, hit_points_);
    ordered.take(7);
    EXPECT_EQ(ordered.state(0).pass, 0u) << "it waits for the first";
}

}  // namespace
}  // namespace photonlab::test
