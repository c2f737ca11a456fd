#include "integrators/layers.h"

#include <array>

#include "core/parallel.h"
#include "transport/direct_light.h"
#include "transport/path_length.h"

namespace photonlab {

Image make_layers(const HitPoints& hit_points, int max_depth, std::vector<Color> direct, std::vector<Color> gathered) {
    const std::vector<ColorD> seen = emission_image(hit_points, max_depth);
    std::vector<Color> emission(seen.begin(), seen.end());
    return {hit_points.width,
            hit_points.height,
            {{std::string(emission_layer), std::move(emission)},
             {std::string(direct_layer), std::move(direct)},
             {std::string(gathered_layer), std::move(gathered)}}};
}

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

}  // namespace

DirectLight::DirectLight(const IntegratorContext& context, const MethodSettings& settings)
    : context_(context),
      samples_(settings.direct == DirectMode::Sampled ? settings.direct_samples : 0),
      max_depth_(settings.max_depth) {
    if (samples_ > 0) sums_.assign(context.hit_points.points.size(), ColorD(0.0));
}

std::size_t DirectLight::blocks() const {
    return samples_ == 0 ? 0 : block_count(context_.hit_points.points.size(), hit_points_per_block);
}

void DirectLight::add_samples(std::uint64_t pass, std::size_t block, std::vector<ColorD>& sums) const {
    const HitPointList& points = context_.hit_points.points;
    const BlockRange range = block_range(block, points.size(), hit_points_per_block);
    std::array<ColorD, hit_points_per_block> sum_of;
    sum_of.fill(ColorD(0.0));
    WaitingConnections waiting;
    RandomStreams streams(context_.seed, context_.direct_purpose, pass);
    for (std::size_t i = range.begin; i < range.end; ++i) {
        const HitPoint point = points[i];
        if (!depth_allows(max_depth_, point.camera_edges + 1u)) continue;
        RandomStream random = streams[i];
        const Surface surface = surface_at(context_.scene, point);
        for (int sample = 0; sample < samples_; ++sample) {
            const auto connection = draw_connection(context_.scene, surface, point.outgoing, random);
            if (connection) waiting.add(context_.scene, *connection, sum_of[i - range.begin]);
        }
    }
    waiting.trace(context_.scene);
    for (std::size_t i = range.begin; i < range.end; ++i)
        sums[i] += sum_of[i - range.begin] / static_cast<double>(samples_);
}

void DirectLight::add_samples(std::uint64_t pass, std::vector<ColorD>& sums) const {
    parallel_for(blocks(), context_.threads, [&](std::size_t block) { add_samples(pass, block, sums); });
}

std::size_t DirectLight::begin_pass(std::uint64_t pass) {
    begun_ = pass;
    if (samples_ > 0) ++passes_;
    return blocks();
}

void DirectLight::run_pass(std::uint64_t pass) {
    if (begun_ == pass) return;
    begin_pass(pass);
    add_samples(pass, sums_);
}

std::vector<Color> DirectLight::layer() const {
    if (samples_ == 0) return std::vector<Color>(pixel_count(context_.hit_points), Color(0.0f));
    if (passes_ > 0)
        return to_pixels(
            context_.hit_points, [&](std::size_t i) { return sums_[i]; }, 1.0 / static_cast<double>(passes_));
    std::vector<ColorD> once(sums_.size(), ColorD(0.0));
    add_samples(0, once);
    return to_pixels(
        context_.hit_points, [&](std::size_t i) { return once[i]; }, 1.0);
}

}  // namespace photonlab
