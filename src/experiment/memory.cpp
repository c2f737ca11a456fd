#include "experiment/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "experiment/coarse_view.h"
#include "experiment/control_group.h"
#include "gather/photon_map.h"
#include "integrators/registry.h"

namespace photonlab {

namespace {

constexpr double mebibyte = 1024.0 * 1024.0;
constexpr double no_limit = std::numeric_limits<double>::infinity();
constexpr double margin = 1.1;
constexpr std::uint64_t probe_paths = 10'000;

// Statistics of one method at a hit point, direct light, and what an estimate makes of them.
constexpr double bytes_of_statistics = 120.0;
// Layers in float and double, their sum, an error's pixels, the file in memory, the reference's halves and their mean.
constexpr double bytes_of_pixel = 240.0;

struct ProcessSize {
    double virtual_bytes = 0.0;
    double resident_bytes = 0.0;
    double data_bytes = 0.0;  // that only it can write
};

ProcessSize process_size() {
    std::ifstream stream("/proc/self/statm");
    ProcessSize pages;
    double shared = 0.0, text = 0.0, library = 0.0;
    stream >> pages.virtual_bytes >> pages.resident_bytes >> shared >> text >> library >> pages.data_bytes;
    const auto page = static_cast<double>(::sysconf(_SC_PAGESIZE));
    return {pages.virtual_bytes * page, pages.resident_bytes * page, pages.data_bytes * page};
}

double of_machine() {
    std::ifstream stream("/proc/meminfo");
    std::string name;
    double kibibytes = 0.0;
    for (std::string rest; stream >> name >> kibibytes && std::getline(stream, rest);)
        if (name == "MemAvailable:") return kibibytes * 1024.0;
    return no_limit;
}

/// What a limit of the process's own leaves of the bytes that it counts.
double of_own_limit(int resource, double used) {
    rlimit limit{};
    if (::getrlimit(static_cast<__rlimit_resource_t>(resource), &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
        return no_limit;
    return std::max(0.0, static_cast<double>(limit.rlim_cur) - used);
}

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
        return std::any_of(together.begin(), together.end(), [&](const RunSettings& settings) {
            return needs_of(settings.method).photons == photons;
        });
    };
    const bool of_pass = is_any(Needs::Photons::OfPass);
    const bool of_all = is_any(Needs::Photons::OfAllPasses);
    if (!of_pass && !of_all) return 0.0;
    const PhotonSize& size = photon_size(together[0]);
    double bytes = std::max(2.0 * size.photon_bytes, of_pass ? size.map_bytes : 0.0);
    if (of_all) bytes += (2.0 * size.photon_bytes + size.map_bytes) * static_cast<double>(together[0].passes);
    return bytes;
}

MemoryEstimate MemoryEstimator::of(const std::vector<RunSettings>& together, std::size_t kept_images) {
    const double pixels = static_cast<double>(scene_.camera.width) * static_cast<double>(scene_.camera.height);
    const HitPointSize& points = hit_point_size(together.at(0).method.branch_cutoff);
    const auto methods = static_cast<double>(together.size());
    // While they are made, they are in tiles as well, and in lists that double as they grow.
    const double making = 2.0 * points.bytes_each + sizeof(HitPoint);
    const double held = 2.0 * points.bytes_each + methods * bytes_of_statistics;
    MemoryEstimate estimate;
    estimate.program = resident_mebibytes();
    estimate.hit_points = margin * points.count * std::max(making, held) / mebibyte;
    estimate.photons = margin * photon_bytes(together) / mebibyte;
    estimate.images = margin * pixels * (bytes_of_pixel + 36.0 * static_cast<double>(kept_images) * methods) / mebibyte;
    return estimate;
}

AvailableMemory available_memory() {
    const ProcessSize size = process_size();
    AvailableMemory least{of_machine(), "available"};
    const auto compare = [&](double bytes, const std::string& limit) {
        if (bytes < least.mebibytes) least = {bytes, limit};
    };
    if (const auto left = memory_left_by_control_groups())
        compare(left->bytes, "left by the control group " + left->group);
    compare(of_own_limit(RLIMIT_AS, size.virtual_bytes), "left by ulimit -v");
    compare(of_own_limit(RLIMIT_DATA, size.data_bytes), "left by ulimit -d");
    least.mebibytes /= mebibyte;
    return least;
}

double resident_mebibytes() {
    return process_size().resident_bytes / mebibyte;
}

std::string describe(const MemoryEstimate& estimate) {
    const AvailableMemory available = available_memory();
    return fmt::format(
        "up to {:.0f} MiB (scene {:.0f}, hit points {:.0f}, photons {:.0f}, images {:.0f}) of {:.0f} MiB {}",
        estimate.total(), estimate.program, estimate.hit_points, estimate.photons, estimate.images,
        estimate.program + available.mebibytes, available.limit);
}

void require_memory(const std::string& what, const MemoryEstimate& estimate) {
    if (estimate.total() - estimate.program > available_memory().mebibytes)
        throw InputError(what, "does not fit into memory: it needs " + describe(estimate));
}

}  // namespace photonlab
