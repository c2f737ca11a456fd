#include "reference/reference_check.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <chrono>
#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "gather/map/photon_map.h"
#include "integrators/density_estimate.h"
#include "transport/light/photons.h"

namespace photonlab {

namespace {

constexpr std::uint64_t passes = 32;
constexpr double fewest_photons = 100.0;  // below which their number says nothing for sure
constexpr double largest_change = 0.25;   // of the mean, up to which what is left of the bias follows from it
constexpr double few_pixels = 10.0;       // sharing the noise: it is that of rare bright paths
constexpr double most_standard_errors = 1000.0;
constexpr std::size_t most_points = std::size_t{1} << 18;  // gathered at in a pass, so that large images cost little

std::string name_of(ComparedLight light) {
    return light == ComparedLight::Gathered ? "gathered" : "direct + gathered";
}

double sum_of(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0);
}

double mean_of(const std::vector<double>& values) {
    return sum_of(values) / static_cast<double>(values.size());
}

double standard_error_of(const std::vector<double>& values) {
    const auto count = static_cast<double>(values.size());
    const double mean = mean_of(values);
    double squares = 0.0;
    for (const double value : values) squares += (value - mean) * (value - mean);
    return std::sqrt(squares / (count - 1.0) / count);
}

}  // namespace

double normal_deviate(double deviate, double degrees_of_freedom) {
    const double n = degrees_of_freedom;
    if (std::isinf(n) || std::isinf(deviate)) return deviate;
    const double size = (8.0 * n + 1.0) / (8.0 * n + 3.0) * std::sqrt(n * std::log1p(deviate * deviate / n));
    return std::copysign(size, deviate);
}

namespace {

/// `excess` in standard errors of two independent means together, 0 where there is none.
double deviate_of(double excess, const MeanByPaths& paths, double photons_error, double photon_passes) {
    if (!(excess > 0.0)) return 0.0;
    const double paths_variance = paths.standard_error * paths.standard_error;
    const double photons_variance = photons_error * photons_error;
    const double variance = paths_variance + photons_variance;
    if (!(variance > 0.0)) return most_standard_errors;
    // [Welch 1947, Satterthwaite 1946: degrees of freedom of a sum of variances]
    double inverse = photons_variance / variance * (photons_variance / variance) / (photon_passes - 1.0);
    if (paths.pixels > 0.0) inverse += paths_variance / variance * (paths_variance / variance) / paths.pixels;
    return std::min(normal_deviate(excess / std::sqrt(variance), 1.0 / inverse), most_standard_errors);
}

}  // namespace

ComparedMeans compare_means(const MeanByPaths& paths, const MeanByPhotons& photons) {
    const double mean = photons.within_half.mean;
    const double change = mean - photons.within_radius.mean;
    ComparedMeans result;
    result.difference = paths.mean - mean;
    result.standard_error = std::hypot(paths.standard_error, photons.within_half.standard_error);
    const bool is_low = result.difference < 0.0;
    double deviate = most_standard_errors;
    for (MeanByPhotons::Estimate end : {photons.within_half, photons.within_radius, photons.extrapolated}) {
        if (end.mean == photons.extrapolated.mean)
            end.standard_error = std::hypot(end.standard_error, photons.change_scatter);
        const double beyond = is_low ? end.mean - paths.mean : paths.mean - end.mean;
        deviate = std::min(deviate, deviate_of(beyond, paths, end.standard_error, photons.passes));
        const double least =
            mean - end.mean + fewest_standard_errors * std::hypot(paths.standard_error, end.standard_error);
        result.seen = std::max(result.seen, least);
    }
    result.standard_errors = is_low ? -deviate : deviate;

    if (paths.mean == 0.0 && photons.photons == 0.0)
        result.verdict = Verdict::Agreed;
    else if (photons.photons < fewest_photons)
        result.why = fmt::format("only {:.0f} photons reached what the camera sees", photons.photons);
    else if (deviate > fewest_standard_errors && !is_low && std::abs(change) > largest_change * mean)
        result.why = "what photons find depends too much on the radius: pixels are larger than what they see";
    else if (deviate > fewest_standard_errors)
        result.verdict = Verdict::Disputed;
    else if (result.seen > mean)
        result.why = "the noise is too large: it would hide that all light is missing";
    else
        result.verdict = Verdict::Agreed;
    return result;
}

