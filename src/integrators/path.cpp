// Path tracing from the hit points: one path at each in every pass. Unbiased, free of photons and radii, and so the
// independent method by which the others are judged; references are made with it.
//
// At each vertex light is found twice, by a connection to a point on a light and by the direction that continues the
// path, and the two are weighted by the balance heuristic: with densities p and q per steradian, w_p = p / (p + q).
//
// [Kajiya 1986, "The Rendering Equation"; Veach & Guibas 1995, "Optimally Combining Sampling Techniques"]

#include <algorithm>

#include "core/parallel.h"
#include "integrators/findable_light.h"
#include "integrators/layers.h"
#include "integrators/pass_sums.h"
#include "integrators/registry.h"
#include "transport/direct_light.h"
#include "transport/path_length.h"

namespace photonlab {

namespace {

constexpr std::uint32_t roulette_after = 3;  // bounces: most paths of a bright scene matter until then

/// What one path found: light reflected once at the hit point, and light reflected there after other reflections.
struct PathSample {
    ColorD direct = ColorD(0.0);
    ColorD gathered = ColorD(0.0);
};

PathSample trace_path(const Scene& scene, const HitPoint& point, int max_depth, RandomStream& random) {
    PathSample result;
    Surface surface = surface_at(scene, point);
    Vector outgoing = point.outgoing;
    Color throughput(1.0f);

    for (std::uint32_t reflections = 1;; ++reflections) {
        // Light found from here has one edge more than the path so far: camera_edges + reflections in all.
        if (!depth_allows(max_depth, point.camera_edges + reflections)) break;
        ColorD& layer = reflections == 1 ? result.direct : result.gathered;

        if (is_scattering(surface.bsdf)) {
            if (const auto light = connect_to_light(scene, surface, outgoing, random)) {
                layer += ColorD(throughput) * light->contribution * weight_of_connection(*light);
            }
        }

        const auto bounce = sample(surface.bsdf, surface.frame.to_local(outgoing), Carried::Radiance, random.next_2d());
        const float survival_draw = random.next();
        if (!bounce) break;
        // Of a hit point's single directions the camera pass has followed each.
        if (reflections == 1 && bounce->density == 0.0f) break;
        const Vector direction = surface.frame.to_world(bounce->incoming);
        if (!sides_agree(surface, direction)) break;
        throughput *= bounce->weight;

        const LobeRay ray = follow_lobe(scene, surface, direction, bounce->density, throughput);
        layer += ray.light;
        if (!ray.hit) break;

        if (reflections >= roulette_after) {
            const float survival = std::min(max_channel(throughput), highest_survival);
            if (survival_draw >= survival) break;
            throughput /= survival;
        }
        const auto next = orient(scene, *ray.hit, -direction);
        if (!next) break;
        surface = *next;
        outgoing = -direction;
    }
    return result;
}

class PathTracing : public Integrator {
public:
    PathTracing(const MethodSettings& settings, const IntegratorContext& context)
        : max_depth_(settings.max_depth),
          context_(context),
          has_new_points_(settings.positions != Positions::Grid),
          direct_(has_new_points_ ? pixel_count(context.hit_points) : context.hit_points.points.size(), true),
          gathered_(direct_.size(), true) {
        require_findable_light(context.scene, max_depth_, "cannot be path traced",
                               "all its caustics would be missing; use ppm, also for a reference");
    }

    void take(const Pass& pass) override {
        if (has_new_points_) {
            std::vector<PathSample> of_pass(pass.points.points.size());
            trace_paths(pass.number, pass.points, [&](std::size_t i, const PathSample& path) { of_pass[i] = path; });
            add_to_pixels(pass.points.points, of_pass);
        } else {
            trace_paths(pass.number, pass.points, [&](std::size_t i, const PathSample& path) { add(i, path); });
        }
        ++passes_;
    }

