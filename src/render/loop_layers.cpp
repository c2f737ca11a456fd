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
    /// Once traced, the connection's contribution is added to `sum` if nothing blocks it.
    void add(const Scene& scene, const LightConnection& connection, ColorD& sum) {
        segments_[count_] = connection.segment;
        contributions_[count_] = connection.light.contribution;
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

void add(std::vector<ColorD>& sums, const std::vector<Color>& values) {
    for (std::size_t i = 0; i < sums.size(); ++i) sums[i] += ColorD(values[i]);
}

}  // namespace

LoopLayers::LoopLayers(const Scene& scene, const HitPoints& hit_points, const LoopLayerSettings& settings)
    : scene_(scene), grid_(hit_points), settings_(settings) {
    if (settings_.has_new_points) {
        direct_pixels_.assign(pixel_count(grid_), ColorD(0.0));
        emission_pixels_.assign(pixel_count(grid_), ColorD(0.0));
    } else if (settings_.direct_samples > 0) {
        direct_sums_.assign(grid_.points.size(), ColorD(0.0));
    }
}

std::size_t LoopLayers::blocks(const HitPoints& points) const {
    return settings_.direct_samples == 0 ? 0 : block_count(points.points.size(), hit_points_per_block);
}

void LoopLayers::add_samples(const HitPoints& hit_points, std::uint64_t pass, std::size_t block,
                             std::vector<ColorD>& sums) const {
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
        for (int sample = 0; sample < settings_.direct_samples; ++sample) {
            const auto connection = draw_connection(scene_, surface, point.outgoing, random);
            if (connection) waiting.add(scene_, *connection, sum_of[i - range.begin]);
        }
    }
    waiting.trace(scene_);
    for (std::size_t i = range.begin; i < range.end; ++i)
        sums[i] += sum_of[i - range.begin] / static_cast<double>(settings_.direct_samples);
}

std::size_t LoopLayers::begin_pass(std::uint64_t pass, const HitPoints& points) {
    begun_ = pass;
    points_ = &points;
    ++passes_;
    if (settings_.has_new_points && settings_.direct_samples > 0)
        direct_sums_.assign(points.points.size(), ColorD(0.0));
    return blocks(points);
}

void LoopLayers::add_block(std::size_t block) {
    add_samples(*points_, begun_, block, direct_sums_);
}

void LoopLayers::end_pass() {
    if (settings_.has_new_points) {
        add(emission_pixels_, rounded(emission_image(*points_, settings_.max_depth)));
        if (settings_.direct_samples > 0)
            add(direct_pixels_, to_pixels(
                                    *points_, [&](std::size_t i) { return direct_sums_[i]; }, 1.0));
        direct_sums_.clear();
    }
    points_ = nullptr;
}

std::vector<Color> LoopLayers::mean(const std::vector<ColorD>& pixel_sums) const {
    std::vector<Color> pixels;
    pixels.reserve(pixel_sums.size());
    for (const ColorD& sum : pixel_sums) pixels.push_back(Color(sum * (1.0 / static_cast<double>(passes_))));
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
    parallel_for(blocks(grid_), settings_.threads, [&](std::size_t block) { add_samples(grid_, 0, block, once); });
    return to_pixels(
        grid_, [&](std::size_t i) { return once[i]; }, 1.0);
}

void LoopLayers::exchange(StateArchive& archive) {
    archive.exchange(passes_);
    archive.exchange_as_many(direct_sums_);
    archive.exchange_as_many(direct_pixels_);
    archive.exchange_as_many(emission_pixels_);
}

std::uint64_t LoopLayers::bytes() const {
    return (direct_sums_.capacity() + direct_pixels_.size() + emission_pixels_.size()) * sizeof(ColorD);
}

}  // namespace photonlab