namespace {

constexpr std::size_t lights = std::size(compared_lights);

/// r in footprints. Means over the image need few photons a pixel, so it is small: what is left of the bias stays below
/// their noise. Of fewer hit points larger footprints are smaller shares.
double outer_footprints(std::size_t hit_points) {
    constexpr double many = 16384.0;
    return largest_check_footprints * std::pow(std::min(1.0, static_cast<double>(hit_points) / many), 0.25);
}

/// A sixteenth of the reference's paths, but enough to tell a few hundredths of the light; and not so many that the
/// bias at these hit points would show.
std::uint64_t photons_a_pass(std::uint64_t reference_paths, std::size_t hit_points) {
    constexpr std::uint64_t fewest = 10'000;
    const std::uint64_t most = std::clamp<std::uint64_t>(6 * hit_points, fewest, 10 * fewest);
    return std::clamp(reference_paths / 16 / passes, fewest, most);
}

/// One pass: radiance times pixels, summed over hit points, by compared light, within r and within r/2.
struct LayerSums {
    std::array<double, lights> within_radius{};
    std::array<double, lights> within_half{};
    std::array<std::uint64_t, lights> photons{};  // within r/2

    LayerSums& operator+=(const LayerSums& other) {
        for (std::size_t light = 0; light < lights; ++light) {
            within_radius[light] += other.within_radius[light];
            within_half[light] += other.within_half[light];
            photons[light] += other.photons[light];
        }
        return *this;
    }
};

/// The photons around one hit point.
struct PointSums {
    explicit PointSums(const FluxSum& none) : within_radius{none, none}, within_half{none, none} {}

    void add(const Photon& photon, bool is_within_half) {
        for (const ComparedLight light : compared_lights) {
            if (light == ComparedLight::Gathered && photon.edges == 1) continue;
            within_radius[static_cast<std::size_t>(light)].add(photon, 1.0);
            if (is_within_half) within_half[static_cast<std::size_t>(light)].add(photon, 1.0);
        }
    }

    std::array<FluxSum, lights> within_radius;
    std::array<FluxSum, lights> within_half;
};

/// Gathers pass after pass at all hit points, or where they are many at every n-th, another n-th in each pass.
class RepeatedGather {
public:
    RepeatedGather(const Scene& scene, const HitPoints& hit_points, int max_depth, int threads)
        : scene_(scene), hit_points_(hit_points), max_depth_(max_depth), threads_(threads) {
        const std::size_t points = hit_points.points.size();
        // A divisor of the number of passes: all hit points are gathered at equally often.
        stride_ = std::min<std::size_t>(std::bit_ceil((points + most_points - 1) / most_points), passes);
        const MethodSettings method{.footprints = outer_footprints(points)};
        for (std::size_t i = 0; i < points; ++i)
            radii_.push_back(initial_radius(method, {.scene = scene, .hit_points = hit_points}, i));
        if (stride_ == 1)
            for (auto& of_light : changes_)
                for (auto& of_passes : of_light) of_passes.assign(points, 0.0f);
    }

    double mean_radius() const { return mean_of(radii_) * scene_.unit_length; }

    LayerSums gather(const PhotonMap& map, std::uint64_t pass) {
        const std::size_t first = pass % stride_;
        const std::size_t count = (radii_.size() - first + stride_ - 1) / stride_;
        std::vector<LayerSums> sums(block_count(count, hit_points_per_block));
        parallel_for(sums.size(), threads_, [&](std::size_t block) {
            const BlockRange range = block_range(block, count, hit_points_per_block);
            std::vector<GatherQuery> queries;
            std::vector<PointSums> found;
            for (std::size_t i = range.begin; i < range.end; ++i) {
                const HitPoint point = hit_points_.points[first + i * stride_];
                queries.push_back(query_at(scene_, point, radii_[first + i * stride_]));
                found.emplace_back(FluxSum(scene_, point, max_depth_));
            }
            map.within_each(queries, [&](std::size_t place, const Photon& photon, double squared_distance) {
                const double half = 0.5 * queries[place].radius;
                found[place].add(photon, squared_distance <= half * half);
            });
            for (std::size_t i = range.begin; i < range.end; ++i)
                sums[block] += sums_at(first + i * stride_, found[i - range.begin], pass);
        });
        LayerSums sum;
        for (const LayerSums& block : sums) sum += block;
        for (std::size_t light = 0; light < lights; ++light) {
            sum.within_radius[light] *= static_cast<double>(stride_);
            sum.within_half[light] *= static_cast<double>(stride_);
        }
        return sum;
    }