    MethodLayers image(const PhotonsOfAllPasses*) override {
        const double share = 1.0 / static_cast<double>(passes_);
        if (passes_ > 0 && has_new_points_) return layers_of_pixels(share);
        if (passes_ > 0)
            return {.gathered = to_pixels(
                        context_.hit_points, [&](std::size_t i) { return gathered_[i]; }, share),
                    .direct = to_pixels(
                        context_.hit_points, [&](std::size_t i) { return direct_[i]; }, share)};
        std::vector<ColorD> once(context_.hit_points.points.size());
        trace_paths(0, context_.hit_points, [&](std::size_t i, const PathSample& path) { once[i] = path.direct; });
        return {.gathered = std::vector<Color>(pixel_count(context_.hit_points), Color(0.0f)),
                .direct = to_pixels(
                    context_.hit_points, [&](std::size_t i) { return once[i]; }, 1.0)};
    }

    IntegratorReport report() const override {
        return {.bytes = direct_.bytes() + gathered_.bytes(),
                .inexact_additions = direct_.inexact_additions() + gathered_.inexact_additions()};
    }

    void exchange(StateArchive& archive) override {
        archive.exchange_sum(passes_);
        direct_.exchange(archive);
        gathered_.exchange(archive);
    }

private:
    /// `take(index, path)` of a path from each hit point, on any thread.
    template <typename Take>
    void trace_paths(std::uint64_t pass, const HitPoints& hit_points, const Take& take) const {
        const HitPointList& points = hit_points.points;
        parallel_for(block_count(points.size(), hit_points_per_block), context_.threads, [&](std::size_t block) {
            const BlockRange range = block_range(block, points.size(), hit_points_per_block);
            RandomStreams streams(context_.seed, context_.path_purpose, pass);
            for (std::size_t i = range.begin; i < range.end; ++i) {
                RandomStream random = streams[i];
                take(i, trace_path(context_.scene, points[i], max_depth_, random));
            }
        });
    }

    void add(std::size_t place, const PathSample& path) {
        direct_.add(place, path.direct);
        gathered_.add(place, path.gathered);
    }

    /// What the paths of a pass give to each pixel together; the points of one follow each other.
    void add_to_pixels(const HitPointList& points, const std::vector<PathSample>& paths) {
        PathSample of_pixel;
        for (std::size_t i = 0; i < paths.size(); ++i) {
            const HitPoint point = points[i];
            of_pixel.direct += paths[i].direct * ColorD(point.weight);
            of_pixel.gathered += paths[i].gathered * ColorD(point.weight);
            if (i + 1 < paths.size() && points[i + 1].pixel == point.pixel) continue;
            add(point.pixel, of_pixel);
            of_pixel = {};
        }
    }

    MethodLayers layers_of_pixels(double scale) const {
        MethodLayers layers;
        for (std::size_t pixel = 0; pixel < direct_.size(); ++pixel) {
            layers.gathered.push_back(Color(gathered_[pixel] * scale));
            layers.direct.push_back(Color(direct_[pixel] * scale));
        }
        return layers;
    }

    const int max_depth_;
    const IntegratorContext context_;
    const bool has_new_points_;  // in every pass
    PassSums direct_;            // one a hit point, or one a pixel where points are new
    PassSums gathered_;
    std::uint64_t passes_ = 0;
};

}  // namespace

IntegratorKind path_kind() {
    return {.name = "path",
            .label = "path tracing",
            .paper = "Kajiya 1986, with next-event estimation and multiple importance sampling",
            .needs =
                [](const MethodSettings& settings) {
                    Needs needs{.direct = Needs::Direct::ByItself, .passes = Needs::Passes::Independent};
                    if (settings.positions != Positions::Grid)
                        needs.new_points = NewPoints{.positions = settings.positions, .all_cells = true};
                    return needs;
                },
            .settings = {"positions", "max_depth", "branch_cutoff"},
            .make = make_integrator_of<PathTracing>};
}

}  // namespace photonlab
