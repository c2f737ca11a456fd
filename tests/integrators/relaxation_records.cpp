// Writes what relaxation does to photons laid by hand, in relaxation.csv: where they lie in a pool of light nine times
// as bright as what is around it (a window of it), how many lie at which distance from a straight edge of that
// contrast, and how the number in a disc varies, before and after 10 steps, with and without the protection of
// features. `analysis relaxation` draws it.

#include <cstdio>

#include "integrators/relaxation/photon_relaxation.h"
#include "tests/support/laid_photons.h"

namespace photonlab::test {
namespace {

constexpr int steps = 10;
constexpr std::uint64_t seeds = 8;
constexpr double contrast = 9.0;

struct Stage {
    const char* name;
    std::optional<RelaxationSettings> settings;  // none: as they were laid
};
const Stage stages[] = {{"before", std::nullopt},
                        {"ignored", RelaxationSettings{.steps = steps, .protects_features = false}},
                        {"protected", RelaxationSettings{.steps = steps}}};

PhotonMap map_of(const Scene& scene, const Stage& stage, std::vector<Photon> photons) {
    PhotonMap laid(std::move(photons));
    return stage.settings ? relaxed(scene, laid, *stage.settings, 1) : std::move(laid);
}

void write_row(const char* kind, const char* stage, double x, double y) {
    std::printf("%s,%s,%.5g,%.5g\n", kind, stage, x, y);
}

/// A pool of radius 1.5 around the origin.
void write_photons(const Scene& scene) {
    std::vector<Photon> photons;
    RandomStream random(3, RandomPurpose::Test, 0, 0);
    for (const Photon& photon : lay_photons(scene, 36'000, 1.0, 1)) {
        const VectorD place = place_of(scene, photon);
        if (place.length() < 1.5 || random.next_double() * contrast < 1.0) photons.push_back(photon);
    }
    for (const Stage& stage : stages)
        for (const PhotonMap map = map_of(scene, stage, photons); const Photon& photon : map.photons()) {
            const VectorD place = place_of(scene, photon);
            if (std::abs(place.x - 1.3) < 0.6 && std::abs(place.z) < 0.6)
                write_row("photon", stage.name, place.x, place.z);
        }
}

/// Photons in strips a hundredth of the square wide, over what the bright side should have.
void write_edge(const Scene& scene) {
    constexpr int strips = 16;
    constexpr double width = half_square / 50.0;
    constexpr std::size_t count = 8000;
    for (const Stage& stage : stages) {
        double found[strips] = {};
        for (std::uint64_t seed = 1; seed <= seeds; ++seed)
            for (const PhotonMap map = map_of(scene, stage, lay_photons(scene, count, contrast, seed));
                 const Photon& photon : map.photons()) {
                const VectorD place = place_of(scene, photon);
                const int strip = static_cast<int>(std::floor(place.x / width)) + strips / 2;
                if (strip >= 0 && strip < strips && std::abs(place.z) < 0.9 * half_square) found[strip] += 1.0;
            }
        const double bright = count * contrast / (1.0 + contrast) * width / half_square * 0.9 * seeds;
        for (int strip = 0; strip < strips; ++strip)
            write_row("edge", stage.name, (strip + 0.5 - strips / 2) * 0.01, found[strip] / bright);
    }
}

void write_counts(const Scene& scene) {
    constexpr double sizes[] = {2.0, 5.0, 10.0, 20.0, 50.0, 100.0};
    for (const Stage& stage : stages) {
        double variances[std::size(sizes)] = {};
        for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
            const PhotonMap map = map_of(scene, stage, lay_photons(scene, 4000, 1.0, seed));
            for (std::size_t size = 0; size < std::size(sizes); ++size)
                variances[size] += count_variance(scene, map, sizes[size]) / seeds;
        }
        for (std::size_t size = 0; size < std::size(sizes); ++size)
            write_row("counts", stage.name, sizes[size], variances[size] / sizes[size]);
    }
}

}  // namespace
}  // namespace photonlab::test

int main() {
    using namespace photonlab;
    std::puts("kind,stage,x,y");
    const Scene scene = test::floor_for_photons();
    test::write_photons(scene);
    test::write_edge(scene);
    test::write_counts(scene);
}
