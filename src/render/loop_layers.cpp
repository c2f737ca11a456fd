#include "render/loop_layers.h"

#include <array>

#include "core/parallel.h"
#include "integrators/layers.h"
#include "transport/direct_light.h"
#include "transport/path_length.h"

namespace photonlab {

namespace {

/// Connections whose shadow rays wait for each other, to be traced eight at a time.
class WaitingConnections {
public:
    /// Once traced, the connection's contribution times `weight` is added to `sum` if nothing blocks it.
    void add(const Scene& scene, const LightConnection& connection, double weight, ColorD& sum) {
        segments_[count_] = connection.segment;
        contributions_[count_] = connection.light.contribution * weight;
        sums_[count_] = &sum;
        if (++count_ == capacity) trace(scene);
    }

    /// Traces those that still wait.
    void trace(const Scene& scene) {
        const unsigned occluded = occluded_of_eight(scene, {segments_.data(), count_});
        for (std::size_t i = 0; i < count_; ++i)
            if (!(occluded >> i & 1u)) *sums_[i] += contributions_[i];
        count_ = 0;
    }

private:
    static constexpr std::size_t capacity = 8;
    std::size_t count_ = 0;
    std::array<Segment, capacity> segments_;
    std::array<ColorD, capacity> contributions_;
    std::array<ColorD*, capacity> sums_;
};

std::vector<Color> rounded(const std::vector<ColorD>& pixels) {
    return {pixels.begin(), pixels.end()};
}

void add(PassSums& sums, const std::vector<Color>& values) {
    for (std::size_t i = 0; i < sums.size(); ++i) sums.add(i, ColorD(values[i]));
}

}  // namespace

LoopLayers::LoopLayers(const Scene& scene, const HitPoints& hit_points, const LoopLayerSettings& settings)
    : scene_(scene), grid_(hit_points), settings_(settings) {
    if (settings_.has_new_points) {
        direct_pixels_ = PassSums(pixel_count(grid_), settings_.has_exact_sums);
        emission_pixels_ = PassSums(pixel_count(grid_), settings_.has_exact_sums);
        if (settings_.goes_on) gathered_pixels_ = PassSums(pixel_count(grid_), settings_.has_exact_sums);
    } else if (settings_.direct_samples > 0) {
        direct_sums_ = PassSums(grid_.points.size(), settings_.has_exact_sums);
    }
}

std::size_t LoopLayers::blocks(const HitPoints& points) const {
    return settings_.direct_samples == 0 ? 0 : block_count(points.points.size(), hit_points_per_block);
}

/// `add(index, light)` of each hit point of the block.
template <typename Add>
void LoopLayers::add_samples(const HitPoints& hit_points, std::uint64_t pass, std::size_t block, const Add& add) const {
    const HitPointList& points = hit_points.points;
    const BlockRange range = block_range(block, points.size(), hit_points_per_block);
    std::array<ColorD, hit_points_per_block> sum_of;
    sum_of.fill(ColorD(0.0));
    WaitingConnections waiting;
    RandomStreams streams(settings_.seed, settings_.direct_purpose, pass);
    for (std::size_t i = range.begin; i < range.end; ++i) {
        const HitPoint point = points[i];
        if (!depth_allows(settings_.max_depth, point.camera_edges + 1u)) continue;
        RandomStream random = streams[i];
        const Surface surface = surface_at(scene_, point);
        const bool by_both = may_be_narrow(surface.bsdf);
        ColorD& sum = sum_of[i - range.begin];
        for (int sample = 0; sample < settings_.direct_samples; ++sample) {
            const auto connection = draw_connection(scene_, surface, point.outgoing, random);
            if (connection)
                waiting.add(scene_, *connection, by_both ? weight_of_connection(connection->light) : 1.0, sum);
            if (by_both) sum += light_along_lobe(scene_, surface, point.outgoing, random);
        }
    }
    waiting.trace(scene_);
    for (std::size_t i = range.begin; i < range.end; ++i)
        add(i, sum_of[i - range.begin] / static_cast<double>(settings_.direct_samples));
}

std::size_t LoopLayers::begin_pass(std::uint64_t pass, const HitPoints& points) {
    begun_ = pass;
    points_ = &points;
    ++passes_;
    if (settings_.has_new_points && settings_.direct_samples > 0)
        direct_of_pass_.assign(points.points.size(), ColorD(0.0));
    return blocks(points);
}

void LoopLayers::add_block(std::size_t block) {
    if (settings_.has_new_points)
        add_samples(*points_, begun_, block, [&](std::size_t i, const ColorD& light) { direct_of_pass_[i] = light; });
    else
        add_samples(*points_, begun_, block, [&](std::size_t i, const ColorD& light) { direct_sums_.add(i, light); });
}

void LoopLayers::end_pass() {
    if (settings_.has_new_points) {
        add(emission_pixels_, rounded(emission_image(*points_, settings_.max_depth)));
        if (settings_.direct_samples > 0) add_sampled(false, direct_pixels_);
        if (settings_.goes_on) add_seen();
        direct_of_pass_.clear();
    }
    points_ = nullptr;
}

/// What shadow rays brought to hit points that are, or are not, behind a glossy surface.
void LoopLayers::add_sampled(bool after_glossy, PassSums& pixel_sums) const {
    const auto sampled_at = [&](std::size_t i) {
        const bool is_of_these = !settings_.goes_on || points_->points[i].is_after_glossy == after_glossy;
        return is_of_these ? direct_of_pass_[i] : ColorD(0.0);
    };
    add(pixel_sums, to_pixels(*points_, sampled_at, 1.0));
}

/// What camera paths that went on from glossy surfaces found.
void LoopLayers::add_seen() {
    const bool samples = settings_.direct_samples > 0;
    const auto seen = [&](SeenLayer layer) { return rounded(seen_image(*points_, settings_.max_depth, layer)); };
    add(samples ? direct_pixels_ : gathered_pixels_, seen(SeenLayer::Direct));
    add(gathered_pixels_, seen(SeenLayer::Gathered));
    if (samples) add_sampled(true, gathered_pixels_);
}

std::vector<Color> LoopLayers::mean(const PassSums& pixel_sums) const {
    std::vector<Color> pixels;
    pixels.reserve(pixel_sums.size());
    for (std::size_t i = 0; i < pixel_sums.size(); ++i)
        pixels.push_back(Color(pixel_sums[i] * (1.0 / static_cast<double>(passes_))));
    return pixels;
}

std::vector<Color> LoopLayers::emission() const {
    const bool is_summed = settings_.has_new_points && passes_ > 0;
    return is_summed ? mean(emission_pixels_) : rounded(emission_image(grid_, settings_.max_depth));
}

std::vector<Color> LoopLayers::direct() const {
    if (settings_.direct_samples == 0) return std::vector<Color>(pixel_count(grid_), Color(0.0f));
    if (passes_ > 0 && settings_.has_new_points) return mean(direct_pixels_);
    if (passes_ > 0)
        return to_pixels(
            grid_, [&](std::size_t i) { return direct_sums_[i]; }, 1.0 / static_cast<double>(passes_));
    std::vector<ColorD> once(grid_.points.size(), ColorD(0.0));
    parallel_for(blocks(grid_), settings_.threads, [&](std::size_t block) {
        add_samples(grid_, 0, block, [&](std::size_t i, const ColorD& light) { once[i] = light; });
    });
    return to_pixels(
        grid_, [&](std::size_t i) { return once[i]; }, 1.0);
}

std::vector<Color> LoopLayers::gathered() const {
    return passes_ > 0 && settings_.goes_on ? mean(gathered_pixels_) : std::vector<Color>{};
}

void LoopLayers::exchange(StateArchive& archive) {
    archive.exchange_sum(passes_);
    direct_sums_.exchange(archive);
    direct_pixels_.exchange(archive);
    emission_pixels_.exchange(archive);
    gathered_pixels_.exchange(archive);
}

std::uint64_t LoopLayers::inexact_additions() const {
    return direct_sums_.inexact_additions() + direct_pixels_.inexact_additions() +
           emission_pixels_.inexact_additions() + gathered_pixels_.inexact_additions();
}

std::uint64_t LoopLayers::bytes() const {
    return direct_of_pass_.capacity() * sizeof(ColorD) + direct_sums_.bytes() + direct_pixels_.bytes() +
           emission_pixels_.bytes() + gathered_pixels_.bytes();
}

}  // namespace photonlab
