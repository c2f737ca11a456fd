// Whether a photon is seen is asked before the gather, and the gather accepts the same photons: those and no others.

#include "gather/areas/accepting_discs.h"

#include <gtest/gtest.h>

#include <numeric>

#include "integrators/registry.h"
#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"
#include "tests/support/radius_rules.h"

namespace photonlab::test {
namespace {

/// Glass, which splits what the camera sees, and a sheet that is gathered at from both sides.
SceneDescription furnished_room() {
    SceneDescription description = room(16, 12);
    description.materials.push_back({.id = "glass", .bsdf = Dielectric{}});
    description.shapes.push_back(sphere(VectorD(-0.3, 0.0, 0.0), 0.4, false, description.materials.size() - 1));
    description.materials.push_back({.id = "rough glass", .bsdf = RoughDielectric{}});
    description.shapes.push_back(shape(parallelogram(VectorD(-0.9, -0.6, -0.8), VectorD(0.8, 0, 0), VectorD(0, 0.9, 0)),
                                       description.materials.size() - 1));
    return description;
}

std::vector<NamedMethod> discs_of_methods() {
    std::vector<NamedMethod> methods = methods_by_every_radius_rule({.radius = 0.2, .photons_per_pass = 2000});
    for (const std::string integrator : {"ppm", "sppm"})
        for (const AreaMode area : {AreaMode::Disc, AreaMode::Seen, AreaMode::Linear}) {
            MethodSettings settings{.integrator = integrator,
                                    .radius = 0.2,
                                    .area = area,
                                    .area_lines = 4,
                                    .direct = DirectMode::Photons,
                                    .max_depth = 4,
                                    .photons_per_pass = 2000};
            methods.push_back({integrator + " " + std::string(name_of(area)), settings});
        }
    std::erase_if(methods, [](const NamedMethod& method) { return starts_at_nearest(method.settings); });
    return methods;
}

TEST(AcceptingDiscs, AcceptWhatTheGatherAccepts) {
    const Scene scene = build_scene(furnished_room());
    const HitPoints grid = trace_hit_points(scene, 1, 1);
    for (const auto& [name, settings] : discs_of_methods()) {
        const auto integrator =
            make_integrator(find_integrator_kind(settings.integrator), settings, {.scene = scene, .hit_points = grid});
        const bool looks_farther =
            settings.schedule == ScheduleName::Adaptive || settings.estimate_error == ErrorEstimation::On;
        std::size_t seen = 0;
        std::size_t unseen = 0;
        std::size_t only_by_discs = 0;
        for (std::uint64_t number = 1; number <= 3; ++number) {
            const auto new_points = needs_of(settings).new_points;
            const HitPoints points =
                new_points ? trace_new_hit_points(scene, 1, *new_points, {.pass = number}, 1) : grid;
            const AcceptingDiscs discs = integrator->accepting_discs({.number = number, .points = points});
            const std::vector<Photon> photons = trace_photons(scene, photon_settings(settings, 1), number, 1).photons;
            PhotonNotes notes;
            notes.path.resize(photons.size());
            std::iota(notes.path.begin(), notes.path.end(), 0u);
            const PhotonMap map(photons, notes);
            std::vector<std::uint32_t> accepted(map.size());
            integrator->take(
                {.number = number, .points = points, .photons = &map, .paths = 2000.0, .accepted = accepted});
            for (std::size_t i = 0; i < map.size(); ++i) {
                const bool is_seen = discs.accept(photons[map.notes().path[i]]);
                EXPECT_TRUE(is_seen || accepted[i] == 0) << name << ", pass " << number;
                only_by_discs += is_seen && accepted[i] == 0;
                (is_seen ? seen : unseen) += 1;
            }
        }
        // Where the curvature of the light is asked for, photons beyond the radius are taken for it.
        if (looks_farther)
            EXPECT_GT(only_by_discs, 0u) << name;
        else
            EXPECT_EQ(only_by_discs, 0u) << name;
        EXPECT_GT(seen, 100u) << name;
        EXPECT_GT(unseen, 100u) << name;
    }
}

TEST(AcceptingDiscs, OfNothingAcceptNothing) {
    const Scene scene = build_scene(room(4, 4));
    const Photon photon = trace_photons(scene, {.paths = 100}, 1, 1).photons.at(0);
    EXPECT_FALSE(AcceptingDiscs().accept(photon));
    EXPECT_FALSE(AcceptingDiscs(scene, -1, {}, {}).accept(photon));
    const AcceptingDisc nowhere{{Vector(std::numeric_limits<float>::quiet_NaN()), Vector(0, 1, 0), 10.0}};
    EXPECT_FALSE(AcceptingDiscs(scene, -1, {nowhere}, {}).accept(photon));
}

}  // namespace
}  // namespace photonlab::test
