#include "render/estimates/memory.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/machine/available_memory.h"
#include "gather/areas/gather_areas.h"
#include "gather/map/photon_map.h"
#include "integrators/registry.h"
#include "render/estimates/coarse_view.h"

namespace photonlab {

namespace {

constexpr double mebibyte = 1024.0 * 1024.0;
constexpr double margin = 1.1;
constexpr std::uint64_t probe_paths = 10'000;

// Statistics of one method at a hit point, direct light, and what an estimate makes of them.
constexpr double bytes_of_statistics = 120.0;
// What is known of the area around one, where photons are not divided by the disc's: 600 at edges, which are a part.
constexpr double bytes_of_area = 150.0;
// Where a hit point accepts photons, for paths that are seen: twice while they are put into order, with boxes.
constexpr double bytes_of_disc = 130.0;
// Of each path of emission that learns: its cell, and how often its photons were accepted.
constexpr double bytes_of_learnt_path = sizeof(std::uint32_t) + sizeof(std::uint64_t);
// Of photons of a method's own: path or multiplicity, and how often it was accepted.
constexpr double bytes_of_notes = 8.0;
// Layers in float and double, their sum, an error's pixels, the file in memory, the reference's halves and their mean.
constexpr double bytes_of_pixel = 240.0;

}  // namespace

const MemoryEstimator::HitPointSize& MemoryEstimator::hit_point_size(double branch_cutoff) {
    const auto [known, is_new] = hit_points_.try_emplace(branch_cutoff);
    if (is_new) {
        const CoarseView view = trace_coarse_view(scene_, samples_per_pixel_, 1, branch_cutoff);
        const auto found = static_cast<double>(view.hit_points.points.size());
        const auto bytes = static_cast<double>(hit_point_bytes(view.hit_points));
        known->second = {found * view.scale, found > 0.0 ? bytes / found : 0.0};
    }
    return known->second;
}

const MemoryEstimator::PhotonSize& MemoryEstimator::photon_size(const RunSettings& settings) {
    const MethodSettings& method = settings.method;
    const auto [known, is_new] =
        photons_.try_emplace(std::tuple(method.photons_per_pass, method.max_depth, method.direct));
    if (is_new) {
        PhotonPass probe = trace_photons(scene_,
                                         {.paths = std::min(probe_paths, method.photons_per_pass),
                                          .seed = settings.seed,
                                          .max_depth = method.max_depth,
                                          .store_direct = method.direct == DirectMode::Photons},
                                         1, 1);
        const double scale = static_cast<double>(method.photons_per_pass) / static_cast<double>(probe.paths_emitted);
        const double photons = static_cast<double>(probe.photons.size()) * sizeof(Photon) * scale;
        known->second = {photons, static_cast<double>(PhotonMap(std::move(probe.photons)).bytes()) * scale};
    }
    return known->second;
}

double MemoryEstimator::photon_bytes(const std::vector<RunSettings>& together) {
    const auto is_any = [&](Needs::Photons photons) {
        return std::any_of(together.begin(), together.end(),
                           [&](const RunSettings& settings) { return needs_of(settings.method).photons == photons; });
    };
    const bool of_pass = is_any(Needs::Photons::OfPass);
    const bool of_all = is_any(Needs::Photons::OfAllPasses);
    if (!of_pass && !of_all) return 0.0;
    const PhotonSize& size = photon_size(together[0]);
    double bytes = std::max(2.0 * size.photon_bytes, of_pass ? size.map_bytes : 0.0);
    if (needs_of(together[0].method).has_own_photons) bytes *= 1.0 + bytes_of_notes / sizeof(Photon);
    if (emits_adaptively(together[0].method))
        bytes += bytes_of_learnt_path * static_cast<double>(together[0].method.photons_per_pass);
    for (const RunSettings& one : together)
        if (needs_of(one.method).holds_photons)
            bytes += 3.0 * size.map_bytes + size.photon_bytes / sizeof(Photon) * sizeof(ColorD);
    if (of_all) bytes += (2.0 * size.photon_bytes + size.map_bytes) * static_cast<double>(together[0].passes);
    return bytes;
}

MemoryEstimate MemoryEstimator::of(const std::vector<RunSettings>& together, std::size_t kept_images) {
    const double pixels = static_cast<double>(scene_.camera.width) * static_cast<double>(scene_.camera.height);
    const HitPointSize& points = hit_point_size(together.at(0).method.branch_cutoff);
    const auto methods = static_cast<double>(together.size());
    // While they are made, they are in tiles as well, and in lists that double as they grow.
    const double making = 2.0 * points.bytes_each + sizeof(HitPoint);
    double held = 2.0 * points.bytes_each + methods * bytes_of_statistics;
    for (const RunSettings& one : together)
        if (one.method.area != AreaMode::Disc) held += bytes_of_area;
    if (traces_visible_paths(together[0].method))
        held += bytes_of_disc +
                static_cast<double>(together[0].method.area != AreaMode::Disc ? GatherArea::most_bytes() : 0);
    MemoryEstimate estimate;
    estimate.program = resident_mebibytes();
    estimate.hit_points = margin * points.count * std::max(making, held) / mebibyte;
    estimate.photons = margin * photon_bytes(together) / mebibyte;
    estimate.images = margin * pixels * (bytes_of_pixel + 36.0 * static_cast<double>(kept_images) * methods) / mebibyte;
    return estimate;
}

namespace {

/// "hit points 410, photons 250, images 122", in MiB.
std::string parts_of(const MemoryEstimate& estimate) {
    return fmt::format("hit points {:.0f}, photons {:.0f}, images {:.0f}", estimate.hit_points, estimate.photons,
                       estimate.images);
}

}  // namespace

std::string describe(const MemoryEstimate& estimate) {
    const AvailableMemory available = available_memory();
    return fmt::format("up to {:.0f} MiB (scene {:.0f}, {}) of {:.0f} MiB that {} leaves", estimate.total(),
                       estimate.program, parts_of(estimate), estimate.program + available.mebibytes, available.limit);
}

void require_memory(const std::string& what, const MemoryEstimate& estimate) {
    const AvailableMemory available = available_memory();
    const double needed = estimate.total() - estimate.program;
    if (needed > available.mebibytes)
        throw InputError(what, fmt::format("needs up to {:.0f} MiB more ({}), and {}", needed, parts_of(estimate),
                                           describe(available)));
}

}  // namespace photonlab