    /// Root of the sum over hit points of their squared changes, in units of LayerSums a pass. Even and odd passes are
    /// multiplied, so that their noise is not taken for changes.
    double change_scatter(std::size_t light) const {
        double sum = 0.0;
        for (std::size_t i = 0; i < changes_[light][0].size(); ++i)
            sum += static_cast<double>(changes_[light][0][i]) * static_cast<double>(changes_[light][1][i]);
        return std::sqrt(std::max(sum, 0.0)) / (0.5 * static_cast<double>(passes));
    }

private:
    LayerSums sums_at(std::size_t index, const PointSums& found, std::uint64_t pass) {
        const ColorD scale = ColorD(hit_points_.points[index].weight) / (pi * radii_[index] * radii_[index]);
        LayerSums sums;
        for (std::size_t light = 0; light < lights; ++light) {
            sums.within_radius[light] = mean_channel(found.within_radius[light].flux() * scale);
            sums.within_half[light] = mean_channel(found.within_half[light].flux() * scale) * 4.0;
            sums.photons[light] = found.within_half[light].count();
            if (stride_ == 1)
                changes_[light][pass % 2][index] +=
                    static_cast<float>(sums.within_half[light] - sums.within_radius[light]);
        }
        return sums;
    }

    const Scene& scene_;
    const HitPoints& hit_points_;
    const int max_depth_;
    const int threads_;
    std::size_t stride_ = 1;
    std::vector<double> radii_;  // unit box
    std::array<std::array<std::vector<float>, 2>, lights>
        changes_;  // from r to r/2 at each hit point, summed over
                   // even and over odd passes; none where they are many
};

MeanByPhotons mean_over_passes(const std::vector<double>& within_radius, const std::vector<double>& within_half) {
    std::vector<double> extrapolated = within_half;
    for (std::size_t pass = 0; pass < extrapolated.size(); ++pass)
        extrapolated[pass] += within_half[pass] - within_radius[pass];
    const auto estimate = [](const std::vector<double>& values) {
        return MeanByPhotons::Estimate{mean_of(values), standard_error_of(values)};
    };
    return {.within_radius = estimate(within_radius),
            .within_half = estimate(within_half),
            .extrapolated = estimate(extrapolated),
            .passes = static_cast<double>(within_half.size())};
}

}  // namespace

std::optional<LightByPhotons> measure_light_by_photons(const Scene& scene, const HitPoints& hit_points,
                                                       const CheckSettings& settings) {
    const auto began = std::chrono::steady_clock::now();
    const std::size_t points = hit_points.points.size();
    RepeatedGather gather(scene, hit_points, settings.max_depth, settings.threads);
    LightByPhotons result{.photons_per_pass = photons_a_pass(settings.paths, points),
                          .footprints = outer_footprints(points),
                          .radius = gather.mean_radius()};
    const PhotonSettings photon_settings{.paths = result.photons_per_pass,
                                         .seed = settings.seed,
                                         .max_depth = settings.max_depth,
                                         .store_direct = true,
                                         .purpose = RandomPurpose::ReferenceCheck};
    const double scale = scene.total_power /
                         (static_cast<double>(result.photons_per_pass) * static_cast<double>(pixel_count(hit_points)));
    std::array<std::vector<double>, lights> within_radius;
    std::array<std::vector<double>, lights> within_half;
    std::array<std::uint64_t, lights> photons{};
    for (std::uint64_t pass = 1; pass <= passes; ++pass) {
        if (settings.is_interrupted()) return std::nullopt;
        const PhotonMap map(trace_photons(scene, photon_settings, pass, settings.threads).photons);
        const LayerSums sums = gather.gather(map, pass);
        for (std::size_t light = 0; light < lights; ++light) {
            within_radius[light].push_back(sums.within_radius[light] * scale);
            within_half[light].push_back(sums.within_half[light] * scale);
            photons[light] += sums.photons[light];
        }
    }
    for (std::size_t light = 0; light < lights; ++light) {
        result.means[light] = mean_over_passes(within_radius[light], within_half[light]);
        result.means[light].change_scatter = gather.change_scatter(light) * scale;
        result.means[light].photons = static_cast<double>(photons[light]);
    }
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    return result;
}

