// What scenes take before their first pass, stage by stage, and their rays, each beside Embree alone. One thread,
// processor seconds; the least of so many rounds.
//
//     /usr/bin/python3 tests/benchmarks/meshes.py results/meshes --triangles 10000,1000000 --formats ply,obj
//     build/release/tests/benchmarks/photonlab_loading 5 results/meshes/ply-1000000.xml ...
//
// "Embree" is its own part of a scene's start: buffers filled and the tree built, with the settings of
// embree_scene.cpp. The rays of a photon pass are traced again in Embree alone, backwards: from each photon to where it
// came from.

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <limits>

#include "core/machine/available_memory.h"
#include "scene/embree_scene.h"
#include "scene/loader.h"
#include "transport/light/photons.h"

namespace photonlab::benchmarks {
namespace {

struct Least {
    double seconds = std::numeric_limits<double>::infinity();

    /// Runs the work, and keeps its time if it was the shortest so far.
    template <typename Work>
    auto of(const Work& work) {
        const std::clock_t began = std::clock();
        auto result = work();
        seconds = std::min(seconds, static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC);
        return result;
    }
};

std::size_t triangle_count(const Scene& scene) {
    std::size_t triangles = 0;
    for (const Shape& shape : scene.shapes)
        if (const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry)) triangles += mesh->triangles.size();
    return triangles;
}

/// How many of the rays meet anything, which is all of them but few.
std::size_t trace_backwards(const Scene& scene, const std::vector<Photon>& photons) {
    std::size_t met = 0;
    for (const Photon& photon : photons) {
        const Vector direction = photon.incoming.unit();
        const Vector origin = offset_from_surface(photon.position, photon.normal.unit(), direction);
        RTCRayHit query{};
        query.ray.org_x = origin.x;
        query.ray.org_y = origin.y;
        query.ray.org_z = origin.z;
        query.ray.dir_x = direction.x;
        query.ray.dir_y = direction.y;
        query.ray.dir_z = direction.z;
        query.ray.tfar = infinity;
        query.ray.mask = ~0u;
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
        trace_closest(scene.embree->scene, query);
        met += query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return met;
}

void measure(const std::string& file, int rounds) {
    Least read, build, embree, photons, rays;
    std::size_t triangles = 0, traced = 0;
    double bytes = 0.0;
    for (int round = 0; round < rounds; ++round) {
        const double before = resident_mebibytes();
        const Scene scene = [&] {
            SceneDescription description = read.of([&] { return load_scene_file(file); });
            return build.of([&] { return build_scene(std::move(description)); });
        }();
        triangles = triangle_count(scene);
        if (round == 0) bytes = (resident_mebibytes() - before) * 1024.0 * 1024.0;
        embree.of([&] { return build_embree_scene(scene.shapes, scene.name); });
        const PhotonPass pass = photons.of([&] { return trace_photons(scene, {.store_direct = true}, 1, 1); });
        traced = pass.photons.size();
        rays.of([&] { return trace_backwards(scene, pass.photons); });
    }
    const double start = read.seconds + build.seconds;
    fmt::print("{:<28} {:>9} {:>8.3f} {:>8.3f} {:>8.3f} {:>9.2f} {:>7.0f} {:>10.3f} {:>10.3f} {:>9}\n",
               file.substr(file.rfind('/') + 1), triangles, read.seconds, build.seconds - embree.seconds,
               embree.seconds, start / embree.seconds, bytes / static_cast<double>(triangles), photons.seconds,
               rays.seconds, traced);
}

}  // namespace
}  // namespace photonlab::benchmarks

int main(int argc, char** argv) {
    if (argc < 3) return fmt::print(stderr, "usage: photonlab_loading ROUNDS SCENE...\n"), 2;
    fmt::print("{:<28} {:>9} {:>8} {:>8} {:>8} {:>9} {:>7} {:>10} {:>10} {:>9}\n", "scene", "triangles", "read, s",
               "place", "Embree", "all / it", "bytes", "photons, s", "its rays", "photons");
    for (int i = 2; i < argc; ++i) photonlab::benchmarks::measure(argv[i], std::max(1, std::atoi(argv[1])));
}
