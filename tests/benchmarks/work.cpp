#include "work.h"

#include <fmt/format.h>

#include <cmath>

#include "core/parallel.h"
#include "gather/map/search_order.h"
#include "render/pass_loop.h"
#include "scene/loader.h"

namespace photonlab::benchmarks {

namespace {

Work make_work() {
    Scene scene =
        build_scene(load_scene_file(PHOTONLAB_SOURCE_DIR "/scenes/cornell-box/scene.xml"), Resolution{256, 256});
    HitPoints hit_points = trace_hit_points(scene, 1, 1);
    Work work{std::move(scene), std::move(hit_points), {.radius = 5.55}, {}, {}};
    work.method.max_depth = work.scene.max_depth;

    PassLoop ppm(work.scene, work.hit_points, {{.method = work.method, .seed = seed}});
    for (std::uint64_t pass = 1; pass <= late_pass; ++pass) {
        PhotonPass traced = trace_photons(
            work.scene, {.paths = work.method.photons_per_pass, .seed = seed, .max_depth = work.method.max_depth}, pass,
            1);
        if (pass == 1 || pass == late_pass) {
            const std::size_t which = pass == 1 ? 0 : 1;
            work.photons[which] = traced.photons;
            const HitPointList& points = work.hit_points.points;
            const SearchOrder order(points);
            for (std::size_t block = 0; block < block_count(points.size(), hit_points_per_block); ++block) {
                const BlockRange range = block_range(block, points.size(), hit_points_per_block);
                for (const std::uint8_t place : order.of_block(range)) {
                    const std::size_t i = range.begin + place;
                    const double radius = ppm.integrator(0).gather_state(i).value().radius / work.scene.unit_length;
                    work.queries[which].push_back({points[i].position, points[i].normal, radius});
                }
            }
        }
        ppm.take(pass, std::move(traced));
    }
    return work;
}

}  // namespace

const Work& work() {
    static const Work made = make_work();
    return made;
}

PhotonPass trace_pass(std::uint64_t pass) {
    return trace_photons(work().scene,
                         {.paths = work().method.photons_per_pass, .seed = seed, .max_depth = work().method.max_depth},
                         pass, 1);
}

std::optional<std::string> difference(const std::vector<Found>& ours, const std::vector<Found>& theirs) {
    for (std::size_t i = 0; i < ours.size(); ++i) {
        if (ours[i].photons != theirs.at(i).photons)
            return fmt::format("query {}: {} photons, expected {}", i, theirs[i].photons, ours[i].photons);
        for (int c = 0; c < 3; ++c)
            if (std::abs(ours[i].power[c] - theirs[i].power[c]) > 1e-12 * ours[i].power[c])
                return fmt::format("query {}: power {}, expected {}", i, theirs[i].power[c], ours[i].power[c]);
    }
    return std::nullopt;
}

}  // namespace photonlab::benchmarks