MeanByPaths mean_by_paths(const Image& half_a, const Image& half_b, ComparedLight light) {
    const auto value = [&](const Image& half, std::size_t pixel) {
        const double gathered = mean_channel(ColorD((*half.find(gathered_layer))[pixel]));
        return light == ComparedLight::Gathered ? gathered
                                                : gathered + mean_channel(ColorD((*half.find(direct_layer))[pixel]));
    };
    const std::size_t pixels = half_a.find(gathered_layer)->size();
    double sum = 0.0;
    double squares = 0.0;
    double fourth_powers = 0.0;
    MeanByPaths result;
    for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
        const double a = value(half_a, pixel);
        const double b = value(half_b, pixel);
        const double square = (a - b) * (a - b);
        sum += 0.5 * (a + b);
        squares += square;
        fourth_powers += square * square;
        if (square > 0.0) result.pixels += 1.0;
    }
    const auto count = static_cast<double>(pixels);
    result.mean = sum / count;
    result.standard_error = 0.5 * std::sqrt(squares) / count;
    if (fourth_powers > 0.0) result.effective_pixels = squares * squares / fourth_powers;
    return result;
}

namespace {

std::string name_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::Agreed:
            return "not disputed";
        case Verdict::Disputed:
            return "disputed";
        case Verdict::Undecided:
            return "undecided";
    }
    return "";
}

/// A sentence on one comparison, for somebody who has not read this file.
std::string describe(ComparedLight light, const MeanByPaths& paths, const MeanByPhotons& photons,
                     const ComparedMeans& compared) {
    const std::string means = fmt::format("the mean of {} is {:.4g} by paths and {:.4g} by photons", name_of(light),
                                          paths.mean, photons.within_half.mean);
    std::string text;
    if (compared.verdict == Verdict::Disputed)
        text = fmt::format("{}, {:.1f} standard errors beyond what the photons' radius explains: {}", means,
                           std::abs(compared.standard_errors),
                           compared.difference < 0.0 ? "paths from the camera miss light that photons find"
                                                     : "photons miss light that paths from the camera find");
    else if (compared.verdict == Verdict::Undecided)
        text = fmt::format("{}, which decides nothing: {}", means, compared.why);
    else if (photons.within_half.mean > 0.0)
        text = fmt::format("{}; missing light of more than {:.2g}% would have shown", means,
                           100.0 * compared.seen / photons.within_half.mean);
    else
        text = means;
    if (paths.effective_pixels < std::min(few_pixels, paths.pixels / 50.0))
        text += fmt::format(
            "; the paths' noise is that of about {:.1f} pixels that rare paths made bright, so their mean is likely "
            "too "
            "low and its standard error too small",
            paths.effective_pixels);
    return text;
}

Json estimate_json(const MeanByPhotons::Estimate& estimate) {
    return {{"mean", estimate.mean}, {"standard_error", estimate.standard_error}};
}

Json comparison_json(const MeanByPaths& paths, const MeanByPhotons& photons, const ComparedMeans& compared) {
    return {{"verdict", name_of(compared.verdict)},
            {"difference", compared.difference},
            {"standard_error", compared.standard_error},
            {"standard_errors_beyond_photons", compared.standard_errors},
            {"least_missing_light_seen", compared.seen},
            {"paths",
             {{"mean", paths.mean},
              {"standard_error", paths.standard_error},
              {"pixels_with_noise", paths.pixels},
              {"effective_pixels", paths.effective_pixels}}},
            {"photons",
             {{"within_r", estimate_json(photons.within_radius)},
              {"within_half_of_r", estimate_json(photons.within_half)},
              {"extrapolated", estimate_json(photons.extrapolated)},
              {"scatter_of_change", photons.change_scatter},
              {"found", photons.photons}}}};
}

}  // namespace

Json check_json(const Image& half_a, const Image& half_b, const LightByPhotons& by_photons) {
    Verdict gravest = Verdict::Agreed;
    std::string why;
    Json comparisons = Json::object();
    for (const ComparedLight light : compared_lights) {
        const MeanByPaths paths = mean_by_paths(half_a, half_b, light);
        const MeanByPhotons& photons = by_photons.means[static_cast<std::size_t>(light)];
        const ComparedMeans compared = compare_means(paths, photons);
        comparisons[light == ComparedLight::Gathered ? "gathered" : "direct_and_gathered"] =
            comparison_json(paths, photons, compared);
        if (!why.empty() && compared.verdict <= gravest) continue;
        gravest = compared.verdict;
        why = describe(light, paths, photons, compared);
    }
    Json json{{"verdict", name_of(gravest)},
              {"why", why},
              {"passes", passes},
              {"photons_per_pass", by_photons.photons_per_pass},
              {"radius_mean", by_photons.radius},
              {"radius_footprints", by_photons.footprints},
              {"seconds", by_photons.seconds}};
    json.update(comparisons);
    return json;
}

Json not_made(const std::string& why) {
    return {{"verdict", "not made"}, {"why", why}};
}

}  // namespace photonlab
