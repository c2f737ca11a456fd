#include "experiment/memory.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "gather/photon_map.h"
#include "integrators/registry.h"

namespace photonlab {

namespace {

constexpr double mebibyte = 1024.0 * 1024.0;
constexpr double no_limit = std::numeric_limits<double>::infinity();
constexpr double margin = 1.1;
constexpr int probe_side = 64;  // pixels
constexpr std::uint64_t probe_paths = 10'000;

// Statistics of one method at a hit point, direct light, and what an estimate makes of them.
constexpr double bytes_of_statistics = 120.0;
// Layers in float and double, their sum, an error's pixels, the file in memory, the reference's halves and their mean.
constexpr double bytes_of_pixel = 240.0;

struct ProcessSize {
    double virtual_bytes = 0.0;
    double resident_bytes = 0.0;
};

ProcessSize process_size() {
    std::ifstream stream("/proc/self/statm");
    ProcessSize pages;
    stream >> pages.virtual_bytes >> pages.resident_bytes;
    const auto page = static_cast<double>(::sysconf(_SC_PAGESIZE));
    return {pages.virtual_bytes * page, pages.resident_bytes * page};
}

/// The number in a file of the kernel; infinite for "max" or no file.
double number_in(const std::string& file) {
    double number = no_limit;
    std::ifstream(file) >> number;
    return number > 0.0 ? number : no_limit;
}

double of_machine() {
    std::ifstream stream("/proc/meminfo");
    std::string name;
    double kibibytes = 0.0;
    for (std::string rest; stream >> name >> kibibytes && std::getline(stream, rest);)
        if (name == "MemAvailable:") return kibibytes * 1024.0;
    return no_limit;
}

/// A group's limit less what it uses; files that it has cached can be dropped.
double of_control_group() {
    double least = no_limit;
    for (const auto& [limit, used] :
         {std::pair{"/sys/fs/cgroup/memory.max", "/sys/fs/cgroup/memory.current"},
          std::pair{"/sys/fs/cgroup/memory/memory.limit_in_bytes", "/sys/fs/cgroup/memory/memory.usage_in_bytes"}}) {
        const double bytes = number_in(limit);
        const double in_use = number_in(used);
        if (bytes == no_limit || in_use == no_limit) continue;
        double cached = 0.0;
        std::ifstream stream(std::string(limit).substr(0, std::string(limit).rfind('/')) + "/memory.stat");
        std::string name;
        for (double value = 0.0; stream >> name >> value;)
            if (name == "inactive_file") cached = value;
        least = std::min(least, std::max(0.0, bytes - in_use + cached));
    }
    return least;
}

double of_own_limit() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return no_limit;
    return std::max(0.0, static_cast<double>(limit.rlim_cur) - process_size().virtual_bytes);
}

/// How many hit points a scene has, and the bytes of one once it is stored.
struct HitPointSize {
    double count = 0.0;
    double bytes_each = 0.0;
};

HitPointSize hit_point_size(const Scene& scene, int samples_per_pixel, double branch_cutoff) {
    Camera coarse = scene.camera;
    coarse.width = std::min(coarse.width, probe_side);
    coarse.height = std::min(coarse.height, probe_side);
    const HitPoints probe = trace_hit_points(scene, coarse, 1, 1, branch_cutoff);
    const auto found = static_cast<double>(probe.points.size());
    return {found / static_cast<double>(pixel_count(probe)) * samples_per_pixel *
                static_cast<double>(scene.camera.width) * static_cast<double>(scene.camera.height),
            found > 0.0 ? static_cast<double>(hit_point_bytes(probe)) / found : 0.0};
}

double photon_bytes(const Scene& scene, const std::vector<RunSettings>& together) {
    const auto is_any = [&](PhotonNeed need) {
        return std::any_of(together.begin(), together.end(), [&](const RunSettings& settings) {
            return find_integrator_kind(settings.method.integrator).needs == need;
        });
    };
    const bool of_pass = is_any(PhotonNeed::PassMap);
    const bool of_all = is_any(PhotonNeed::AllPassesMaps);
    if (!of_pass && !of_all) return 0.0;
    const RunSettings& common = together[0];
    PhotonPass probe = trace_photons(scene,
                                     {.paths = std::min(probe_paths, common.method.photons_per_pass),
                                      .seed = common.seed,
                                      .max_depth = common.method.max_depth,
                                      .store_direct = common.method.direct == DirectMode::Photons},
                                     1, 1);
    const double scale = static_cast<double>(common.method.photons_per_pass) / static_cast<double>(probe.paths_emitted);
    const double photons = static_cast<double>(probe.photons.size()) * sizeof(Photon) * scale;
    const double map = static_cast<double>(PhotonMap(std::move(probe.photons)).bytes()) * scale;
    double bytes = std::max(2.0 * photons, of_pass ? map : 0.0);
    if (of_all) bytes += (2.0 * photons + map) * static_cast<double>(common.passes);
    return bytes;
}

}  // namespace

MemoryEstimate estimate_memory(const Scene& scene, int samples_per_pixel, const std::vector<RunSettings>& together,
                               std::size_t kept_images) {
    const double pixels = static_cast<double>(scene.camera.width) * static_cast<double>(scene.camera.height);
    const HitPointSize points = hit_point_size(scene, samples_per_pixel, together.at(0).method.branch_cutoff);
    const auto methods = static_cast<double>(together.size());
    // While they are made, they are in tiles as well, and in lists that double as they grow.
    const double making = 2.0 * points.bytes_each + sizeof(HitPoint);
    const double held = 2.0 * points.bytes_each + methods * bytes_of_statistics;
    MemoryEstimate estimate;
    estimate.program = process_size().resident_bytes / mebibyte;
    estimate.hit_points = margin * points.count * std::max(making, held) / mebibyte;
    estimate.photons = margin * photon_bytes(scene, together) / mebibyte;
    estimate.images = margin * pixels * (bytes_of_pixel + 36.0 * static_cast<double>(kept_images) * methods) / mebibyte;
    return estimate;
}

double available_mebibytes() {
    return std::min({of_machine(), of_control_group(), of_own_limit()}) / mebibyte;
}

std::string describe(const MemoryEstimate& estimate) {
    return fmt::format(
        "up to {:.0f} MiB (scene {:.0f}, hit points {:.0f}, photons {:.0f}, images {:.0f}) of {:.0f} MiB "
        "available",
        estimate.total(), estimate.program, estimate.hit_points, estimate.photons, estimate.images,
        estimate.program + available_mebibytes());
}

void require_memory(const std::string& what, const MemoryEstimate& estimate) {
    if (estimate.total() - estimate.program > available_mebibytes())
        throw InputError(what, "does not fit into memory: it needs " + describe(estimate));
}

}  // namespace photonlab
